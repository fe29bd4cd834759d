//! The filters' default parameters, from the errors of bend sensors and IMUs on the calibration session.
//!
//! R_bend is the mean square of the bend sensors' error, of each segment by itself. R_imu is that of the error which the
//! corrected IMUs would have if perfect bend sensors anchored them: what they really have on top of it is the slow part
//! of the bend sensors' error, which the anchor passes on to them; it is in both measurements, no filter can remove it,
//! and it must not count against one of them. KF_coord's are these errors moved through PCC to the segment's end.

use std::path::Path;

use calibration_tables::{MAX_WINDOW, NoiseKeys};
use estimator_core::{Anchor, AnchorRule, Angle, Link, Segment, Turns};
use nalgebra::Vector2;

use crate::error::Error;
use crate::replay::{NamedTable, Outcome, replay};
use crate::session::Row;

/// Bounds of R_imu : R_bend: the session is only a sample, and neither measurement is beyond doubt.
const RATIO: [f64; 2] = [0.05, 10.0];

/// Mean squares of one filter's measurement errors on one segment.
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    imu: f64,
    bend: f64,
    count: f64,
}

impl Errors {
    fn add(&mut self, imu_square: f64, bend_square: f64, coordinates: f64) {
        self.imu += imu_square;
        self.bend += bend_square;
        self.count += coordinates;
    }

    /// `None` where the two measurements were never there together.
    fn noise(&self) -> Option<NoiseKeys> {
        let [lo, hi] = RATIO;
        let r_bend = self.bend / self.count;
        (self.bend > 0.0).then(|| NoiseKeys::from_variances((self.imu / self.bend).clamp(lo, hi) * r_bend, r_bend))
    }
}

/// What is gathered of one segment while the session is replayed.
struct Gatherer<'t> {
    segment: &'t Segment<f64>,
    /// Anchors to the truth, as perfect bend sensors would be.
    anchor: Anchor<{ MAX_WINDOW as usize }>,
    orient: Errors,
    coord: Errors,
}

/// Sets `orient` and `coord` of every segment that has bend sensors.
pub(super) fn set_filters(session: &Path, table: &mut NamedTable, rate_hz: f64) -> Result<(), Error> {
    let baked = table.bake::<f64>(rate_hz)?;
    let baked = baked.table();
    let gatherer =
        |segment| Gatherer { segment, anchor: Anchor::new(), orient: Errors::default(), coord: Errors::default() };
    let mut gatherers: Vec<Gatherer> = baked.segments.iter().map(gatherer).collect();
    replay::<f64>(session, table, |row, outcome| {
        for (i, gatherer) in gatherers.iter_mut().enumerate() {
            gatherer.add_row(i, row, outcome, &baked.anchor);
        }
        Ok(())
    })?;
    for (segment, gatherer) in table.file.segments.iter_mut().zip(&gatherers) {
        (segment.orient, segment.coord) = (gatherer.orient.noise(), gatherer.coord.noise());
    }
    Ok(())
}

impl Gatherer<'_> {
    fn add_row(&mut self, i: usize, row: &Row, outcome: &Outcome<f64>, rule: &AnchorRule) {
        let Some(estimate) = outcome.estimate.segments.get(i) else { return };
        let imu = estimate.imu_o.map(Angle::rad);
        let truth = row.true_theta(i);
        self.anchor.push(rule, imu.zip(truth).map(|(imu, truth)| Turns::from_rad(imu - truth)));
        let imu_c = imu.zip(self.anchor.offset()).map(|(imu, offset)| imu - offset.rad());

        let Some(((imu_c, bend), truth)) = imu_c.zip(estimate.bend).zip(truth) else { return };
        self.orient.add((imu_c - truth).powi(2), (bend.theta.rad() - truth).powi(2), 1.0);
        let end = |theta: f64| Link::new(Angle::from(theta), self.segment).end;
        let square = |point: Vector2<f64>| (point - end(truth)).norm_squared();
        self.coord.add(square(end(imu_c)), square(bend.end), 2.0);
    }
}
