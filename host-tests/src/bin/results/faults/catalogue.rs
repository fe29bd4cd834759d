//! The faults that are put into sessions.

use host_tests::faults::Spoiler;
use rig_twin::{Motion, SEGMENTS, Scenario};

/// Samples a second of most sessions,
pub const SLOW_HZ: f64 = 10.0;
/// and of those with a fault that is shorter than a sample of these.
pub const FAST_HZ: f64 = 100.0;
/// Time of most faults, s.
const AT_S: f64 = 300.0;
/// Time of the faults in the shorter sessions at 100 Hz, s.
const FAST_AT_S: f64 = 120.0;
/// Length of a pause of the recording, s.
const MISSING_S: f64 = 300.0;
/// Length of a rest, s.
pub const REST_S: f64 = 7_200.0;

/// A fault, and the session that has it.
#[derive(Debug, Clone, Copy)]
pub struct Fault {
    pub name: &'static str,
    /// Time of the fault; of one that ends at once, its end.
    pub at_s: f64,
    pub rate_hz: f64,
    pub course: Course,
}

/// Difference from the session without the fault.
#[derive(Debug, Clone, Copy)]
pub enum Course {
    /// The samples are spoiled.
    Spoiled(fn(&mut Spoiler)),
    /// The samples are spoiled from the first contact on that bends a segment by over 10° after `at_s`.
    SpoiledInContact(fn(&mut Spoiler)),
    /// The arm moves in another way.
    Moves(Motion),
    /// The arm rests for two hours; the rest is evaluated.
    Rest,
    /// The same; the motion after it is evaluated.
    AfterRest,
}

impl Course {
    /// True if sessions of a scenario have it: the arm rests where nothing touches it, and is touched in the others.
    pub fn is_in(self, scenario: Scenario) -> bool {
        match self {
            Self::Rest | Self::AfterRest => scenario == Scenario::FreeSwing,
            Self::SpoiledInContact(_) => scenario != Scenario::FreeSwing,
            Self::Spoiled(_) | Self::Moves(_) => true,
        }
    }
}

const fn spoiled(name: &'static str, spoil: fn(&mut Spoiler)) -> Fault {
    Fault { name, at_s: AT_S, rate_hz: SLOW_HZ, course: Course::Spoiled(spoil) }
}

const fn spoiled_from_start(name: &'static str, spoil: fn(&mut Spoiler)) -> Fault {
    Fault { at_s: 0.0, ..spoiled(name, spoil) }
}

const fn spoiled_at_100_hz(name: &'static str, spoil: fn(&mut Spoiler)) -> Fault {
    Fault { at_s: FAST_AT_S, rate_hz: FAST_HZ, ..spoiled(name, spoil) }
}

const fn moves(name: &'static str, motion: Motion) -> Fault {
    Fault { name, at_s: 0.0, rate_hz: SLOW_HZ, course: Course::Moves(motion) }
}

/// Segment 3's first bend sensor, and segment 2's.
const BEND_3A: usize = 4;
const BEND_2A: usize = 2;

