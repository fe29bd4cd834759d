//! The shape's task: IMUs, sample, estimate, and what is said of them.

use atsam3x8e_hal::gpio::{Output, Pin};
use atsam3x8e_hal::tc::prelude::*;
use board_core::imus::Imus;
use board_core::{Actuator, Arm, Bends, Due, Task};
use rtic::Mutex;
use telemetry::{Actuation, Estimate, Event, Health, Hello, Message, REGULATORS, SEGMENTS, Sample, SensorState};

use crate::SUPERVISOR;
use crate::imu_bus::ImuBus;
use crate::load::Load;
use crate::parameters::IMUS_US;
use crate::requests::Control;
use crate::table::TABLE;
use crate::tick::Tick;
use crate::voice::Voice;

/// Events of one tick that are said; more are not.
const EVENTS: usize = 16;

/// What the shape's task needs.
pub struct Shape {
    imus: Imus<ImuBus, Pin<'B', 26, Output>>,
    bends: Bends,
    arm: &'static mut Arm,
    hello: Hello,
    /// A boot loop: the pressures stay at zero.
    safe_mode: bool,
    load: Load,
    last_tick: Option<u32>,
    counters: Counters,
}

/// What [`Health`] tells of the ticks themselves.
#[derive(Default)]
struct Counters {
    longest_tick_us: u32,
    longest_imu_read_us: u32,
    overruns: u32,
    stale_scans: u32,
}

/// What one tick found out.
struct Round {
    sample: Sample,
    estimate: Estimate,
    events: heapless::Vec<Event, EVENTS>,
}

impl Shape {
    /// At boot.
    pub fn new(imus: Imus<ImuBus, Pin<'B', 26, Output>>, arm: &'static mut Arm, hello: Hello, safe_mode: bool) -> Self {
        arm.start();
        Self {
            imus,
            bends: Bends::new(),
            arm,
            hello,
            safe_mode,
            load: Load::new(),
            last_tick: None,
            counters: Counters::default(),
        }
    }

    /// One tick, from the IMUs to the line.
    pub async fn run(
        &mut self,
        tick: Tick,
        mut actuator: impl Mutex<T = Actuator>,
        mut control: impl Mutex<T = Control>,
        mut voice: impl Mutex<T = Voice>,
    ) {
        self.count_overruns(tick.number);
        let deadline = instant(tick.time_us + IMUS_US);
        // A round that takes longer is cut off; what was read until then counts.
        let _ = Mono::timeout_at(deadline, self.imus.read(tick.number)).await;
        self.counters.longest_imu_read_us = self.counters.longest_imu_read_us.max(since(tick.time_us));
        SUPERVISOR.report(Task::Imus, tick.number);

        let tare = control.lock(|control| core::mem::take(&mut control.tare));
        let mut round = self.round(&tick, tare);
        SUPERVISOR.report(Task::Estimator, tick.number);
        self.counters.longest_tick_us = self.counters.longest_tick_us.max(since(tick.time_us));

        let degraded = self.safe_mode || self.is_degraded();
        let (actuation, pressures_pa) = actuator.lock(|actuator| {
            actuator.set_degraded(degraded);
            while let Some(event) = actuator.event() {
                let _ = round.events.push(event);
            }
            (actuator.state(), actuator.pressures_pa())
        });
        let (mut due, damaged_frames) = control.lock(|control| {
            let due = control.schedule.due(tick.number);
            (Due { hello: core::mem::take(&mut control.hello) || due.hello, ..due }, control.damaged_frames)
        });
        due.hello |= self.last_tick.is_none();
        self.last_tick = Some(tick.number);
        let uncertainty = due.uncertainty.then(|| self.arm.uncertainty(tick.number));
        voice.lock(|voice| {
            self.say(voice, &round, due);
            if let Some(uncertainty) = uncertainty {
                voice.say(&Message::Uncertainty(uncertainty));
            }
            if due.health {
                let health = self.health(tick.number, voice.dropped(), damaged_frames, actuation, pressures_pa);
                voice.say(&Message::Health(health));
            }
        });
        SUPERVISOR.report(Task::Telemetry, tick.number);
    }

    fn count_overruns(&mut self, tick: u32) {
        let skipped = self.last_tick.map_or(0, |last| tick.wrapping_sub(last).saturating_sub(1));
        self.counters.overruns = self.counters.overruns.saturating_add(skipped);
    }

    /// Judges the readings, and steps the estimator.
    fn round(&mut self, tick: &Tick, tare: bool) -> Round {
        let judged = self.imus.judge();
        let mut events = heapless::Vec::new();
        for event in judged.events {
            let _ = events.push(event);
        }
        if tick.scan.is_none() {
            self.counters.stale_scans = self.counters.stale_scans.saturating_add(1);
        }
        let bend = self.bends.step(tick.scan.as_ref(), |event| {
            let _ = events.push(event);
        });
        if tare || self.arm.is_due(tick.number, judged.imu.iter().all(Option::is_some)) {
            self.arm.tare();
            let _ = events.push(Event::Tare(tick.number));
        }
        let sample = Sample { tick: tick.number, time_us: tick.time_us, tare: self.arm.tares(), bend, imu: judged.imu };
        let estimate = self.arm.step(&sample);
        if let Some(event) = self.arm.contact(tick.number) {
            let _ = events.push(event);
        }
        Round { sample, estimate, events }
    }

    fn say(&self, voice: &mut Voice, round: &Round, due: Due) {
        if due.hello {
            voice.say(&Message::Hello(self.hello.clone()));
        }
        // Samples first: without them, nothing can be replayed.
        if due.sample {
            voice.say(&Message::Sample(round.sample));
        }
        if due.estimate {
            voice.say(&Message::Estimate(round.estimate));
        }
        for event in &round.events {
            voice.say(&Message::Event(*event));
        }
    }

    /// Whether too little of the arm is known to let the pressures rise: no IMU at all, or a segment whose bend sensors
    /// are all lost.
    fn is_degraded(&self) -> bool {
        let no_imu = self.imus.health().iter().all(|imu| imu.state != SensorState::Ok);
        let has_sensors =
            |segment: usize| TABLE.segments.get(segment).is_some_and(|s| s.bend.iter().any(Option::is_some));
        no_imu || (0..SEGMENTS).any(|segment| has_sensors(segment) && self.bends.segment_is_lost(segment))
    }

    fn health(
        &mut self,
        tick: u32,
        dropped_frames: u32,
        damaged_frames: u32,
        actuation: Actuation,
        pressures_pa: [u32; REGULATORS],
    ) -> Health {
        let counters = &mut self.counters;
        Health {
            tick,
            bend: self.bends.health(),
            imu: self.imus.health(),
            longest_tick_us: core::mem::take(&mut counters.longest_tick_us),
            longest_imu_read_us: core::mem::take(&mut counters.longest_imu_read_us),
            load_permille: self.load.permille(),
            overruns: counters.overruns,
            stale_scans: counters.stale_scans,
            dropped_frames,
            damaged_frames,
            bus_recoveries: self.imus.bus_recoveries(),
            saturations: estimator_core::saturations(),
            actuation,
            pressures_pa,
        }
    }
}

/// µs from `time_us` to now.
fn since(time_us: u64) -> u32 {
    Mono::now_us().saturating_sub(time_us) as u32
}

/// A time in µs as the monotonic's.
fn instant(time_us: u64) -> <Mono as Timebase>::Instant {
    <Mono as Timebase>::Instant::from_ticks(0) + time_us.micros()
}
