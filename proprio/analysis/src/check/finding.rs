//! Findings of a session check.

use std::fmt;

use proprio_session::{SENSOR_NAMES, time_unit_of};
use serde::Serialize;

use super::frame::Frame;

/// The source that a finding is about; segments from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// The time stamps.
    Time,
    /// A bend sensor: its segment, and its place (0 is `a`, 1 is `b`).
    Bend {
        /// Segment.
        segment: usize,
        /// Place.
        place: usize,
    },
    /// The bend sensors of two segments.
    TwoBends {
        /// The first segment.
        segment: usize,
        /// The second segment.
        other: usize,
    },
    /// A bend sensor of each of two segments: their places as in [`Self::Bend`].
    TwoPlugs {
        /// The segments.
        segments: [usize; 2],
        /// The places.
        places: [usize; 2],
    },
    /// All bend sensors.
    AllBend,
    /// The IMU at a segment's end.
    Imu {
        /// Segment.
        segment: usize,
    },
    /// Two IMUs.
    TwoImus {
        /// Segment of the first.
        segment: usize,
        /// Segment of the second.
        other: usize,
    },
    /// All IMUs.
    AllImus,
    /// The arm as a whole.
    Arm,
    /// The truth of a segment's end.
    Truth {
        /// Segment.
        segment: usize,
    },
    /// The truth of two segments' ends.
    TwoTruths {
        /// The first segment.
        segment: usize,
        /// The second segment.
        other: usize,
    },
    /// The truth of all segments.
    AllTruth,
}

impl Source {
    /// True for findings about the truth.
    #[must_use]
    pub const fn is_truth(&self) -> bool {
        matches!(self, Self::Truth { .. } | Self::TwoTruths { .. } | Self::AllTruth)
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Time => f.write_str("time_s"),
            Self::Bend { segment, place } => write!(f, "bend{segment}{}", SENSOR_NAMES[*place]),
            Self::TwoPlugs { segments: [segment, other], places: [place, of] } => {
                write!(f, "bend{segment}{} and bend{other}{}", SENSOR_NAMES[*place], SENSOR_NAMES[*of])
            }
            Self::TwoBends { segment, other } => write!(f, "bend{segment} and bend{other}"),
            Self::AllBend => f.write_str("all bend sensors"),
            Self::Imu { segment } => write!(f, "imu{segment}"),
            Self::TwoImus { segment, other } => write!(f, "imu{segment} and imu{other}"),
            Self::AllImus => f.write_str("all IMUs"),
            Self::Arm => f.write_str("arm"),
            Self::Truth { segment } => write!(f, "truth{segment}"),
            Self::TwoTruths { segment, other } => write!(f, "truth{segment} and truth{other}"),
            Self::AllTruth => f.write_str("truth"),
        }
    }
}

impl Serialize for Source {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Rows of a finding. Rows count from 1, without the header.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Rows {
    /// Number of the rows.
    pub count: u64,
    /// The first of them.
    pub first: u64,
    /// The last of them.
    pub last: u64,
    /// Time of the first, s.
    pub from_s: f64,
    /// Time of the last, s.
    pub to_s: f64,
}

impl Rows {
    /// Adds a row.
    pub(super) fn add(&mut self, frame: &Frame) {
        self.append(&Self { count: 1, first: frame.row, last: frame.row, from_s: frame.time_s, to_s: frame.time_s });
    }

    /// Appends later rows.
    pub(super) fn append(&mut self, later: &Self) {
        if self.count == 0 {
            *self = *later;
        } else {
            *self = Self { count: self.count + later.count, last: later.last, to_s: later.to_s, ..*self };
        }
    }
}

impl fmt::Display for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, first, last, from_s, to_s } = self;
        if first == last {
            write!(f, "row {first} ({from_s:.3} s)")
        } else if *count > last - first {
            write!(f, "rows {first} to {last} ({from_s:.3} to {to_s:.3} s)")
        } else {
            write!(f, "{count} of rows {first} to {last} ({from_s:.3} to {to_s:.3} s)")
        }
    }
}

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
    /// True for a finding about the bend sensors of a segment, from 1.
    fn is_about_bend(&self, number: usize) -> bool {
        match self.sensor {
            Source::Bend { segment, .. } => segment == number,
            Source::TwoBends { segment, other } => segment == number || other == number,
            Source::TwoPlugs { segments, .. } => segments.contains(&number),
            Source::AllBend => true,
            _ => false,
        }
    }

    /// True for a finding about the IMU of a segment, from 1.
    fn is_about_imu(&self, number: usize) -> bool {
        match self.sensor {
            Source::Imu { segment } => segment == number,
            Source::TwoImus { segment, other } => segment == number || other == number,
            Source::AllImus => true,
            _ => false,
        }
    }
}

