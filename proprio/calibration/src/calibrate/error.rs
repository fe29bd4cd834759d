//! Errors and warnings of a calibration.

/// An error that prevents a good table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// The session has no bend sensor at all.
    #[error("the session has no bend sensor")]
    NoSensors,
    /// A segment's sensor b is there without a.
    #[error("column bend{segment}a_adc is missing, but bend{segment}b_adc is there")]
    SensorBAlone {
        /// The segment, from 1.
        segment: usize,
    },
    /// Sessions of different sample rates.
    #[error("the sample rate is {found_hz:.1} Hz, that of the first session {expected_hz:.1} Hz")]
    OtherRate {
        /// Rate of this session, Hz.
        found_hz: f64,
        /// Rate of the first, Hz.
        expected_hz: f64,
    },
    /// The camera hardly saw a segment.
    #[error("the camera saw segment {segment} in {found} rows, expected at least {least}")]
    Unseen {
        /// The segment, from 1.
        segment: usize,
        /// Rows found.
        found: usize,
        /// Rows needed.
        least: usize,
    },
    /// The truth is inconsistent.
    #[error("the truth's points are {percent:.0} % of the arm's length away from where its headings put them")]
    TruthMisfit {
        /// Root mean square distance of the tip from the chain of the true bend angles, % of the arm's length.
        percent: f64,
    },
    /// Too few rows have truth, or a reading of one sensor.
    #[error("{name} has {found} rows with both a reading and truth, expected at least {least}")]
    TooFewRows {
        /// The sensor.
        name: String,
        /// Rows found.
        found: usize,
        /// Rows needed.
        least: usize,
    },
    /// A segment hardly bends.
    #[error("segment {segment} bends by only {range_deg:.1}° in all, expected at least {least_deg}°")]
    SmallSweep {
        /// The segment, from 1.
        segment: usize,
        /// Range of the bend angle, degrees.
        range_deg: f64,
        /// Range needed.
        least_deg: f64,
    },
    /// A bend sensor that does not move.
    #[error("{name} is dead: its readings stay within {range} counts while the segment bends")]
    Dead {
        /// The sensor.
        name: String,
        /// Range of the readings, counts.
        range: u16,
    },
    /// A bend sensor at the end of its range.
    #[error("{name} is saturated: it reads {counts} in {percent:.1} % of the rows, over {span_deg:.0}° of bending")]
    Saturated {
        /// The sensor.
        name: String,
        /// The reading where it stays.
        counts: u16,
        /// Share of the rows.
        percent: f64,
        /// Range of the bend angles there.
        span_deg: f64,
    },
    /// A bend sensor that follows another segment.
    #[error("{name} follows segment {follows}, not its own: it is swapped with a sensor there")]
    Swapped {
        /// The sensor.
        name: String,
        /// The segment that it follows, from 1.
        follows: usize,
    },
    /// A bend sensor that follows no segment.
    #[error("{name} does not follow its segment: the map leaves {percent:.0} % of the bending unexplained")]
    Unrelated {
        /// The sensor.
        name: String,
        /// Share of the variance that is left.
        percent: f64,
    },
    /// A map that turns back inside its own data.
    #[error("{name} is not monotonic: its map turns back at {volts:.3} V, inside its data, by {back_deg:.1}°")]
    NotMonotonic {
        /// The sensor.
        name: String,
        /// Voltage at which it turns back, V.
        volts: f64,
        /// Angle by which it turns back, degrees.
        back_deg: f64,
    },
    /// An IMU that turns the wrong way.
    #[error("imu{segment} is inverted: its heading falls when the arm turns clockwise")]
    InvertedImu {
        /// The segment, from 1.
        segment: usize,
    },
    /// An IMU whose headings are radians in a column of degrees.
    #[error("imu{segment} is in radians in a column of degrees: its steps are 57.3 times too small")]
    RadianImu {
        /// The segment, from 1.
        segment: usize,
    },
    /// An IMU that follows another segment's end.
    #[error("imu{segment} follows the end of segment {follows}, not its own: it is swapped with imu{follows}")]
    SwappedImu {
        /// The segment, from 1.
        segment: usize,
        /// The segment that it follows, from 1.
        follows: usize,
    },
    /// Two IMUs of one channel.
    #[error("imu{segment} and imu{other} give the same readings: both are of one mux channel")]
    SameImus {
        /// Segment of the first, from 1.
        segment: usize,
        /// Segment of the second.
        other: usize,
    },
    /// An IMU that does not follow the arm.
    #[error("imu{segment} does not follow the end of its segment")]
    UnrelatedImu {
        /// The segment, from 1.
        segment: usize,
    },
}

/// A warning about a table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Warning {
    /// A segment bends little.
    #[error("segment {segment} bends by only {range_deg:.0}° in all; the maps are not reliable beyond that")]
    NarrowSweep {
        /// The segment, from 1.
        segment: usize,
        /// Range of the bend angle, degrees.
        range_deg: f64,
    },
    /// A map that turns back at the edge of its data.
    #[error("{name} turns back at {volts:.3} V, at the edge of its data, by {back_deg:.1}°; its range ends there")]
    TurnsBack {
        /// The sensor.
        name: String,
        /// Voltage at which it turns back, V.
        volts: f64,
        /// Angle by which it turns back, degrees.
        back_deg: f64,
    },
    /// A bend sensor that runs the other way than its like.
    #[error(
        "{name} is inverted: it runs against the sensors in its place on the other segments; its map allows for it"
    )]
    Inverted {
        /// The sensor.
        name: String,
    },
    /// Readings that no noise explains.
    #[error("{count} readings of {name} are over six RMSE off its map; spikes spoil it, empty their cells")]
    Outliers {
        /// The sensor.
        name: String,
        /// Number of readings.
        count: usize,
    },
    /// Segments that the sweep cannot distinguish.
    #[error("segments {} bend alike here, so that sensors swapped between them would not be noticed", pairs(.0))]
    CoupledSegments(
        /// Pairs of segments, from 1.
        Vec<(usize, usize)>,
    ),
    /// A method that is better than the fusion of all sensors.
    #[error(
        "on the last fifth of the sweep {method} alone is better than fusion, {best_mm:.1} mm against {fusion_mm:.1} mm at \
         the tip; {}",
        better_alone(method)
    )]
    FusionIsWorse {
        /// The method.
        method: &'static str,
        /// RMSE of its tip.
        best_mm: f64,
        /// RMSE of the fusion's tip.
        fusion_mm: f64,
    },
    /// An IMU without readings.
    #[error("imu{segment} was not read; the sweep does not check it")]
    ImuNotRead {
        /// The segment, from 1.
        segment: usize,
    },
}

/// Reason why a method alone may be better than fusion.
fn better_alone(method: &str) -> &'static str {
    if method == "bend" {
        "look for an IMU that slips or is missing, and for a camera that is misaligned"
    } else {
        "the IMUs hardly drift in a session this long, or a bend sensor slips"
    }
}

fn pairs(pairs: &[(usize, usize)]) -> String {
    pairs.iter().map(|(i, j)| format!("{i} and {j}")).collect::<Vec<_>>().join(", ")
}
