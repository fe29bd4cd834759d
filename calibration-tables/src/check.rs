//! What the estimator can use, checked key by key.

use std::ops::RangeInclusive;

use estimator_core::{H_LIMIT, PLAYS, QuadraticMap, SENSORS_PER_SEGMENT, VOLTS_PER_COUNT};

use crate::contact::ContactKeys;
use crate::drift::DriftKeys;
use crate::file::{ArmFile, BendKeys, FileError, MAX_SEGMENTS, MAX_WINDOW, NoiseKeys, SegmentKeys};
use crate::tuning::TuningKeys;
use crate::uncertainty::UncertaintyKeys;

/// Lengths that fixed point holds with room for the chain (m: ±32).
const MAX_ARM_MM: f64 = 16_000.0;
/// No segment bends further, rad.
const MAX_ANGLE: f64 = std::f64::consts::TAU;
/// Coefficients of a map about the middle of its range, rad, that fixed point holds.
const MAX_COEFFICIENT: f64 = 31.0;
/// r_imu over r_bend: beyond it fixed point has no digits left for the smaller one.
const VARIANCE_RATIO: RangeInclusive<f64> = 1e-5..=1e5;
/// H of a filter: a measurement that is a multiple of the state, but not another one.
pub const H_RANGE: RangeInclusive<f64> = 0.5..=H_LIMIT;
/// Voltages that the ADC can read, with some room for rounding.
pub(crate) const ADC_VOLTS: RangeInclusive<f64> = -0.001..=3.301;

impl ArmFile {
    pub(crate) fn check(&self) -> Result<(), FileError> {
        let n = self.segments.len();
        ensure((1..=MAX_SEGMENTS).contains(&n), "segment", &n, &format!("1 to {MAX_SEGMENTS} segments"))?;
        within("rate_hz", self.rate_hz, 0.01..=10_000.0)?;
        within("tare.seconds", self.tare.seconds, 0.0..=3600.0)?;
        let headings = self.tare.heading_deg.len();
        ensure([0, n].contains(&headings), "tare.heading_deg", &headings, &format!("{n} headings, one per segment"))?;
        for (i, heading) in self.tare.heading_deg.iter().enumerate() {
            within(&format!("tare.heading_deg[{}]", i + 1), *heading, -3600.0..=3600.0)?;
        }
        let window = self.anchor.window;
        ensure((1..=MAX_WINDOW).contains(&window), "anchor.window", &window, &format!("1 to {MAX_WINDOW} values"))?;
        within("anchor.threshold_deg", self.anchor.threshold_deg, 0.0..=360.0)?;
        within("anchor.rate_hz", self.anchor.rate_hz, 0.01..=10_000.0)?;
        self.drift.as_ref().map_or(Ok(()), DriftKeys::check)?;
        self.contact.as_ref().map_or(Ok(()), ContactKeys::check)?;
        self.uncertainty.as_ref().map_or(Ok(()), UncertaintyKeys::check)?;
        self.tuning.as_ref().map_or(Ok(()), TuningKeys::check)?;
        for (i, segment) in self.segments.iter().enumerate() {
            segment.check(&format!("segment[{}]", i + 1))?;
            segment
                .coupled_to
                .map_or(Ok(()), |coupled| coupled.check(&format!("segment[{}].coupled_to", i + 1), i + 1))?;
            segment.contact.map_or(Ok(()), |limit| limit.check(&format!("segment[{}].contact", i + 1)))?;
        }
        let length = self.length_mm();
        ensure(length <= MAX_ARM_MM, "segment", &format!("{length} mm of arm"), &format!("at most {MAX_ARM_MM} mm"))
    }
}

impl SegmentKeys {
    fn check(&self, key: &str) -> Result<(), FileError> {
        within(&format!("{key}.length_mm"), self.length_mm, 0.1..=MAX_ARM_MM)?;
        within(&format!("{key}.offset_mm"), self.offset_mm, 0.0..=MAX_ARM_MM)?;
        let sensors = self.bend.as_deref().unwrap_or_default();
        let bend = format!("{key}.bend");
        ensure(sensors.len() <= SENSORS_PER_SEGMENT, &bend, &sensors.len(), "at most two sensors, a and b")?;
        for (j, sensor) in sensors.iter().enumerate() {
            sensor.check(&format!("{bend}[{}]", j + 1))?;
        }
        let (plays, key_of_plays) = (&self.hysteresis, format!("{key}.hysteresis"));
        ensure(plays.len() <= PLAYS, &key_of_plays, &plays.len(), &format!("at most {PLAYS} plays"))?;
        for (j, play) in plays.iter().enumerate() {
            within(&format!("{key_of_plays}[{}].radius_deg", j + 1), play.radius_deg, 0.0..=180.0)?;
            within(&format!("{key_of_plays}[{}].weight", j + 1), play.weight, -1.0..=1.0)?;
        }
        within(&format!("{key}.imu_scale"), self.imu_scale.unwrap_or(1.0), 0.9..=1.1)?;
        self.bend_error.as_ref().map_or(Ok(()), |error| error.check(&format!("{key}.bend_error")))?;
        self.orient.as_ref().map_or(Ok(()), |noise| noise.check(&format!("{key}.orient")))?;
        self.coord.as_ref().map_or(Ok(()), |noise| noise.check(&format!("{key}.coord")))
    }
}

