//! Faults of bend sensors, converter and IMUs.

use telemetry::{Event, Message, SensorState};

use super::measured::{Measured, Row, bend_noticed_ms, imu_back_ms, imu_noticed_ms, slow, text_of, tip, with, within};
use crate::trial::Trial;

pub(super) const ROWS: &[(&str, Row)] = &[
    ("bend_open", bend_open),
    ("bend_short", bend_short),
    ("bend_intermittent", bend_intermittent),
    ("bend_offset", bend_offset),
    ("bend_drift", bend_drift),
    ("bend_factor", bend_factor),
    ("imu_unplugged", imu_unplugged),
    ("imu_frozen", imu_frozen),
    ("imu_frozen_slow", imu_frozen_slow),
    ("imu_reset", imu_reset),
    ("imu_brown_out", imu_brown_out),
    ("imu_replugged", imu_replugged),
    ("imu_zeros", imu_zeros),
    ("imu_norm", imu_norm),
    ("imu_single_wrong", imu_single_wrong),
    ("imu_jump", imu_jump),
    ("imu_short_jump", imu_short_jump),
    ("imu_nack", imu_nack),
    ("imu_stretch", imu_stretch),
    ("two_imus_reset", two_imus_reset),
    ("reset_and_open", reset_and_open),
    ("last_segment_lost", last_segment_lost),
    ("segment_lost", segment_lost),
];

fn bend_lost(row: &'static str, injected: &'static str) -> Measured {
    let trial = with(injected, 8_000);
    let noticed = bend_noticed_ms(&trial, 2);
    let used = trial.samples(20.0, 8e3).filter(|sample| sample.bend[2].is_some()).count();
    let (tip, is_near) = tip(&trial, 0.0, 8e3);
    Measured {
        row,
        injected,
        promise: "not ok within 50 ms, no reading of it used after 20 ms, the estimate stays near",
        measured: format!("not ok after {}; {used} readings used; {tip}", text_of(noticed)),
        holds: within(noticed, 50.0) && used == 0 && is_near,
    }
}

fn bend_open() -> Measured {
    bend_lost("bend sensor open", "bend2a:open")
}

fn bend_short() -> Measured {
    bend_lost("bend sensor short", "bend2a:short")
}

/// A fault that is reported within a limit, while the estimate stays near.
struct Reported {
    row: &'static str,
    injected: &'static str,
    promise: &'static str,
    /// Word for the report.
    word: &'static str,
    limit_ms: f64,
    /// Time that is measured after the fault, ms.
    measured_ms: u64,
}

impl Reported {
    /// Injects it; `reported_ms` finds the time of the report.
    fn measure(self, reported_ms: impl Fn(&Trial) -> Option<f64>) -> Measured {
        let trial = with(self.injected, self.measured_ms);
        self.of(&trial, reported_ms)
    }

    /// The same of a trial in which it was injected.
    fn of(self, trial: &Trial, reported_ms: impl Fn(&Trial) -> Option<f64>) -> Measured {
        let Self { row, injected, promise, word, limit_ms, measured_ms } = self;
        let reported = reported_ms(trial);
        let (tip, is_near) = tip(trial, 0.0, measured_ms as f64);
        let measured = format!("{word} after {}; {tip}", text_of(reported));
        Measured { row, injected, promise, measured, holds: within(reported, limit_ms) && is_near }
    }
}

fn bend_intermittent() -> Measured {
    let row = Reported {
        row: "bend sensor lost in every second tick",
        injected: "bend2a:intermittent",
        promise: "not ok within 1 s, the estimate stays near",
        word: "not ok",
        limit_ms: 1e3,
        measured_ms: 4_000,
    };
    row.measure(|trial| bend_noticed_ms(trial, 2))
}

fn bend_wrong(row: &'static str, injected: &'static str) -> Measured {
    let promise = "named within 1 s, the estimate stays near";
    let row = Reported { row, injected, promise, word: "named", limit_ms: 1e3, measured_ms: 12_000 };
    row.measure(|trial| bend_noticed_ms(trial, 2))
}

fn bend_offset() -> Measured {
    bend_wrong("bend sensor wrong", "bend2a:offset=300")
}

fn bend_factor() -> Measured {
    bend_wrong("bend sensor with another scale", "bend2a:factor=1.3")
}

