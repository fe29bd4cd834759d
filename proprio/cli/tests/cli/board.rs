//! A synthetic board: the firmware's estimator and frames, over the readings of the twin's sensors.

use board_estimator::BoardEstimator;
use calibration_tables::ArmFile;
use estimator_core::Q;
use proprio_simulation::Simulation;
use rig_twin::Scenario;
use telemetry::{
    Actuation, Conditions, Encoder, Estimate, Health, Hello, MAX_FRAME, Message, PROTOCOL_VERSION, PressureLimit,
    ResetCause, SCHEMA, Sample, SensorHealth, SensorState, TICK_HZ, Text,
};

use super::common::table;

/// Segments of the reference arm.
const SEGMENTS: usize = 6;
/// Bend sensors of the reference arm.
const BEND_SENSORS: usize = 2 * SEGMENTS;
/// Tick at which the IMUs come up.
const IMUS_UP: u32 = 80;

/// A board, from its boot on, frame by frame.
pub struct SyntheticBoard {
    estimator: BoardEstimator,
    encoder: Encoder,
    simulation: Simulation,
    boot: u32,
    tick: u32,
    table: u32,
}

impl SyntheticBoard {
    /// The boot number of a board that then runs for some seconds.
    pub fn new(boot: u32, seconds: f64) -> Self {
        let file = ArmFile::load(table().as_ref()).expect("the reference table");
        let compiled = Box::leak(Box::new(file.compile::<Q>(TICK_HZ).expect("it is a table")));
        let checksum = compiled.checksum();
        let mut estimator = BoardEstimator::new(Box::leak(Box::new(compiled.config())));
        estimator.start();
        let simulation =
            Simulation::new(Scenario::FreeSwing, 77 + u64::from(boot), seconds, TICK_HZ).expect("a valid run");
        Self { estimator, encoder: Encoder::new(), simulation, boot, tick: 0, table: checksum }
    }

    /// The arm is tared before the next sample.
    pub fn tare(&mut self) {
        self.estimator.tare();
    }

    /// The frames of the next tick, with the estimate that is in them.
    pub fn tick(&mut self) -> Option<(Vec<Vec<u8>>, Estimate)> {
        let read = self.simulation.next()?;
        let tick = self.tick;
        self.tick += 1;
        let mut imu = read.quaternions;
        if tick < IMUS_UP {
            imu.fill(None);
        }
        if self.estimator.needs_first_tare(tick, imu.iter().all(Option::is_some)) {
            self.estimator.tare();
        }
        let mut bend = read.counts;
        if tick % 50 == 7 {
            bend[(tick / 50) as usize % BEND_SENSORS] = None;
        }
        let sample = Sample {
            tick,
            time_us: u64::from(tick) * 10_000 + 137,
            tare_epoch: self.estimator.tare_epoch(),
            bend,
            imu,
        };
        let estimate = self.estimator.update(&sample);
        let contact = self.estimator.contact_event(tick);
        let mut messages: Vec<Message> = Vec::new();
        messages.extend(tick.is_multiple_of(100).then(|| Message::Hello(self.hello())));
        messages.extend([Message::Sample(sample), Message::Estimate(estimate.clone())]);
        messages.extend(contact.map(Message::Event));
        messages.extend(tick.is_multiple_of(25).then(|| Message::Uncertainty(self.estimator.uncertainty(tick))));
        messages.extend(tick.is_multiple_of(20).then(|| Message::Health(health(tick))));
        let mut buffer = [0; MAX_FRAME];
        let frame = |message: &Message| self.encoder.encode(message, &mut buffer).expect("it fits").to_vec();
        Some((messages.iter().map(frame).collect(), estimate))
    }

    fn hello(&self) -> Hello {
        let text = |text: &str| Text::try_from(text).expect("it is short");
        Hello {
            protocol: PROTOCOL_VERSION,
            schema: SCHEMA,
            firmware: text(env!("CARGO_PKG_VERSION")),
            revision: text("synthetic"),
            arm: Text::try_from("planar-6").expect("it is short"),
            table: self.table,
            segments: SEGMENTS as u8,
            bend_sensors: BEND_SENSORS as u8,
            regulators: 6,
            chip: *b"a synthetic Due!",
            reset: ResetCause::Pin,
            boot: self.boot,
            last_panic: None,
        }
    }

    /// All bytes that it sends.
    pub fn bytes(self) -> Vec<u8> {
        self.flat_map(|(frames, _)| frames.concat()).collect()
    }
}

impl Iterator for SyntheticBoard {
    type Item = (Vec<Vec<u8>>, Estimate);

    fn next(&mut self) -> Option<Self::Item> {
        self.tick()
    }
}

fn health(tick: u32) -> Health {
    let ok = SensorHealth { state: SensorState::Ok, missed: 0 };
    Health {
        tick,
        bend: [ok; BEND_SENSORS].into_iter().collect(),
        imu: [ok; SEGMENTS].into_iter().collect(),
        max_estimate_latency_us: 3000,
        longest_imu_read_us: 2000,
        load_permille: 100,
        overruns: 0,
        stale_scans: 0,
        dropped_frames: 0,
        damaged_frames: 0,
        unknown_frames: 0,
        bus_recoveries: 0,
        saturations: 0,
        conditions: [Conditions::default(); SEGMENTS].into_iter().collect(),
        actuation: Actuation::Disarmed,
        limit: PressureLimit::None,
        pressures_pa: [0; 6].into_iter().collect(),
    }
}
