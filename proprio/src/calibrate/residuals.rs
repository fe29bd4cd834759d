//! The filters' default parameters, from what the maps and the anchor leave on the calibration session.
//!
//! R_bend is each segment's own: the mean square of its bend sensors' error. R_imu is R_bend times a ratio, the same for
//! the whole arm, that follows from two facts. The anchor passes the slow part of the bend sensors' error on to the
//! corrected IMUs, so that the two measurements err together; what both share no filter can remove, and of errors e_c
//! and e_b the weights that leave least are those of R_imu : R_bend = E[e_c·(e_c − e_b)] : E[e_b·(e_b − e_c)]. And along
//! the chain the errors of bend sensors add up, where those of IMUs cancel, as each heading is measured by itself; so e
//! is the error of the heading and of the point in the world that the segments up to here add up to.

use std::path::Path;

use calibration_tables::NoiseKeys;
use estimator_core::Link;

use crate::error::Error;
use crate::replay::{NamedTable, Outcome, replay};
use crate::session::Row;

/// Bounds of R_imu : R_bend: the session is only a sample, and neither measurement is beyond doubt.
const RATIO: [f64; 2] = [0.01, 10.0];

/// Second moments of two measurements' errors.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    cc: f64,
    cb: f64,
    bb: f64,
    count: f64,
}

impl Moments {
    fn add<const D: usize>(&mut self, e_c: [f64; D], e_b: [f64; D]) {
        let dot = |a: [f64; D], b: [f64; D]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        self.cc += dot(e_c, e_c);
        self.cb += dot(e_c, e_b);
        self.bb += dot(e_b, e_b);
        self.count += D as f64;
    }

    fn ratio(&self) -> f64 {
        let [lo, hi] = RATIO;
        if self.bb > self.cb { ((self.cc - self.cb) / (self.bb - self.cb)).clamp(lo, hi) } else { hi }
    }

    /// Parameters with these errors' R_bend; `None` where the two measurements were never there together.
    fn noise(&self, ratio: f64) -> Option<NoiseKeys> {
        let r_bend = self.bb / self.count;
        (r_bend > 0.0).then(|| NoiseKeys::from_variances(ratio * r_bend, r_bend))
    }
}

/// Moments of one filter's measurements.
#[derive(Debug, Clone, Default)]
struct Errors {
    /// Of each segment by itself.
    segments: Vec<Moments>,
    /// Of what the segments add up to.
    chain: Moments,
}

impl Errors {
    fn new(segments: usize) -> Self {
        Self { segments: vec![Moments::default(); segments], chain: Moments::default() }
    }
}

/// Sets `orient` and `coord` of every segment that has bend sensors.
pub(super) fn set_filters(session: &Path, table: &mut NamedTable) -> Result<(), Error> {
    let n = table.file.segments.len();
    let (mut orient, mut coord) = (Errors::new(n), Errors::new(n));
    replay::<f64>(session, table, |row, outcome| {
        add_row(row, outcome, &mut orient, &mut coord);
        Ok(())
    })?;
    let (orient_ratio, coord_ratio) = (orient.chain.ratio(), coord.chain.ratio());
    for (i, segment) in table.file.segments.iter_mut().enumerate() {
        segment.orient = orient.segments[i].noise(orient_ratio);
        segment.coord = coord.segments[i].noise(coord_ratio);
    }
    Ok(())
}

/// Adds one row, segment by segment up to the first that is not known.
fn add_row(row: &Row, outcome: &Outcome<f64>, orient: &mut Errors, coord: &mut Errors) {
    let (mut heading_c, mut heading_b) = ([0.0], [0.0]);
    let (mut point_c, mut point_b) = ([0.0; 2], [0.0; 2]);
    for (i, segment) in outcome.estimate.segments.iter().enumerate() {
        let Some((imu_c, bend)) = segment.imu_c.zip(segment.bend) else { return };
        let Some((theta, start_heading, end)) = truth_in_segment(row, i) else { return };
        let (e_c, e_b) = ([imu_c.theta.rad() - theta], [bend.theta.rad() - theta]);
        orient.segments[i].add(e_c, e_b);
        (heading_c, heading_b) = (add(heading_c, e_c), add(heading_b, e_b));
        orient.chain.add(heading_c, heading_b);

        let error = |link: &Link<f64>| [link.end.x - end[0], link.end.y - end[1]];
        let (e_c, e_b) = (error(&imu_c), error(&bend));
        coord.segments[i].add(e_c, e_b);
        point_c = add(point_c, rotate(e_c, start_heading));
        point_b = add(point_b, rotate(e_b, start_heading));
        coord.chain.add(point_c, point_b);
    }
}

fn add<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// R(α): from {S_i} to {W}.
fn rotate([x, y]: [f64; 2], heading: f64) -> [f64; 2] {
    let (sin, cos) = heading.sin_cos();
    [x * cos + y * sin, y * cos - x * sin]
}

/// True θ_i, heading Θ_i−1 of {S_i}, and end of the segment in {S_i}, rad and m.
fn truth_in_segment(row: &Row, i: usize) -> Option<(f64, f64, [f64; 2])> {
    let end = row.truth.get(i)?.as_ref()?;
    let (x_m, y_m, heading) = match i.checked_sub(1) {
        None => (0.0, 0.0, 0.0),
        Some(before) => row.truth[before].map(|start| (start.x_m, start.y_m, start.heading_rad))?,
    };
    Some((row.true_theta(i)?, heading, rotate([end.x_m - x_m, end.y_m - y_m], -heading)))
}