/// All of them.
pub const FAULTS: [Fault; 38] = [
    spoiled("IMU 3 returns after 0.7 s, zero 130° off", |s| s.imu_restarts(2, 0.7, 130.0)),
    spoiled("IMU 3 returns after 0.7 s, zero 4° off", |s| s.imu_restarts(2, 0.7, 4.0)),
    spoiled("IMU 3 returns after 30 s, zero 130° off", |s| s.imu_restarts(2, 30.0, 130.0)),
    spoiled("all IMUs return after 0.7 s, zeros 40° to 240° off", |s| s.all_imus_restart(0.7)),
    Fault { at_s: 0.8, ..spoiled("IMU 3 returns in the tare, zero 130° off", |s| s.imu_restarts(2, 0.5, 130.0)) },
    spoiled("IMU 4 dead", |s| s.imu_dies(3)),
    spoiled("IMU 4 frozen", |s| s.imu_freezes(3)),
    spoiled("IMU 3 misses every third sample", |s| s.imus_miss_every_third(2..3)),
    spoiled("all IMUs miss every third sample", |s| s.imus_miss_every_third(0..SEGMENTS)),
    spoiled("heading of IMU 3 jumps by 10°", |s| s.heading_jumps(2, 10.0)),
    spoiled("heading of IMU 3 jumps by 30°", |s| s.heading_jumps(2, 30.0)),
    spoiled("heading of IMU 3 jumps by 90°", |s| s.heading_jumps(2, 90.0)),
    spoiled_at_100_hz("heading of IMU 3 jumps by 30°, 100 Hz", |s| s.heading_jumps(2, 30.0)),
    spoiled_at_100_hz("heading of IMU 3 off by 30° for 50 ms, 100 Hz", |s| s.heading_flickers(2, 30.0, 0.05)),
    spoiled_at_100_hz("all IMUs miss every third sample, 100 Hz", |s| s.imus_miss_every_third(0..SEGMENTS)),
    Fault { at_s: AT_S + MISSING_S, ..spoiled("rows of 5 min missing", |s| s.rows_missing(MISSING_S)) },
    moves("begins in motion", Motion::MovingStart),
    moves("begins bent", Motion::BentStart),
    spoiled("bend sensor 3a open: reads 0", |s| s.bend_opens(BEND_3A, false)),
    spoiled("bend sensor 3a open: reads 4095", |s| s.bend_opens(BEND_3A, true)),
    spoiled("bend sensor 3a frozen", |s| s.bend_freezes(BEND_3A)),
    spoiled("bend sensor 2a steps by 120 counts", |s| s.bend_steps(BEND_2A, 120.0)),
    spoiled("bend sensor 2a drifts by 1 count/s", |s| s.bend_drifts(BEND_2A, 1.0)),
    spoiled("both bend sensors of segment 3 open: read 4095", |s| {
        s.bend_opens(BEND_3A, true);
        s.bend_opens(BEND_3A + 1, true);
    }),
    spoiled("both bend sensors of segment 3 frozen", |s| {
        s.bend_freezes(BEND_3A);
        s.bend_freezes(BEND_3A + 1);
    }),
    spoiled_from_start("bend sensors b not read from the start", |s| s.bend_sensors_missing(|k| k % 2 == 1)),
    spoiled_from_start("bend sensors of segments 2 and 5 not read from the start", |s| {
        s.bend_sensors_missing(|k| k / 2 == 1 || k / 2 == 4);
    }),
    spoiled("bend sensors b not read", |s| s.bend_sensors_missing(|k| k % 2 == 1)),
    spoiled("bend sensors of segments 2 and 5 not read", |s| s.bend_sensors_missing(|k| k / 2 == 1 || k / 2 == 4)),
    Fault { name: "two hours at rest: the rest", at_s: AT_S, rate_hz: SLOW_HZ, course: Course::Rest },
    Fault { name: "two hours at rest: the motion after it", at_s: AT_S, rate_hz: SLOW_HZ, course: Course::AfterRest },
    moves("one module alone", Motion::OneModule),
    spoiled("IMU 3 returns, zero 130° off, and bend sensor 3a open", |s| {
        s.imu_restarts(2, 0.7, 130.0);
        s.bend_opens(BEND_3A, true);
    }),
    spoiled("IMU 3 returns, zero 130° off, and bend sensor 5b frozen", |s| {
        s.imu_restarts(2, 0.7, 130.0);
        s.bend_freezes(9);
    }),
    spoiled("IMUs 3 and 4 return, zeros 130° and −60° off", |s| {
        s.imu_restarts(2, 0.7, 130.0);
        s.imu_restarts(3, 0.7, -60.0);
    }),
    spoiled("IMU 4 dead and bend sensor 4a open", |s| {
        s.imu_dies(3);
        s.bend_opens(6, false);
    }),
    Fault {
        name: "heading of IMU 3 jumps by 30° in contact",
        at_s: AT_S,
        rate_hz: SLOW_HZ,
        course: Course::SpoiledInContact(|s| s.heading_jumps(2, 30.0)),
    },
    Fault {
        name: "IMU 3 returns in contact, zero 130° off",
        at_s: AT_S,
        rate_hz: SLOW_HZ,
        course: Course::SpoiledInContact(|s| s.imu_restarts(2, 0.7, 130.0)),
    },
];