/// What a sensor drifts in its first seconds is within its errors.
fn bend_drift() -> Measured {
    let row = Reported {
        row: "bend sensor that drifts",
        injected: "bend2a:drift=30",
        promise: "named within 10 s, the estimate stays near",
        word: "named",
        limit_ms: 10e3,
        measured_ms: 12_000,
    };
    row.measure(|trial| bend_noticed_ms(trial, 2))
}

fn imu_unplugged() -> Measured {
    let injected = "imu3:unplugged";
    let trial = with(injected, 8_000);
    let noticed = imu_noticed_ms(&trial, 2);
    let lost = trial.without_others(8e3);
    let (tip, is_near) = tip(&trial, 0.0, 8e3);
    Measured {
        row: "IMU unplugged",
        injected,
        promise: "not ok within 50 ms, the other five read in every tick, the estimate stays near",
        measured: format!("not ok after {}; {lost} ticks without one of the others; {tip}", text_of(noticed)),
        holds: within(noticed, 50.0) && lost == 0 && is_near,
    }
}

fn imu_frozen() -> Measured {
    let row = Reported {
        row: "IMU frozen while the others move",
        injected: "imu3:frozen",
        promise: "stuck within 0.52 s, the estimate stays near",
        word: "stuck",
        limit_ms: 520.0,
        measured_ms: 8_000,
    };
    row.measure(stuck_ms)
}

fn imu_frozen_slow() -> Measured {
    let row = Reported {
        row: "IMU frozen in slow motion, a twelfth of the speed",
        injected: "imu3:frozen",
        promise: "stuck within 1 s, the estimate stays near",
        word: "stuck",
        limit_ms: 1e3,
        measured_ms: 8_000,
    };
    let mut trial = slow();
    trial.inject(row.injected);
    trial.run_ms(row.measured_ms);
    row.of(&trial, stuck_ms)
}

/// Time of the first event that reports IMU 3 as stuck, ms.
fn stuck_ms(trial: &Trial) -> Option<f64> {
    trial.noticed_ms(|event| event == Event::Imu(2, SensorState::Stuck))
}

fn imu_restarted(row: &'static str, injected: &'static str, trial: &Trial) -> Measured {
    let (noticed, back) = (imu_noticed_ms(trial, 2), imu_back_ms(trial, 2));
    let (tip, is_near) = tip(trial, 0.0, 12e3);
    Measured {
        row,
        injected,
        promise: "noticed within 100 ms, ok again within 2 s, no step in the estimate",
        measured: format!("noticed after {}, ok after {}; {tip}", text_of(noticed), text_of(back)),
        holds: within(noticed, 100.0) && within(back, 2e3) && is_near,
    }
}

fn imu_reset() -> Measured {
    imu_restarted("IMU reset: 650 ms of boot, another zero", "imu3:reset", &with("imu3:reset", 12_000))
}

fn imu_brown_out() -> Measured {
    imu_restarted("IMU brown-out: CONFIG mode, another zero", "imu3:brown-out", &with("imu3:brown-out", 12_000))
}

fn imu_replugged() -> Measured {
    let mut trial = with("imu3:unplugged", 500);
    trial.board.clear("imu3:unplugged");
    trial.run_ms(11_500);
    imu_restarted("IMU unplugged for 0.5 s: another zero", "imu3:unplugged+0.5", &trial)
}

fn imu_invalid(row: &'static str, injected: &'static str) -> Measured {
    let trial = with(injected, 8_000);
    let noticed = imu_noticed_ms(&trial, 2);
    let used = trial.samples(20.0, 8e3).filter(|sample| sample.imu[2].is_some()).count();
    let (tip, is_near) = tip(&trial, 0.0, 8e3);
    Measured {
        row,
        injected,
        promise: "no reading of it used after 20 ms, garbage within 50 ms, the estimate stays near",
        measured: format!("garbage after {}; {used} readings used; {tip}", text_of(noticed)),
        holds: used == 0 && within(noticed, 50.0) && is_near,
    }
}

fn imu_zeros() -> Measured {
    imu_invalid("IMU with quaternions of zeros", "imu3:zeros")
}

fn imu_norm() -> Measured {
    imu_invalid("IMU with quaternions of norm 0.7", "imu3:norm=0.7")
}

/// A fault of IMU 3 that lasts for `ms`, in a trial of `whole_ms`.
fn imu_briefly(row: &'static str, injected: &'static str, fault: &str, [ms, whole_ms]: [u64; 2]) -> Measured {
    let mut trial = with(fault, ms);
    trial.board.clear(fault);
    trial.run_ms(whole_ms - ms);
    let (measured, holds) = tip(&trial, 0.0, whole_ms as f64);
    Measured { row, injected, promise: "no step in the estimate", measured, holds }
}

