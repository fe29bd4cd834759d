//! Estimation task: reads the IMUs, updates the estimator and sends the messages of the tick.

use core::mem::MaybeUninit;

use atsam3x8e_hal::tc::prelude::*;
use board_core::imus::Imus;
use board_core::{Actuator, BendSensorMonitor, DueMessages, Pressures, RestMonitor, Task};
use board_estimator::BoardEstimator;
use estimator_core::{ArmConfig, Q};
use rtic::Mutex;
use telemetry::{
    Actuation, Counts, Estimate, Event, Health, Hello, Message, PressureLimit, Sample, SensorState, TableState,
};

use crate::board::MuxReset;
use crate::command_task::{Control, Pose};
use crate::cpu_load::CpuLoad;
use crate::downlink::TelemetrySender;
use crate::imu_bus::ImuBus;
use crate::parameters::IMUS_US;
use crate::supervision::SUPERVISOR;
use crate::tick::Tick;

/// Maximum events sent per tick; further ones are discarded.
const EVENTS: usize = 16;

/// Least ticks of 10 ms from one `Hello` to the next, however often one is requested.
const HELLO_PAUSE_TICKS: u32 = 10;

/// The arm's sensors.
pub struct Sensors {
    pub imus: Imus<ImuBus, MuxReset>,
    pub bend: BendSensorMonitor,
    pub rest: RestMonitor,
}

/// State of the estimation task.
pub struct EstimationTask {
    sensors: Sensors,
    estimator: &'static mut BoardEstimator,
    /// Without segments: the board has no table, and sends no estimates.
    config: &'static ArmConfig<'static, Q>,
    hello: Hello,
    table: TableState,
    /// A boot loop: the pressures stay at zero.
    safe_mode: bool,
    load: CpuLoad,
    last_tick: Option<u32>,
    last_hello: Option<u32>,
    counters: Counters,
}

/// Timing and counters of [`Health`].
#[derive(Default)]
struct Counters {
    max_estimate_latency_us: u32,
    longest_imu_read_us: u32,
    overruns: u32,
    stale_scans: u32,
}

/// Results of one cycle.
struct CycleResult {
    sample: Sample,
    estimate: Estimate,
    events: heapless::Vec<Event, EVENTS>,
}

/// Makes the estimator in its static. Not inlined: its parts are on the stack meanwhile, 7 kB that are free again when the
/// function returns.
#[inline(never)]
pub fn place_estimator(
    place: &'static mut MaybeUninit<BoardEstimator>,
    config: &'static ArmConfig<'static, Q>,
) -> &'static mut BoardEstimator {
    place.write(BoardEstimator::new(config))
}

impl EstimationTask {
    /// Starts the estimator.
    pub fn new(
        sensors: Sensors,
        estimator: &'static mut BoardEstimator,
        config: &'static ArmConfig<'static, Q>,
        hello: Hello,
        table: TableState,
        safe_mode: bool,
    ) -> Self {
        estimator.start();
        Self {
            sensors,
            estimator,
            config,
            hello,
            table,
            safe_mode,
            load: CpuLoad::new(),
            last_tick: None,
            last_hello: None,
            counters: Counters::default(),
        }
    }

    /// Runs one cycle, from the IMUs to the messages.
    pub async fn run(
        &mut self,
        tick: Tick,
        mut actuator: impl Mutex<T = Actuator>,
        mut control: impl Mutex<T = Control>,
        mut sender: impl Mutex<T = TelemetrySender>,
    ) {
        self.count_overruns(tick.number);
        let deadline = Mono::instant(tick.time_us + IMUS_US);
        // A poll that takes longer is cut off; the readings until then count.
        let _ = Mono::timeout_at(deadline, self.sensors.imus.read(tick.number)).await;
        self.counters.longest_imu_read_us = self.counters.longest_imu_read_us.max(since(tick.time_us));
        SUPERVISOR.report(Task::Imus, tick.number);

        let tare = control.lock(|control| core::mem::take(&mut control.tare_requested));
        let mut result = self.run_cycle(&tick, tare);
        SUPERVISOR.report(Task::Estimator, tick.number);
        self.counters.max_estimate_latency_us = self.counters.max_estimate_latency_us.max(since(tick.time_us));

        let limit = self.pressure_limit();
        let (actuation, pressures_pa) = actuator.lock(|actuator| {
            actuator.set_degraded(limit != PressureLimit::None);
            while let Some(event) = actuator.event() {
                let _ = result.events.push(event);
            }
            (actuator.state(), actuator.pressures_pa().clone())
        });
        let pose = Pose { turned: self.sensors.rest.most_turned(), bent: self.estimator.most_bent() };
        let may_introduce = self.last_hello.is_none_or(|last| tick.number.wrapping_sub(last) >= HELLO_PAUSE_TICKS);
        let (mut due, requested, received, tare_report) = control.lock(|control| {
            control.pose = pose;
            let requested = may_introduce && core::mem::take(&mut control.hello_requested);
            (control.schedule.due(tick.number), requested, control.received, control.tare_report.take())
        });
        let introduce = requested || self.last_hello.is_none();
        due.hello = introduce || (due.hello && may_introduce);
        if due.hello {
            self.last_hello = Some(tick.number);
        }
        self.last_tick = Some(tick.number);
        result.events.iter().for_each(log);
        let has_table = !self.config.segments.is_empty();
        due.estimate &= has_table;
        due.uncertainty &= has_table;
        let uncertainty = due.uncertainty.then(|| self.estimator.uncertainty(tick.number));
        sender.lock(|sender| {
            self.send(sender, &result, due, introduce);
            if let Some(report) = tare_report {
                sender.send(&Message::Tare(report));
            }
            if let Some(uncertainty) = uncertainty {
                sender.send(&Message::Uncertainty(uncertainty));
            }
            if due.health {
                let health = self.health(tick.number, sender.dropped(), received, limit, actuation, pressures_pa);
                sender.send(&Message::Health(health));
            }
        });
        SUPERVISOR.report(Task::Telemetry, tick.number);
    }

