//! Hysteresis compensation of a segment by plays on top of its quadratics, for tables that use the moving-average anchor.
//!
//! The weights of plays of fixed widths, and a scale of the maps, are fitted by least squares to the first four fifths of the
//! sweep. They are kept where they lower the error on the last fifth significantly.

use calibration_tables::{BendToml, PlayToml, SegmentToml};
use nalgebra::{Matrix4, Vector4};

use super::fit::volts;
use super::options::HysteresisMode;
use super::sweep::{SensorColumn, Sweep, range};

/// Half widths of the plays, shares of half the segment's range.
const HALF_WIDTHS: [f64; 3] = [0.1, 0.25, 0.5];
/// Share of the sweep that the weights are fitted on.
const FITTED: f64 = 0.8;
/// Largest share of the held-back error that a correction may leave. A part of the gain is specific to the sweep's motion: on the
/// simulated arm, corrections that left nine tenths of a sweep's error made an arm that leans against an obstacle worse.
const WORTH_IT: f64 = 0.8;
/// Ridge of the normal equations, as a share of the mean square of the bend angle: plays of similar widths are collinear, and
/// large opposed weights are no hysteresis.
const RIDGE: f64 = 0.01;

/// Weights of the plays' differences, and of the angle itself.
type Weights = Vector4<f64>;

/// Rows of one segment that have truth and a bend angle: the errors of the angle and the terms that explain them.
struct Rows {
    half_widths: [f64; 3],
    error: Vec<f64>,
    terms: Vec<Vector4<f64>>,
}

/// Sets `hysteresis` of the segments that need it, and scales their maps; clears it from the others.
pub(super) fn set(sweep: &Sweep, segments: &mut [SegmentToml], which: HysteresisMode) {
    for (i, segment) in segments.iter_mut().enumerate() {
        segment.hysteresis.clear();
        let rows = Rows::new(sweep, i, segment.bend.as_deref().unwrap_or_default());
        let is_wanted = match which {
            HysteresisMode::Auto => rows.gain(),
            HysteresisMode::Always => true,
            HysteresisMode::Never => false,
        };
        if let Some(weights) = is_wanted.then(|| rows.fit(rows.error.len())).flatten() {
            apply(&rows, weights, segment);
        }
    }
}

/// θ + Σ w (θ − play(θ)) + s θ as plays on an angle that is 1 + s times as large.
fn apply(rows: &Rows, weights: Weights, segment: &mut SegmentToml) {
    let scale = 1.0 + weights.w;
    for map in segment.bend.iter_mut().flatten() {
        (map.c0, map.c1, map.c2) = (map.c0 * scale, map.c1 * scale, map.c2 * scale);
    }
    let plays = rows.half_widths.iter().zip(weights.iter());
    let play = |(half_width, weight): (&f64, &f64)| PlayToml {
        radius_deg: (half_width * scale).to_degrees(),
        weight: weight / scale,
    };
    segment.hysteresis = plays.map(play).collect();
}

impl Rows {
    fn new(sweep: &Sweep, segment: usize, maps: &[BendToml]) -> Self {
        let columns: Vec<&SensorColumn> = sweep.sensors.iter().filter(|column| column.segment == segment).collect();
        let [lo, hi] = range(sweep.theta[segment].iter().flatten().copied());
        let half_widths = HALF_WIDTHS.map(|share| share * (hi - lo) / 2.0);
        let mut rows = Self { half_widths, error: Vec::new(), terms: Vec::new() };
        let mut places = None;
        for (row, truth) in sweep.theta[segment].iter().enumerate() {
            if row > 0 && sweep.runs[row] != sweep.runs[row - 1] {
                places = None;
            }
            let angles = columns.iter().zip(maps);
            let angles = angles.filter_map(|(column, map)| Some(map.angle(volts(column.counts[row]?))));
            let (sum, count) = angles.fold((0.0, 0.0), |(sum, count), angle| (sum + angle, count + 1.0));
            if count == 0.0 {
                continue;
            }
            let theta: f64 = sum / count;
            let places = places.get_or_insert([theta; 3]);
            for (place, half_width) in places.iter_mut().zip(half_widths) {
                *place = place.clamp(theta - half_width, theta + half_width);
            }
            if let Some(truth) = truth {
                let [a, b, c] = *places;
                rows.error.push(truth - theta);
                rows.terms.push(Vector4::new(theta - a, theta - b, theta - c, theta));
            }
        }
        rows
    }

    /// True where weights from the first rows lower the error on the others enough.
    fn gain(&self) -> bool {
        let fitted = (self.error.len() as f64 * FITTED) as usize;
        let held_back = fitted..self.error.len();
        let square = |weights: Weights| -> f64 {
            held_back.clone().map(|row| (self.error[row] - self.terms[row].dot(&weights)).powi(2)).sum()
        };
        self.fit(fitted).is_some_and(|weights| square(weights) < WORTH_IT * WORTH_IT * square(Vector4::zeros()))
    }

    /// Least squares over the first `count` rows; `None` where they do not determine it.
    fn fit(&self, count: usize) -> Option<Weights> {
        let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for (error, terms) in self.error.iter().zip(&self.terms).take(count) {
            normal += terms * terms.transpose();
            right += terms * *error;
        }
        normal += Matrix4::identity() * (RIDGE * normal.m44);
        Some(normal.cholesky()?.solve(&right))
    }
}