/// Factors of the counts by another ADC, and the reason.
const COUNTS: [(f64, &str); 6] = [
    (1.0 / 16.0, "8 bits in place of 12"),
    (1.0 / 4.0, "10 bits in place of 12"),
    (1.0 / 2.0, "11 bits in place of 12"),
    (3.3 / 5.0, "a reference of 5 V in place of 3.3 V"),
    (5.0 / 3.3, "a reference of 3.3 V in place of 5 V"),
    (4.0, "14 bits in place of 12"),
];
/// Tolerance of such a factor, which is found by sensors that drift.
const TOLERANCE: f64 = 0.08;

/// The reason of a factor of the counts, if it is known.
fn counts_reason(factor: f64) -> Option<&'static str> {
    COUNTS.iter().find(|(known, _)| (factor / known - 1.0).abs() < TOLERANCE).map(|(_, reason)| *reason)
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

/// True where a finding is about the IMU of a segment, from 1.
pub(super) fn is_imu_blamed(findings: &[Finding], number: usize) -> bool {
    findings.iter().any(|finding| finding.is_about_imu(number))
}

/// Kind of a fault, with the meaning of the finding's figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Bend readings outside the voltages of the map; the figure is their share, %.
    OutsideMap,
    /// Bend readings that are all below 1024 counts, as those of a 10-bit ADC are; largest reading, counts.
    TenBits,
    /// The counts of all bend sensors are those of the table times a factor, the figure.
    Counts,
    /// Bend readings at either end of the ADC: open or shorted; share, %.
    Rail,
    /// The reading never changes while other sensors move; range of the motion, deg.
    Constant,
    /// The last value is repeated while other sensors move; range of the motion, deg.
    Frozen,
    /// Single readings of exactly 0, away from those before and after; number of them.
    Zeros,
    /// Two IMUs give the same readings; share of the changed readings, %.
    SameReadings,
    /// The IMU's heading is counted in the other direction; slope of its steps over those of the bend sensors. A
    /// bend sensor: its angle is; correlation of its steps.
    Inverted,
    /// The IMU's steps are too small or too large; slope of its steps over those of the bend sensors.
    Scale,
    /// No heading is above a whole turn in radians, and the steps do not fit; largest heading.
    Radians,
    /// The headings by quaternions as x, y, z, w follow the bend sensors, those as w, x, y, z do not; correlation, %.
    QuaternionOrder,
    /// The IMU's x axis is not level, so that it has no good heading; elevation of the axis, deg.
    OnItsSide,
    /// The table's `tare.seconds` is 0, by which headings are absolute, and the IMUs' are not; largest angle from the bend sensors, deg.
    NotAbsolute,
    /// The IMU's steps are those of another segment; share of their variance that the exchange explains, %.
    Exchanged,
    /// The steps of the sensor are not those of the other sensors; correlation, %.
    Unrelated,
    /// The IMU's heading continues from another zero; size of the jump, deg.
    NewZero,
    /// The arm is not in its reference pose during the tare; largest angle, deg.
    TareBent,
    /// The arm moves during the tare; range of the heading, deg.
    TareMoves,
    /// The time stamps are not in seconds; factor of the table's rate over the session's.
    TimeUnit,
    /// Consecutive rows have the same time; number of them.
    EqualTimes,
    /// Rows are missing; longest gap, s.
    Gaps,
    /// The bend sensor departs from its twin and from the IMU; angle, deg.
    LeavesTwin,
    /// Places of exactly 0, as of a lost marker; share, %.
    TruthZeros,
    /// The last pose is repeated while the arm moves; share, %.
    TruthRepeated,
    /// All poses are held between updates of a lower rate; rows from one update to the next.
    TruthStaircase,
    /// Single rows are off their neighbours, which agree; share, %.
    TruthJump,
    /// The place is further from a neighbour's than the arm allows; share, %.
    TruthMisplaced,
    /// Two ends have each other's pose for a while; share, %.
    TruthExchanged,
    /// The places are not in the unit of their columns; factor.
    TruthUnit,
    /// The headings are radians in columns of degrees; factor.
    TruthRadians,
    /// The places turn otherwise than the headings, as with a mirrored axis; directions by the places over those by the headings.
    TruthAxes,
    /// The markers fit other lengths than the table's; factor.
    TruthLengths,
    /// The truth is later than the sensors (positive) or earlier; ms.
    TruthLag,
}

