//! Replica of the board's estimator on the host, for the values that the board does not send with each sample: drift,
//! innovations, uncertainty and contact.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{ArmConfig, Covariance, Estimator, Method, Q, Sample, VARIANCE_SCALE};
use proprio_analysis::HostEstimator;

use super::page_row::{ColumnGroup, PageRow};

/// Replica of the board's estimator, run over the samples that the board sends.
pub(super) struct HostReplica<'t> {
    estimator: Box<HostEstimator<'t, Q>>,
    table: &'t ArmConfig<'t, Q>,
    /// x⁻ of KF_orient, rad: with A = I the state after the sample before.
    predicted_rad: [Option<f64>; MAX_SEGMENTS],
}

impl<'t> HostReplica<'t> {
    /// A replica with a table from a file, whose checks are at least as strict as the estimator's.
    pub fn new(table: &'t ArmConfig<'t, Q>) -> Self {
        let estimator = Box::new(Estimator::new(table).expect("the file was checked"));
        Self { estimator, table, predicted_rad: [None; MAX_SEGMENTS] }
    }

    /// Segments of the table's arm.
    pub fn segments(&self) -> usize {
        self.table.segments.len()
    }

    /// Starts the estimator (again) before the next sample.
    pub fn start(&mut self) {
        self.estimator.start().expect("the file was checked");
        self.predicted_rad = [None; MAX_SEGMENTS];
    }

    /// Takes one sample and sets its estimate, drift, innovations, uncertainty and contact.
    pub fn step(&mut self, sample: &Sample<MAX_SEGMENTS>, row: &mut PageRow) {
        let estimate = self.estimator.update_full(sample);
        let shape = self.estimator.shape(&estimate, Method::Fusion);
        for (i, (of, noise)) in estimate.segments.iter().zip(self.table.segments).enumerate() {
            let fused = shape.get(i);
            row.set(ColumnGroup::Theta, i, fused.and_then(|fused| fused.theta).map(|theta| theta.rad().to_degrees()));
            row.set(ColumnGroup::X, i, fused.and_then(|fused| fused.end).map(|end| end.x.to_f64() * 1e3));
            row.set(ColumnGroup::Y, i, fused.and_then(|fused| fused.end).map(|end| end.y.to_f64() * 1e3));

            let corrected = of.imu_c.map(|link| link.theta);
            let drift = of.imu_o.zip(corrected).map(|(raw, corrected)| raw.rad() - corrected.rad());
            row.set(ColumnGroup::Drift, i, drift.map(f64::to_degrees));

            let innovation = |z: Option<f64>, h: Q| {
                z.zip(self.predicted_rad[i]).map(|(z, predicted)| (z - h.to_f64() * predicted).to_degrees())
            };
            // The filters take θ_c without its whole turns.
            let z_imu = corrected.map(|theta| theta.remainder.to_f64());
            row.set(ColumnGroup::InnovationImu, i, innovation(z_imu, noise.orient.h_imu));
            let z_bend = of.bend.map(|link| link.theta.remainder.to_f64());
            row.set(ColumnGroup::InnovationBend, i, innovation(z_bend, noise.orient.h_bend));
            self.predicted_rad[i] = of.fusion.map(|fused| fused.theta.remainder.to_f64());
        }
        for (i, of) in self.estimator.uncertainties().iter().enumerate() {
            let theta_rad2 = of.theta.map(|variance| variance.to_f64() / VARIANCE_SCALE);
            row.set_variances(i, theta_rad2, of.end.map(Covariance::square_metres));
        }
        for (i, of) in self.estimator.contacts().iter().enumerate() {
            row.set_contact(i, of.score_percent, of.in_contact);
        }
    }
}