    fn count_overruns(&mut self, tick: u32) {
        let skipped = self.last_tick.map_or(0, |last| tick.wrapping_sub(last).saturating_sub(1));
        self.counters.overruns = self.counters.overruns.saturating_add(skipped);
    }

    /// Validates the readings and updates the estimator.
    fn run_cycle(&mut self, tick: &Tick, tare: bool) -> CycleResult {
        let readings = self.sensors.imus.validate();
        let all_imus_read = readings.all_are_read(&self.sensors.imus.health());
        self.sensors.rest.step(&readings.imu);
        let mut events = heapless::Vec::new();
        for event in &readings.events {
            let _ = events.push(*event);
        }
        if tick.scan.is_none() {
            self.counters.stale_scans = self.counters.stale_scans.saturating_add(1);
        }
        let bend = self.sensors.bend.step(tick.scan.as_ref(), |event| {
            let _ = events.push(event);
        });
        if tare || self.estimator.needs_first_tare(tick.number, all_imus_read) {
            self.estimator.tare();
            let _ = events.push(Event::Tare(tick.number));
        }
        let sample = Sample {
            tick: tick.number,
            time_us: tick.time_us,
            tare_epoch: self.estimator.tare_epoch(),
            bend,
            imu: readings.imu,
        };
        let estimate = self.estimator.update(&sample);
        let implausible = self.estimator.implausible();
        let mut report = |event| {
            let _ = events.push(event);
        };
        self.sensors.imus.set_implausible(implausible.imu, &mut report);
        self.sensors.bend.set_implausible(implausible.bend, &mut report);
        if let Some(event) = self.estimator.contact_event(tick.number) {
            let _ = events.push(event);
        }
        self.estimator.condition_events(tick.number, |event| {
            let _ = events.push(event);
        });
        CycleResult { sample, estimate, events }
    }

    /// Sends the messages of a tick; `introduce`: the first tick, or a host has sent a Ping.
    fn send(&self, sender: &mut TelemetrySender, result: &CycleResult, due: DueMessages, introduce: bool) {
        if due.hello {
            sender.send(&Message::Hello(self.hello.clone()));
        }
        if introduce {
            sender.send(&Message::Table(self.table));
        }
        // Samples first: a replay needs them.
        if due.sample {
            sender.send(&Message::Sample(result.sample.clone()));
        }
        if due.estimate {
            sender.send(&Message::Estimate(result.estimate.clone()));
        }
        for event in &result.events {
            sender.send(&Message::Event(*event));
        }
    }

    /// Limit of the pressures: none may rise while all IMUs that the arm has are lost, or all bend sensors of a segment.
    fn pressure_limit(&self) -> PressureLimit {
        let imus = self.sensors.imus.health();
        let mut wired = imus.iter().filter(|imu| imu.state != SensorState::NotWired).peekable();
        let no_imu = wired.peek().is_some() && wired.all(|imu| !imu.state.is_usable());
        let mut segments = self.config.segments.iter().enumerate();
        let no_bend = segments
            .any(|(i, segment)| segment.bend.iter().any(Option::is_some) && self.sensors.bend.segment_is_lost(i));
        if self.safe_mode {
            PressureLimit::SafeMode
        } else if no_imu || no_bend {
            PressureLimit::SensorsLost
        } else {
            PressureLimit::None
        }
    }

    fn health(
        &mut self,
        tick: u32,
        dropped_frames: u32,
        received: Counts,
        limit: PressureLimit,
        actuation: Actuation,
        pressures_pa: Pressures,
    ) -> Health {
        let counters = &mut self.counters;
        Health {
            tick,
            bend: self.sensors.bend.health(),
            imu: self.sensors.imus.health(),
            max_estimate_latency_us: core::mem::take(&mut counters.max_estimate_latency_us),
            longest_imu_read_us: core::mem::take(&mut counters.longest_imu_read_us),
            load_permille: self.load.permille(),
            overruns: counters.overruns,
            stale_scans: counters.stale_scans,
            dropped_frames,
            damaged_frames: received.damaged,
            unknown_frames: received.wrong_version.saturating_add(received.unknown),
            bus_recoveries: self.sensors.imus.bus_recoveries(),
            saturations: estimator_core::saturations(),
            conditions: self.estimator.conditions(),
            actuation,
            limit,
            pressures_pa,
        }
    }
}

/// Logs an event: faults of sensors and of their bus as warnings.
fn log(event: &Event) {
    let is_fault = match event {
        Event::Imu(_, state) | Event::Bend(_, state) => *state != SensorState::Ok,
        Event::BusRecovery => true,
        Event::Condition(_, conditions) => conditions.is_degraded(),
        Event::Actuation(_) | Event::Tare(_) | Event::Contact(..) => false,
    };
    if is_fault {
        defmt::warn!("{}", event);
    } else {
        defmt::info!("{}", event);
    }
}

/// Time from `time_us` to now, µs.
fn since(time_us: u64) -> u32 {
    Mono::now_us().saturating_sub(time_us) as u32
}
