//! The live values for a terminal: one line per second.

use std::fmt::Write;

use estimator_core::Q;
use proprio_link::{EventKind, LinkEvent, LinkState};
use proprio_session::{HostNs, SENSOR_NAMES};
use telemetry::{Actuation, Estimate, Message, SensorState};

use super::live::Live;

/// State of the lines for a terminal.
pub struct Plain {
    live: Live<'static>,
    estimate: Option<Estimate>,
}

impl Plain {
    /// The state before the first event.
    #[must_use]
    pub fn new() -> Self {
        Self { live: Live::new(None, None), estimate: None }
    }

    /// Takes an event of the link.
    pub fn take(&mut self, event: &LinkEvent) {
        if let EventKind::Message(Message::Estimate(estimate)) = &event.kind {
            self.estimate = Some(estimate.clone());
        }
        self.live.take(event);
    }

    /// The current line: bend angles, the tip, rates of the last two seconds, and sensors with faults.
    #[must_use]
    pub fn line(&mut self, now: HostNs, link: &LinkState) -> String {
        let rates = self.live.rates(now);
        let value = |bits: i32| Q::from_bits(bits).to_f64();
        let mut line = String::new();
        // Writing to a string does not fail.
        let _ = match (&link.port, &self.estimate) {
            (None, _) => write!(line, "the line is gone"),
            (_, None) => write!(line, "no estimate yet"),
            (_, Some(Estimate { segments, .. })) => {
                let thetas = segments.iter().map(|segment| {
                    segment.map_or("?".to_owned(), |segment| format!("{:+.1}", value(segment.theta).to_degrees()))
                });
                let thetas: Vec<_> = thetas.collect();
                let tip = segments.last().copied().flatten().map(|tip| tip.end.map(|bits| value(bits) * 1e3));
                let tip = tip.map_or("?".to_owned(), |[x, y]| format!("{x:.1} {y:.1}"));
                write!(line, "θ {}°  tip {tip} mm", thetas.join(" "))
            }
        };
        let _ = write!(
            line,
            "  {:.1} samples/s  {} lost  {} damaged",
            rates.samples_hz, link.counts.lost, link.counts.damaged
        );
        if let Some(health) = &self.live.health {
            let _ = write!(line, "  load {:.1} %", f64::from(health.load_permille) / 10.0);
            if health.actuation != Actuation::Disarmed {
                let _ = write!(line, "  {:?}", health.actuation);
            }
        }
        let health = self.live.health.iter();
        let is_lost = |state| !matches!(state, SensorState::Ok | SensorState::NotWired);
        for (i, sensor) in health.clone().flat_map(|health| health.bend.iter().enumerate()) {
            if is_lost(sensor.state) {
                let _ = write!(line, "  bend {}{} {}", i / 2 + 1, SENSOR_NAMES[i % 2], sensor.state);
            }
        }
        for (i, sensor) in health.flat_map(|health| health.imu.iter().enumerate()) {
            if is_lost(sensor.state) {
                let _ = write!(line, "  IMU {} {}", i + 1, sensor.state);
            }
        }
        line
    }
}

impl Default for Plain {
    fn default() -> Self {
        Self::new()
    }
}