impl Kind {
    /// True where single poses of the truth are wrong, which are left out.
    #[must_use]
    pub const fn is_wrong_pose(self) -> bool {
        use Kind::{TruthExchanged, TruthJump, TruthMisplaced, TruthRepeated, TruthZeros};
        matches!(self, TruthExchanged | TruthJump | TruthMisplaced | TruthRepeated | TruthZeros)
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sensor, rows, kind, figure } = self;
        write!(f, "{sensor}, {rows}: ")?;
        match kind {
            Kind::OutsideMap => write!(f, "{figure:.1} % of the readings are outside the voltages of the table's map"),
            Kind::TenBits => write!(f, "no reading is above {figure:.0} counts of 4095, as from a 10-bit ADC"),
            Kind::Counts => {
                write!(f, "the counts are {figure:.3} times those of the table")?;
                counts_reason(*figure).map_or(Ok(()), |reason| write!(f, ", as with {reason}"))
            }
            Kind::Rail => write!(f, "{figure:.1} % of the readings are at an end of the ADC: open or shorted"),
            Kind::Constant => write!(f, "the reading never changes while the other sensors move by {figure:.0}°"),
            Kind::Frozen => write!(f, "the last value is repeated while the other sensors move by {figure:.0}°"),
            Kind::Zeros => write!(f, "{figure:.0} readings are exactly 0, away from those before and after"),
            Kind::SameReadings => write!(f, "both give the same value in {figure:.0} % of the changed readings"),
            Kind::Inverted if matches!(sensor, Source::Bend { .. }) => {
                write!(f, "the bend angle turns opposite to the IMUs (correlation {figure:.2})")
            }
            Kind::Inverted => write!(f, "the heading turns opposite to the bend sensors (slope {figure:.2})"),
            Kind::Scale => write!(f, "the heading's steps are {figure:.4} times those of the bend sensors"),
            Kind::Radians => write!(f, "no heading is above {figure:.3}°, as from radians in a column of degrees"),
            Kind::Exchanged => write!(f, "each follows the segment of the other ({figure:.0} % explained)"),
            Kind::Unrelated => write!(f, "the steps are not those of the other sensors (correlation {figure:.0} %)"),
            Kind::QuaternionOrder => {
                write!(
                    f,
                    "read as x, y, z, w the quaternions follow the bend sensors ({figure:.0} %), as w, x, y, z not"
                )
            }
            Kind::OnItsSide => {
                write!(f, "the IMU is on its side: its x axis is {figure:.0}° from level, expected about 0°")
            }
            Kind::NotAbsolute => write!(
                f,
                "the table has tare.seconds = 0, by which headings are absolute; these are up to {figure:.0}° from the bend sensors"
            ),
            Kind::NewZero => {
                write!(f, "the heading continues {figure:.0}° off, which the bend sensors do not show: another zero")
            }
            Kind::TareBent => write!(f, "{figure:.1}° from the reference pose during the tare"),
            Kind::TareMoves => write!(f, "moves by {figure:.1}° during the tare"),
            Kind::TimeUnit => {
                write!(f, "by the table's rate these times are {figure:.4} times too large")?;
                time_unit_of(*figure).map_or(Ok(()), |(_, unit)| write!(f, ", as {unit} are"))
            }
            Kind::EqualTimes => write!(f, "{figure:.0} rows have the time of the row before"),
            Kind::Gaps => write!(f, "rows are missing, {figure:.2} s at most"),
            Kind::LeavesTwin => write!(f, "departs by {figure:.0}° from its twin and the IMU"),
            Kind::TruthZeros => write!(f, "the place is exactly 0, 0 in {figure:.2} % of the rows"),
            Kind::TruthRepeated => {
                write!(f, "the last pose is repeated while the arm moves, in {figure:.2} % of the rows")
            }
            Kind::TruthStaircase => {
                write!(f, "the truth changes every {figure:.0} rows and is held between while the arm moves")
            }
            Kind::TruthJump => write!(f, "single poses are off those before and after, {figure:.2} % of the rows"),
            Kind::TruthMisplaced => {
                write!(f, "the pose is further from its neighbour's than the arm allows, in {figure:.2} % of the rows")
            }
            Kind::TruthExchanged => write!(f, "each has the pose of the other in {figure:.2} % of the rows"),
            Kind::TruthUnit => write!(f, "the places are in {}", unit(*figure)),
            Kind::TruthRadians => {
                write!(f, "the headings turn {figure:.1} times too little, as radians in columns of degrees")
            }
            Kind::TruthAxes => write!(f, "the places turn {figure:.2} times as far as the headings"),
            Kind::TruthLengths => write!(f, "the markers fit {figure:.4} times the lengths of the arm"),
            Kind::TruthLag => {
                let order = if *figure > 0.0 { "later" } else { "earlier" };
                write!(f, "the truth is {:.0} ms {order} than the IMUs", figure.abs())
            }
        }
    }
}

/// Unit of lengths that are `factor` times those of the column's unit.
fn unit(factor: f64) -> &'static str {
    match factor {
        0.001 => "metres, in columns of mm",
        0.1 => "centimetres, in columns of mm",
        _ => "mm, in columns of metres",
    }
}