fn imu_single_wrong() -> Measured {
    imu_briefly("a single wrong output of an IMU", "imu3:random+0.01", "imu3:random", [10, 8_000])
}

fn imu_jump() -> Measured {
    let row = Reported {
        row: "heading jump of 30°",
        injected: "imu3:jump=30",
        promise: "reported within 30 ms, no step in the estimate",
        word: "reported",
        limit_ms: 30.0,
        measured_ms: 12_000,
    };
    row.measure(|trial| imu_noticed_ms(trial, 2))
}

fn imu_short_jump() -> Measured {
    imu_briefly("heading jump of 30° for 50 ms", "imu3:jump=30+0.05", "imu3:jump=30", [50, 12_000])
}

fn imu_nack() -> Measured {
    let injected = "imu3:nack=0.1";
    let trial = with(injected, 8_000);
    let others = trial.without_others(8e3);
    let (tip, is_near) = tip(&trial, 0.0, 8e3);
    Measured {
        row: "IMU that refuses a tenth of its addresses",
        injected,
        promise: "the other five read in every tick, the estimate stays near",
        measured: format!("{others} ticks without one of the others; {tip}"),
        holds: others == 0 && is_near,
    }
}

fn imu_stretch() -> Measured {
    let injected = "imu3:stretch=20";
    let trial = with(injected, 4_000);
    let overruns = trial.board.healths().next_back().map_or(u32::MAX, |health| health.overruns);
    let noticed = imu_noticed_ms(&trial, 2);
    let (tip, is_near) = tip(&trial, 0.0, 4e3);
    Measured {
        row: "IMU that stretches the clock by 20 ms",
        injected,
        promise: "not ok within 50 ms, no overrun, the estimate stays near",
        measured: format!("not ok after {}; {overruns} overruns; {tip}", text_of(noticed)),
        holds: within(noticed, 50.0) && overruns == 0 && is_near,
    }
}

fn two_imus_reset() -> Measured {
    let injected = "imu3:reset imu5:reset";
    imu_restarted("two IMUs reset at once", injected, &with(injected, 12_000))
}

fn reset_and_open() -> Measured {
    let injected = "bend2a:open imu3:reset";
    imu_restarted("IMU reset while a bend sensor is open", injected, &with(injected, 12_000))
}

fn last_segment_lost() -> Measured {
    let injected = "imu6:unplugged bend6a:open bend6b:open";
    let trial = with(injected, 4_000);
    let known_ms = |segment: usize| {
        let is_known = |message: &Message| match message {
            Message::Estimate(estimate) => estimate.segments[segment].is_some(),
            _ => false,
        };
        trial.timed(0.0, 4e3).filter(|(_, message)| is_known(message)).map(|(ms, _)| ms).last().unwrap_or(0.0)
    };
    let (tip_ms, below_ms) = (known_ms(5), known_ms(4));
    Measured {
        row: "all sensors of the last segment lost",
        injected,
        promise: "the segment is not known within 0.6 s, those below it are",
        measured: format!("last estimate of it after {tip_ms:.1} ms, of the segment below after {below_ms:.1} ms"),
        holds: tip_ms <= 600.0 && below_ms > 3_900.0,
    }
}

fn segment_lost() -> Measured {
    let injected = "imu3:unplugged bend3a:open bend3b:open";
    let row = Reported {
        row: "all sensors of another segment lost",
        injected,
        promise: "not ok within 50 ms, the estimate stays near by the sensors of the next segment",
        word: "not ok",
        limit_ms: 50.0,
        measured_ms: 8_000,
    };
    row.measure(|trial| imu_noticed_ms(trial, 2))
}

impl Trial {
    /// Number of samples up to a time after the fault, ms, without one of the IMUs other than IMU 3.
    fn without_others(&self, to_ms: f64) -> usize {
        let is_missing = |sample: &&telemetry::Sample| (0..6).any(|imu| imu != 2 && sample.imu[imu].is_none());
        self.samples(0.0, to_ms).filter(is_missing).count()
    }

    /// Samples from one time after the fault to another.
    fn samples(&self, from_ms: f64, to_ms: f64) -> impl Iterator<Item = &telemetry::Sample> {
        self.received(from_ms, to_ms).filter_map(|message| match message {
            Message::Sample(sample) => Some(sample),
            _ => None,
        })
    }
}
