//! Tare of a board, and the pose of the arm at it.

use std::fmt;
use std::time::{Duration, Instant};

use estimator_core::Q;
use telemetry::{Command, Message, Refusal, TareMode, TareReport, protocol_2};

use crate::error::LinkError;
use crate::event::EventKind;
use crate::handle::Link;
use crate::requests::RequestError;
use crate::shared::Subscription;

/// Longest wait for the report after the reply.
const REPORT: Duration = Duration::from_secs(2);

/// Pose of the arm at a tare; unknown of a board of protocol 2, which reports none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tared(pub Option<TareReport>);

/// Reason why a board was not tared.
#[derive(Debug, thiserror::Error)]
pub enum TareError {
    /// The arm moves.
    #[error("the arm moves{}", moved(.0.as_ref()))]
    Moving(Option<TareReport>),
    /// The line, or another refusal of the board.
    #[error(transparent)]
    Link(LinkError),
}

/// Tares a board: its arm is in the reference pose now.
///
/// # Errors
/// [`TareError`].
pub fn tare(link: &Link, mode: TareMode) -> Result<Tared, TareError> {
    link.wait_until_connected().map_err(TareError::Link)?;
    let events = link.subscribe();
    let outcome = link.request(Command::Tare(mode));
    let reports = link.state().hello.is_none_or(|hello| hello.protocol != protocol_2::VERSION);
    match outcome {
        Ok(()) => Ok(Tared(reports.then(|| report(&events)).flatten())),
        Err(LinkError::Request(RequestError::Refused(Refusal::Moving))) => Err(TareError::Moving(report(&events))),
        Err(error) => Err(TareError::Link(error)),
    }
}

/// The report after the reply.
fn report(events: &Subscription) -> Option<TareReport> {
    let end = Instant::now() + REPORT;
    loop {
        let event = events.next(end.saturating_duration_since(Instant::now()))?;
        if let EventKind::Message(Message::Tare(report)) = event.kind {
            return Some(report);
        }
    }
}

/// Angle without its sign, degrees.
fn degrees(bits: i32) -> f64 {
    Q::from_bits(bits).to_f64().to_degrees().abs()
}

fn moved(report: Option<&TareReport>) -> String {
    report.and_then(|report| report.turned).map_or_else(String::new, |(segment, range)| {
        format!(": segment {} turned by {:.1}° in half a second", segment + 1, degrees(range))
    })
}

impl fmt::Display for Tared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("tared")?;
        let Some(TareReport { turned, bent, .. }) = self.0 else { return Ok(()) };
        match turned {
            Some((segment, range)) => write!(f, ": still within {:.1}° (segment {})", degrees(range), segment + 1)?,
            None => f.write_str(": no IMU was read")?,
        }
        match bent {
            Some((segment, angle)) => write!(f, ", straight within {:.1}° (segment {})", degrees(angle), segment + 1),
            None => f.write_str(", no bend sensor was read"),
        }
    }
}

#[cfg(test)]
mod tests {
    use telemetry::TareReport;

    use super::{TareError, Tared};

    /// An angle in the units of a report.
    fn bits(degrees: f64) -> i32 {
        (degrees.to_radians() * f64::from(1 << 26)).round() as i32
    }

    #[test]
    fn a_tare_is_reported_with_the_segments_and_angles_from_the_base() {
        let report = TareReport { id: 1, turned: Some((1, bits(0.12))), bent: Some((2, bits(-1.31))) };
        assert_eq!(
            Tared(Some(report)).to_string(),
            "tared: still within 0.1° (segment 2), straight within 1.3° (segment 3)"
        );
        let unread = TareReport { turned: None, bent: None, ..report };
        assert_eq!(Tared(Some(unread)).to_string(), "tared: no IMU was read, no bend sensor was read");
        assert_eq!(Tared(None).to_string(), "tared");
    }

    #[test]
    fn an_arm_that_moves_is_reported_with_its_fastest_segment() {
        let report = TareReport { id: 1, turned: Some((3, bits(5.2))), bent: None };
        let moving = TareError::Moving(Some(report)).to_string();
        assert_eq!(moving, "the arm moves: segment 4 turned by 5.2° in half a second");
    }
}
