//! Texts of findings.

use std::fmt;

use proprio_session::time_unit_of;

use super::finding::{Finding, Kind, Source};

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
            Kind::Held => write!(f, "the last readings are repeated while the arm moves, in {figure:.1} % of the rows"),
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
            Kind::NewZero if matches!(sensor, Source::TwoImus { .. }) => write!(
                f,
                "the headings continue {figure:.0}° off in opposite directions: the plugs were exchanged, or each has another zero"
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
            Kind::Drift => match sensor {
                Source::Imu { .. } => write!(f, "the heading drifts by {figure:.0}° against the bend sensors"),
                Source::ImuOrBend { .. } => {
                    write!(
                        f,
                        "they part by {figure:.0}°; without a segment behind them it cannot be told which of them drifts"
                    )
                }
                Source::Twins { segment } => write!(
                    f,
                    "both drift by {figure:.0}° against the IMUs, unless all IMUs from imu{segment} on drift alike"
                ),
                _ => write!(f, "the bend angle drifts by {figure:.0}° against the IMUs"),
            },
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