impl BendKeys {
    fn check(&self, key: &str) -> Result<(), FileError> {
        for (name, value) in [("c0", self.c0), ("c1", self.c1), ("c2", self.c2)] {
            within(&format!("{key}.{name}"), value, -1e4..=1e4)?;
        }
        within(&format!("{key}.rmse_deg"), self.rmse_deg.unwrap_or(0.0), 0.0..=360.0)?;
        if let Some(volts) = self.volts {
            self.check_within(key, volts)?;
        }
        self.curve.as_ref().map_or(Ok(()), |curve| curve.check(&format!("{key}.curve")))?;
        self.memory.as_ref().map_or(Ok(()), |memory| memory.check(&format!("{key}.memory")))?;
        let map = QuadraticMap::<f64>::from_volts(self.c2, self.c1, self.c0, self.range_volts());
        let largest = map.coefficients.into_iter().fold(0.0, |largest: f64, b| largest.max(b.abs()));
        ensure(
            largest < MAX_COEFFICIENT,
            key,
            &"a map that is too steep",
            "the angles of a segment, within half a turn",
        )
    }

    fn check_within(&self, key: &str, [lo, hi]: [f64; 2]) -> Result<(), FileError> {
        let volts = format!("{key}.volts");
        let in_order = ADC_VOLTS.contains(&lo) && ADC_VOLTS.contains(&hi) && lo < hi;
        ensure(in_order, &volts, &format!("[{lo}, {hi}]"), "[lowest, highest] within 0 to 3.3 V")?;
        let steepest = [lo, hi].map(|v| self.angle(v).abs()).into_iter().fold(0.0, f64::max);
        within(&format!("{key}: largest angle within volts, rad"), steepest, 0.0..=MAX_ANGLE)?;
        ensure(
            self.is_monotonic_within([lo, hi]),
            key,
            &match self.turning_point() {
                volts if volts.is_finite() => format!("a map that turns back at {volts:.3} V"),
                _ => "a map that stays level".to_owned(),
            },
            &format!("one that only rises or only falls from {lo} V to {hi} V"),
        )
    }

    /// The voltages that the map was fitted on; where it does not say, those at which it stays within half a turn, V.
    #[must_use]
    pub fn range_volts(&self) -> [f64; 2] {
        self.volts.unwrap_or_else(|| {
            let volts = (0..=4095_u16).map(|counts| f64::from(counts) * VOLTS_PER_COUNT);
            let bent = volts.filter(|v| self.angle(*v).abs() <= std::f64::consts::PI);
            let [lo, hi] = bent.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)]);
            if lo < hi { [lo, hi] } else { [0.0, 3.3] }
        })
    }

    /// Bend angle at a voltage, rad.
    #[must_use]
    pub fn angle(&self, volts: f64) -> f64 {
        (self.c2 * volts + self.c1) * volts + self.c0
    }

    /// Whether the map only rises or only falls between the two voltages.
    #[must_use]
    pub fn is_monotonic_within(&self, volts: [f64; 2]) -> bool {
        let [at_lo, at_hi] = volts.map(|v| 2.0 * self.c2 * v + self.c1);
        at_lo * at_hi > 0.0
    }

    /// The voltage where the map turns back, V; not finite for a straight line.
    #[must_use]
    pub fn turning_point(&self) -> f64 {
        -self.c1 / (2.0 * self.c2)
    }
}

impl NoiseKeys {
    fn check(&self, key: &str) -> Result<(), FileError> {
        within(&format!("{key}.q"), self.q, 0.0..=1e6)?;
        within(&format!("{key}.r_bend"), self.r_bend, 1e-12..=1e6)?;
        within(&format!("{key}.r_imu"), self.r_imu, 1e-12..=1e6)?;
        within(&format!("{key}.r_imu / r_bend"), self.r_imu / self.r_bend, VARIANCE_RATIO)?;
        within(&format!("{key}.h_imu"), self.h_imu, H_RANGE)?;
        within(&format!("{key}.h_bend"), self.h_bend, H_RANGE)
    }
}

pub(crate) fn ensure(holds: bool, key: &str, found: &impl ToString, expected: &str) -> Result<(), FileError> {
    if holds {
        return Ok(());
    }
    Err(FileError::Value { line: None, key: key.to_owned(), found: found.to_string(), expected: expected.to_owned() })
}

/// NaN is within no range.
pub(crate) fn within(key: &str, value: f64, range: RangeInclusive<f64>) -> Result<(), FileError> {
    ensure(range.contains(&value), key, &format!("{value:?}"), &format!("{:?} to {:?}", range.start(), range.end()))
}
