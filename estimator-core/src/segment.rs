//! One segment's own stages, in the order of the data: sensing, Kalman filters, constant curvature.

use nalgebra::SVector;

use crate::config::SegmentConfig;
use crate::fusion::kalman::{KalmanFilter, KalmanGains};
use crate::kinematics::pcc::{Pcc, SegmentPose};
use crate::numeric::angle::Angle;
use crate::numeric::fused::FusedOps;
use crate::numeric::phase::Turns;
use crate::sensing::bend_sensors::{BendAngles, BendSensors};
use crate::sensing::heading::{HeadingTracker, SegmentHeading};
use crate::types::{ImuReading, SegmentEstimate};

/// State of one segment.
#[derive(Debug, Clone)]
pub struct SegmentState<S> {
    heading: HeadingTracker<S>,
    bend: BendSensors<S>,
    pcc: Pcc<S>,
    coord: KalmanFilter<S, 2>,
    coord_gains: KalmanGains<S>,
    orient: KalmanFilter<S, 1>,
    orient_gains: KalmanGains<S>,
    fused: Option<SegmentPose<S>>,
}

impl<S: FusedOps> SegmentState<S> {
    /// At the start of a session.
    pub fn new(segment: &SegmentConfig<S>, tare_samples: u32) -> Self {
        Self {
            heading: HeadingTracker::new(tare_samples, segment.reference),
            bend: BendSensors::new(),
            pcc: Pcc::new(segment),
            coord: KalmanFilter::new(),
            coord_gains: KalmanGains::new(&segment.coord),
            orient: KalmanFilter::new(),
            orient_gains: KalmanGains::new(&segment.orient),
            fused: None,
        }
    }

    /// Updates `heading` with one sample's reading.
    pub fn sense_heading(&mut self, heading: &mut SegmentHeading, imu: Option<&ImuReading>) {
        self.heading.read(imu.and_then(ImuReading::heading));
        *heading = *self.heading.segment_heading();
    }

    /// Computes the bend `angles` of one sample's readings; the creep states are updated if `is_followed`.
    pub fn sense_bend(
        &mut self,
        angles: &mut BendAngles<S>,
        config: &SegmentConfig<S>,
        counts: [Option<u16>; 2],
        time_us: u64,
        is_followed: bool,
    ) {
        self.bend.read(angles, config, counts, time_us, is_followed);
    }

    /// Runs KF_orient and KF_coord with the available angles. Whole turns of θ_c are dropped: a segment without an
    /// anchor gathers them by drift alone, and fixed point ends at 32 rad.
    pub fn filter(&mut self, theta_c: Option<Turns>, theta_bend: Option<S>) {
        let theta_c = theta_c.map(|theta| S::from_phase(theta.phase()));
        let end = |theta: S| self.pcc.link(Angle::from(theta)).end;
        self.coord.step(&self.coord_gains, theta_c.map(end), theta_bend.map(end));
        let vector = |theta: S| SVector::from([theta]);
        self.orient.step(&self.orient_gains, theta_c.map(vector), theta_bend.map(vector));
        let states = self.orient.state().zip(self.coord.state());
        self.fused = states.map(|((theta, _), (end, _))| SegmentPose { theta: Angle::from(theta.x), end });
    }

    /// Sets the fused link to constant curvature at the bend angle of all sensors.
    pub fn bend_to(&mut self, theta: Option<Turns>) {
        self.fused = theta.map(|theta| self.pcc.link(Angle::from(theta)));
    }

    /// The fused link.
    pub fn fused(&self) -> Option<SegmentPose<S>> {
        self.fused
    }

    /// The link at any bend angle.
    pub fn link(&self, theta: Angle<S>) -> SegmentPose<S> {
        self.pcc.link(theta)
    }

    /// Estimate of this sample by every method.
    pub fn estimate(
        &self,
        angles: &BendAngles<S>,
        imu_o: Option<Angle<S>>,
        imu_c: Option<Turns>,
    ) -> SegmentEstimate<S> {
        SegmentEstimate {
            bend: angles.mean.map(|theta| self.pcc.link(Angle::from(theta))),
            imu_o,
            imu_c: imu_c.map(|theta| self.pcc.link(Angle::from(theta))),
            fusion: self.fused,
            bend_sensors_read: angles.count(),
            imu_read: self.heading.segment_heading().is_read(),
        }
    }
}
