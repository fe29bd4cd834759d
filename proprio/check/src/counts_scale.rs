//! Counts that are all those of the table times one factor near 1: an ADC's reference that is off by some percent.
//!
//! The counts of the reference pose over those of the map are r = f + (s/c) θ for a factor f, and a pose of the segment that is off
//! by θ: s/c is the map's slope over its counts. Twins that face each other have opposite slopes, by which the two can be told
//! apart; an arm of strips that all face one way looks bent by a factor, so that none is found there.

use calibration_tables::ArmFile;

use super::finding::{Finding, Kind, Source, is_bend_blamed};
use super::plugs::{AtRest, Plugs};

/// Least deviation of a factor from 1: strips at another temperature reach 2.4 %. In standard errors of the factor.
const LEAST: f64 = 0.03;
const ERRORS: f64 = 5.0;
/// Deviation of a segment's pose in the tare, deg.
const POSE: f64 = 3.0;
/// Largest mean square of the residuals over what the table expects: more is another fault.
const MISFIT: f64 = 9.0;
/// Least number of sensors.
const SENSORS: usize = 4;

/// Sums over the sensors of a segment, each weighted by its inverse variance.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    weight: f64,
    slope: f64,
    slope_square: f64,
    deviation: f64,
    slope_deviation: f64,
    square: f64,
}

impl Sums {
    fn add(&mut self, AtRest { ratio, slope }: AtRest, error_deg: f64) {
        let (weight, deviation) = ((slope * error_deg).powi(-2), ratio - 1.0);
        self.weight += weight;
        self.slope += weight * slope;
        self.slope_square += weight * slope * slope;
        self.deviation += weight * deviation;
        self.slope_deviation += weight * slope * deviation;
        self.square += weight * deviation * deviation;
    }

    /// Weight of the factor, its product with the deviation, and square of the deviation, each without what the pose explains.
    fn without_pose(&self) -> [f64; 3] {
        let pose = self.slope_square + POSE.powi(-2);
        [
            self.weight - self.slope * self.slope / pose,
            self.deviation - self.slope * self.slope_deviation / pose,
            self.square - self.slope_deviation * self.slope_deviation / pose,
        ]
    }
}

/// Finds the factor.
pub(super) fn finish(table: &ArmFile, plugs: &Plugs, findings: &mut Vec<Finding>) {
    // Twins that seem to part, and readings beyond the map, are effects of a factor.
    let is_effect = |finding: &Finding| matches!(finding.kind, Kind::LeavesTwin | Kind::OutsideMap | Kind::TareBent);
    let others: Vec<Finding> = findings.iter().copied().filter(|finding| !is_effect(finding)).collect();
    let (mut total, mut sensors) = ([0.0; 3], 0);
    for (i, segment) in table.segments.iter().enumerate().filter(|(i, _)| !is_bend_blamed(&others, i + 1)) {
        let mut sums = Sums::default();
        for (place, bend) in segment.bend.iter().flatten().enumerate() {
            let error = segment.bend_error.as_ref().and_then(|error| error.sensor_deg.get(place).copied());
            if let Some((at_rest, error)) = plugs.at_rest(i, place).zip(error.or(bend.rmse_deg)) {
                sums.add(at_rest, error);
                sensors += 1;
            }
        }
        total.iter_mut().zip(sums.without_pose()).for_each(|(total, part)| *total += part);
    }
    let [weight, product, square] = total;
    let deviation = product / weight;
    let misfit = (square - deviation * product) / (sensors as f64 - 1.0);
    let error = (misfit.max(1.0) / weight).sqrt();
    if sensors >= SENSORS && misfit < MISFIT && deviation.abs() > LEAST.max(ERRORS * error) {
        *findings = others;
        let figure = 1.0 + deviation;
        findings.push(Finding { sensor: Source::AllBend, rows: plugs.rows(), kind: Kind::Counts, figure });
    }
}
