//! Kinds of faults, with the meaning of their figures.

use serde::Serialize;

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
    /// The readings are repeated while the arm moves, and then catch up; share of the rows, %.
    Held,
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
    /// An IMU and bend sensors part by more than the table's drift; angle, deg.
    Drift,
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
