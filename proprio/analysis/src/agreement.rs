//! Agreement of a board's estimates, uncertainties and contacts with those of a replay.

use std::fmt;

use calibration_tables::DriftKind;
use estimator_core::{Contact, Method, Q};
use proprio_session::{BoardOutput, Row, is_version_0_1};
use serde::Serialize;
use telemetry::{Estimate, SegmentEstimate, Uncertainty};

use crate::Outcome;

/// The estimator that a recording's estimates were made by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RecordedBy {
    /// This version's.
    #[default]
    ThisVersion,
    /// Version 0.1's with the moving-average anchor: the same estimates, other uncertainties.
    Anchor01,
    /// Version 0.1's with the drift observer, which the bias filter replaced.
    Observer01,
}

impl RecordedBy {
    /// The estimator of this firmware with a table of this drift correction.
    #[must_use]
    pub fn new(firmware: &str, drift: Option<DriftKind>) -> Self {
        match drift {
            _ if !is_version_0_1(firmware) => Self::ThisVersion,
            None | Some(DriftKind::Anchor) => Self::Anchor01,
            Some(DriftKind::Observer | DriftKind::Kalman) => Self::Observer01,
        }
    }
}

/// Comparison of the board's estimates with those of a replay, bit for bit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// Estimates that are in the recording.
    pub estimates: u64,
    /// Number of them that are the same in the replay.
    pub equal: u64,
    /// Number of them that are not compared: a sample since the estimator's start is not in the recording.
    pub not_compared: u64,
    /// The first that differs.
    pub first_difference: Option<Difference>,
    /// Agreement of the uncertainties.
    pub uncertainties: Agreement,
    /// Agreement of the changes of contact.
    pub contacts: Agreement,
    /// True where the board's table was that of the replay; `None` without a `Hello` in the recording, and for version 0.1.
    pub table_matches: Option<bool>,
    /// The estimator that has made the estimates.
    pub recorded_by: RecordedBy,
}

/// Agreement of one kind of message with the replay.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Agreement {
    /// Number of messages that are compared.
    pub compared: u64,
    /// Number of them that are the same in the replay.
    pub equal: u64,
    /// Number of the first tick that differs.
    pub first_difference: Option<u32>,
}

impl Agreement {
    fn add(&mut self, tick: u32, is_equal: bool) {
        self.compared += 1;
        self.equal += u64::from(is_equal);
        if !is_equal {
            self.first_difference.get_or_insert(tick);
        }
    }
}

/// An estimate that differs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    /// Number of the tick.
    pub tick: u32,
    /// The first segment that differs, from 1.
    pub segment: usize,
    /// The board's estimate; `None` where it is not known.
    pub recorded: Option<Values>,
    /// The estimate of the replay.
    pub computed: Option<Values>,
}

/// One segment's estimate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Values {
    /// Bend angle, rad.
    pub theta_rad: f64,
    /// World position of the segment's end, m.
    pub x_m: f64,
    /// World position of the segment's end, m.
    pub y_m: f64,
}

impl From<SegmentEstimate> for Values {
    fn from(of: SegmentEstimate) -> Self {
        let [theta_rad, x_m, y_m] = [of.theta, of.end[0], of.end[1]].map(|bits| Q::from_bits(bits).to_f64());
        Self { theta_rad, x_m, y_m }
    }
}

impl Comparison {
    /// Compares the board's output of one row.
    pub fn add(&mut self, row: &Row, outcome: &Outcome<Q>) {
        let Some(board) = &row.board else { return };
        self.add_estimate(board, outcome);
        if !board.complete {
            return;
        }
        if let Some(recorded) = &board.uncertainty {
            let segments = recorded.segments.len();
            let computed = Uncertainty::of(recorded.tick, segments, &outcome.uncertainties, &outcome.contacts);
            self.uncertainties.add(board.tick, *recorded == computed);
        }
        if let Some(recorded) = board.contact {
            let mask = |mask: u8, contact: &Contact| mask << 1 | u8::from(contact.in_contact);
            self.contacts.add(board.tick, recorded == outcome.contacts.iter().rev().fold(0, mask));
        }
    }

