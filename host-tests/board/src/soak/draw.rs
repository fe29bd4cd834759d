//! Faults of the soak, drawn by its seed from those [by name](../../../../docs/reference/faults.md).

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rig_twin::Fault;

use crate::flash::table_addresses;

/// Share of the episodes with two faults.
const PAIRS: f64 = 0.25;
/// Longest time from the first fault of a pair to the second, ms.
const BETWEEN_MS: f64 = 2_000.0;
/// Shortest and longest duration of a fault, ms.
const DURATION_MS: [f64; 2] = [20.0, 6_000.0];
/// Interrupts of the firmware's tasks: the IMUs' bus, the tick and the timer of waiting tasks.
const INTERRUPTS: [u8; 3] = [23, 27, 28];

/// A fault with its times, ms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawn {
    /// The fault.
    pub fault: Fault,
    /// Its begin after that of the episode's first fault; even.
    pub begin_ms: u64,
    /// Its end, likewise. Faults that happen at an instant have none, but for a flipped bit, which is flipped back.
    pub end_ms: u64,
}

/// Draws the faults of one episode after the other.
pub struct Draw {
    random: ChaCha8Rng,
    /// Addresses of the stored table's bytes.
    stored: Vec<usize>,
}

impl Draw {
    /// The episodes of this seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { random: ChaCha8Rng::seed_from_u64(seed), stored: table_addresses() }
    }

    /// The faults of the next episode.
    pub fn episode(&mut self) -> Vec<Drawn> {
        let first = self.drawn(0.0);
        if self.share() >= PAIRS {
            return vec![first];
        }
        let begin_ms = self.between(0.0, BETWEEN_MS);
        loop {
            let second = self.drawn(begin_ms);
            if can_be_together(first.fault, second.fault) {
                return vec![first, second];
            }
        }
    }

    fn drawn(&mut self, begin_ms: f64) -> Drawn {
        let fault = self.fault();
        let [low, high] = DURATION_MS;
        let duration_ms = self.scaled(low, high);
        let even = |ms: f64| 2 * (ms / 2.0).round() as u64;
        Drawn { fault, begin_ms: even(begin_ms), end_ms: even(begin_ms + duration_ms) }
    }

    fn fault(&mut self) -> Fault {
        let bend = format!("bend{}{}", self.below(6) + 1, ["a", "b"][self.below(2)]);
        let imu = format!("imu{}", self.below(6) + 1);
        let sign = [-1.0, 1.0][self.below(2)];
        let stored = self.below(self.stored.len());
        let name = match self.below(38) {
            0 => format!("{bend}:open"),
            1 => format!("{bend}:short"),
            2 => format!("{bend}:stuck"),
            3 => format!("{bend}:intermittent"),
            4 => format!("{bend}:drift={:.0}", sign * self.scaled(10.0, 300.0)),
            5 => format!("{bend}:offset={:.0}", sign * self.scaled(50.0, 1000.0)),
            6 => format!("{bend}:factor={:.2}", self.between(0.3, 2.0)),
            7 => format!("{imu}:unplugged"),
            8 => format!("{imu}:reset"),
            9 => format!("{imu}:brown-out"),
            10 => format!("{imu}:frozen"),
            11 => format!("{imu}:jump={:.0}", sign * self.scaled(5.0, 180.0)),
            12 => format!("{imu}:random"),
            13 => format!("{imu}:zeros"),
            14 => format!("{imu}:norm={:.2}", self.between(0.1, 2.5)),
            15 => format!("{imu}:nack={:.3}", self.scaled(0.01, 1.0)),
            16 => format!("{imu}:stretch={:.2}", self.scaled(0.05, 50.0)),
            17 => "sda:held".to_owned(),
            18 => format!("sda:held-clocks={}", 1 + self.below(20)),
            19 => "sda:held-until-reset".to_owned(),
            20 => "scl:held".to_owned(),
            21 => "scl:held-until-reset".to_owned(),
            22 => "mux:silent".to_owned(),
            23 => "mux:stuck".to_owned(),
            24 => format!("mux:wrong={}", 1 + self.below(7)),
            25 => format!("mux:lying={}", 1 + self.below(7)),
            26 => "adc:stopped".to_owned(),
            27 => "adc:tags".to_owned(),
            28 => "adc:tags-every-other".to_owned(),
            29 => format!("line:noise={:.4}", self.scaled(0.0001, 0.02)),
            30 => "line:flood".to_owned(),
            31 => "line:cut".to_owned(),
            32 => format!("line:replay={:.2}", self.scaled(0.05, 10.0)),
            33 => "line:reorder".to_owned(),
            34 => format!("flash:flip={}", self.stored[stored]),
            35 => "power:cut".to_owned(),
            36 => format!("irq{}:masked", INTERRUPTS[self.below(INTERRUPTS.len())]),
            _ => "stack:overflow".to_owned(),
        };
        name.parse().expect("every name here is that of a fault")
    }

    /// A number from 0 to below 1.
    fn share(&mut self) -> f64 {
        f64::from(self.random.next_u32()) / 2.0_f64.powi(32)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.share() * end as f64) as usize
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + self.share() * (high - low)
    }

    /// A number of equal chance in each octave.
    fn scaled(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low.ln(), high.ln())).exp()
    }
}

/// False for two faults of one device, and where a converter that fails hides the first scan after a restart, by which the
/// truth finds its tick.
fn can_be_together(first: Fault, second: Fault) -> bool {
    let device = |fault: Fault| fault.to_string().split(':').next().map(ToOwned::to_owned);
    let hides = |one: Fault, other: Fault| matches!(one, Fault::AdcStopped) && restarts(other);
    device(first) != device(second) && !hides(first, second) && !hides(second, first)
}

/// True if the fault may restart the board.
#[must_use]
pub const fn restarts(fault: Fault) -> bool {
    matches!(fault, Fault::PowerCut | Fault::IrqMasked(_) | Fault::StackOverflow)
}

/// True if messages of the board do not arrive while the fault is there.
#[must_use]
pub const fn loses_messages(fault: Fault) -> bool {
    matches!(fault, Fault::LineCut | Fault::LineNoise(_))
}

/// Name of a fault without the number of its sensor and without its value, for tables: `bend:offset`.
#[must_use]
pub fn kind(fault: Fault) -> String {
    let name = fault.to_string();
    let name = name.split('=').next().unwrap_or_default();
    let (device, fault) = name.split_once(':').unwrap_or_default();
    let device = match device {
        device if device.starts_with("bend") => "bend",
        device if device.starts_with("imu") => "imu",
        device => device,
    };
    format!("{device}:{fault}")
}
