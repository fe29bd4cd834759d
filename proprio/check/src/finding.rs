//! Findings of a session check, and the sensors that they are about.

use serde::Serialize;

pub use super::kind::Kind;
pub use super::rows::Rows;
pub use super::source::Source;

/// A fault of a session.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Finding {
    /// The sensor, or the time stamps.
    pub sensor: Source,
    /// The rows in which the fault is present.
    pub rows: Rows,
    /// Kind of the fault.
    pub kind: Kind,
    /// Figure of the fault; [`Kind`] defines it.
    pub figure: f64,
}

impl Finding {
    /// True for a finding about the tare after a restart of the board, which does not matter to a calibration: the zeros of a sweep
    /// are those of its truth.
    #[must_use]
    pub fn is_later_tare(&self) -> bool {
        matches!(self.kind, Kind::TareBent | Kind::TareMoves) && self.rows.first > 1
    }

    /// True for a finding about the bend sensors of a segment, from 1.
    fn is_about_bend(&self, number: usize) -> bool {
        match self.sensor {
            Source::Bend { segment, .. } | Source::Twins { segment } | Source::ImuOrBend { segment } => {
                segment == number
            }
            Source::TwoBends { segment, other } => segment == number || other == number,
            Source::TwoPlugs { segments, .. } => segments.contains(&number),
            Source::AllBend => true,
            _ => false,
        }
    }

    /// True for a finding about the IMU of a segment, from 1.
    fn is_about_imu(&self, number: usize) -> bool {
        match self.sensor {
            Source::Imu { segment } | Source::ImuOrBend { segment } => segment == number,
            Source::TwoImus { segment, other } => segment == number || other == number,
            Source::AllImus => true,
            _ => false,
        }
    }
}

/// True where a finding is about the bend sensors of a segment, from 1.
pub(super) fn is_bend_blamed(findings: &[Finding], number: usize) -> bool {
    findings.iter().any(|finding| finding.is_about_bend(number))
}

/// True where the bend angles of the segments up to this one, from 1, are wrong in the whole session.
pub(super) fn is_chain_wrong(findings: &[Finding], number: usize) -> bool {
    let is_whole = |finding: &&Finding| {
        matches!(finding.kind, Kind::Exchanged | Kind::Counts | Kind::TenBits | Kind::Inverted | Kind::Unrelated)
    };
    findings.iter().filter(is_whole).any(|finding| (1..=number).any(|segment| finding.is_about_bend(segment)))
}

/// True for a bend sensor whose plug is exchanged.
pub(super) fn is_exchanged(findings: &[Finding], sensor: Source) -> bool {
    findings.iter().any(|finding| match (finding.sensor, sensor) {
        (Source::TwoBends { segment, other }, Source::Bend { segment: of, .. }) => segment == of || other == of,
        (Source::TwoPlugs { segments, places }, Source::Bend { segment, place }) => {
            (0..2).any(|k| (segments[k], places[k]) == (segment, place))
        }
        _ => false,
    })
}

/// True where no finding is about the sensors of a segment, from 0: its bend sensors, and the IMUs at its ends.
pub(super) fn is_unblamed(findings: &[Finding], i: usize) -> bool {
    let is_start_blamed = i > 0 && is_imu_blamed(findings, i);
    !is_imu_blamed(findings, i + 1) && !is_start_blamed && !is_bend_blamed(findings, i + 1)
}

/// True where the IMU of a segment, from 1, is exchanged with another one.
pub(super) fn is_imu_exchanged(findings: &[Finding], number: usize) -> bool {
    findings.iter().any(|finding| finding.kind == Kind::Exchanged && finding.is_about_imu(number))
}

/// True where a finding is about the IMU of a segment, from 1.
pub(super) fn is_imu_blamed(findings: &[Finding], number: usize) -> bool {
    findings.iter().any(|finding| finding.is_about_imu(number))
}