    fn add_estimate(&mut self, board: &BoardOutput, outcome: &Outcome<Q>) {
        let Some(recorded) = &board.estimate else { return };
        self.estimates += 1;
        if !board.complete {
            self.not_compared += 1;
            return;
        }
        let [.., fusion] = &outcome.shapes;
        const { assert!(matches!(Method::ALL, [.., Method::Fusion])) };
        let computed = Estimate::of(recorded.tick, fusion);
        let pairs = recorded.segments.iter().zip(&computed.segments);
        match pairs.enumerate().find(|(_, (recorded, computed))| recorded != computed) {
            None => self.equal += 1,
            Some((i, (recorded, computed))) => {
                self.first_difference.get_or_insert(Difference {
                    tick: board.tick,
                    segment: i + 1,
                    recorded: recorded.map(Values::from),
                    computed: computed.map(Values::from),
                });
            }
        }
    }

    /// Removes what cannot be compared: estimates of version 0.1's observer, and all uncertainties of version 0.1.
    #[must_use]
    pub fn of(self, recorded_by: RecordedBy) -> Self {
        match recorded_by {
            RecordedBy::ThisVersion => self,
            RecordedBy::Anchor01 => Self { uncertainties: Agreement::default(), recorded_by, ..self },
            RecordedBy::Observer01 => Self {
                estimates: self.estimates,
                not_compared: self.estimates,
                table_matches: self.table_matches,
                recorded_by,
                ..Self::default()
            },
        }
    }

    /// True where all compared values are the same.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        let Self { first_difference, uncertainties, contacts, .. } = self;
        first_difference.is_none() && uncertainties.first_difference.or(contacts.first_difference).is_none()
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.estimates == 0 {
            return write!(f, "the board's own estimates are not in the recording");
        }
        if self.recorded_by == RecordedBy::Observer01 {
            return write!(
                f,
                "the {} recorded estimates were made by the drift observer of version 0.1, which this version replaced: they \
                 are not compared",
                self.estimates
            );
        }
        let compared = self.estimates - self.not_compared;
        if compared == 0 {
            return write!(
                f,
                "none of the {} recorded estimates can be compared, as samples since the board's last tare before them are not \
                 in the recording",
                self.estimates
            );
        }
        if let Some(difference) = &self.first_difference {
            let Difference { tick, segment, recorded, computed } = difference;
            write!(
                f,
                "{} of {compared} recorded estimates are not those of this replay; the first: tick {tick}, segment \
                 {segment}, recorded {}, computed {}",
                compared - self.equal,
                Shown(*recorded),
                Shown(*computed)
            )?;
        } else {
            let [uncertainties, contacts] = [self.uncertainties, self.contacts].map(|agreement| agreement.equal);
            if self.recorded_by == RecordedBy::Anchor01 {
                write!(
                    f,
                    "the {compared} recorded estimates and {contacts} changes of contact are, bit for bit, those of this \
                     replay; uncertainties of version 0.1 are not compared"
                )?;
            } else {
                write!(
                    f,
                    "the {compared} recorded estimates, {uncertainties} uncertainties and {contacts} changes of contact are, \
                     bit for bit, those of this replay"
                )?;
            }
        }
        if self.not_compared > 0 {
            let more = self.not_compared;
            write!(f, "; {more} more are not compared, as samples before them are not in the recording")?;
        }
        for (name, agreement) in [("uncertainties", self.uncertainties), ("changes of contact", self.contacts)] {
            if let Agreement { compared, equal, first_difference: Some(tick) } = agreement {
                write!(f, "; {} of {compared} {name} are not, the first: tick {tick}", compared - equal)?;
            }
        }
        if self.table_matches == Some(false) {
            write!(f, "; the board had another table")?;
        }
        Ok(())
    }
}

struct Shown(Option<Values>);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            None => write!(f, "nothing"),
            Some(Values { theta_rad, x_m, y_m }) => write!(f, "θ {theta_rad} rad, x {x_m} m, y {y_m} m"),
        }
    }
}
