//! `[[segment]]`: geometry, sensors and filter parameters of one segment.

use estimator_core::{
    BendErrorConfig, ContactLimits, FusedOps, OffsetAt, PLAYS, Play, SENSORS_PER_SEGMENT, Scalar, SegmentConfig, Turns,
};
use serde::{Deserialize, Serialize};

use crate::bend::BendToml;
use crate::bend_error::BendErrorToml;
use crate::contact::{ChangeToml, CoupledToml};
use crate::error::{FileError, ensure, within};
use crate::noise::{NoiseToml, RMSE_DEG_UNKNOWN};

/// Lengths that fixed point holds with room for the chain (m: ±32).
pub(crate) const MAX_ARM_MM: f64 = 16_000.0;

/// R_imu : R_bend of KF_orient and of KF_coord without a calibration, from calibrations of the reference arm.
const ORIENT_RATIO_UNKNOWN: f64 = 0.02;
const COORD_RATIO_UNKNOWN: f64 = 0.1;

/// `[[segment]]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SegmentToml {
    /// Arc length of the curved part.
    pub length_mm: f64,
    /// Length of the rigid connector.
    pub offset_mm: f64,
    /// Side of the connector.
    pub offset_at: Side,
    /// The bend sensors a and b, as many as there are; `None` in an arm description.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bend: Option<Vec<BendToml>>,
    /// Hysteresis compensation of their mean, up to three plays.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hysteresis: Vec<PlayToml>,
    /// Errors of the bend sensors, from the calibration sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bend_error: Option<BendErrorToml>,
    /// Scale factor of the IMU's heading: reading over true angle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imu_scale: Option<f64>,
    /// The earlier segment that this one is coupled to, if any.
    #[serde(default, skip_serializing_if = "Option::is_none", alias = "alike")]
    pub coupled_to: Option<CoupledToml>,
    /// Limits of contact detection by the bend sensors; `coupled_to` has those of the coupling.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ChangeToml>,
    /// KF_orient's parameters, rad² and rad²/s; `None`: derived from the maps' `rmse_deg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orient: Option<NoiseToml>,
    /// KF_coord's parameters, m² and m²/s; `None`: derived as `orient`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coord: Option<NoiseToml>,
}

/// `offset_at`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The connector precedes the curved part.
    Start,
    /// The connector follows the curved part.
    End,
}

/// One play of a segment's hysteresis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlayToml {
    /// Radius, from the middle to either edge.
    #[serde(alias = "half_width_deg")]
    pub radius_deg: f64,
    /// Weight of the difference of bend angle and play in the correction.
    pub weight: f64,
}

impl SegmentToml {
    pub(crate) fn check(&self, key: &str) -> Result<(), FileError> {
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

    pub(crate) fn compile<S: FusedOps>(&self, reference_deg: f64, rate_hz: f64, value_hz: f64) -> SegmentConfig<S> {
        let mut bend = [None; SENSORS_PER_SEGMENT];
        for (place, sensor) in bend.iter_mut().zip(self.bend.iter().flatten()) {
            *place = Some(sensor.compile());
        }
        SegmentConfig {
            length: S::from_f64(self.length_mm / 1000.0),
            offset: S::from_f64(self.offset_mm / 1000.0),
            offset_at: match self.offset_at {
                Side::Start => OffsetAt::Start,
                Side::End => OffsetAt::End,
            },
            bend,
            hysteresis: self.compile_hysteresis(),
            bend_error: self.compile_bend_error(),
            // The reading is divided by the scale: less (1 − 1/scale) of it.
            imu_scale_error: ((1.0 - 1.0 / self.imu_scale.unwrap_or(1.0)) * f64::powi(2.0, 32)).round() as i32,
            coupled_to: self.coupled_to.map(CoupledToml::compile),
            contact: self.compile_contact(value_hz),
            reference: Turns::from_rad(reference_deg.to_radians()),
            orient: self.orient_or_default().compile(rate_hz),
            coord: self.coord_or_default().compile(rate_hz),
        }
    }

    fn compile_hysteresis<S: Scalar>(&self) -> Option<[Play<S>; PLAYS]> {
        let none = Play { radius: S::zero(), weight: S::zero() };
        let mut plays = [none; PLAYS];
        for (place, play) in plays.iter_mut().zip(&self.hysteresis) {
            let radius = S::from_f64(play.radius_deg.to_radians());
            *place = Play { radius, weight: S::from_f64(play.weight) };
        }
        (!self.hysteresis.is_empty()).then_some(plays)
    }

    /// Errors of the bend sensors, from the sweep or, without one, from the residuals of the maps.
    fn compile_bend_error(&self) -> BendErrorConfig {
        self.bend_error.clone().unwrap_or_else(|| self.default_bend_error()).compile()
    }

    /// Two sensors of one segment with independent errors of the maps' RMSE; correlation as on the paper's sweeps.
    fn default_bend_error(&self) -> BendErrorToml {
        let sensors = self.bend.as_deref().unwrap_or_default();
        let rmse = |sensor: &BendToml| sensor.rmse_deg.unwrap_or(RMSE_DEG_UNKNOWN).max(0.3);
        let sensor_deg: Vec<f64> = sensors.iter().map(rmse).collect();
        let n = sensor_deg.len().max(1) as f64;
        let square_sum: f64 = sensor_deg.iter().map(|deviation| deviation * deviation).sum();
        let mean_deg = if sensors.is_empty() { RMSE_DEG_UNKNOWN } else { square_sum.sqrt() / n };
        BendErrorToml {
            mean_deg,
            sensor_deg,
            noise_deg: 0.0,
            difference_deg: mean_deg,
            slow_difference_deg: mean_deg / 2.0,
            slow_ratio: 1.0,
            travel_deg: 60.0,
            correlation_s: 10.0,
        }
    }

    /// Limits of the segment's own, where it has any.
    fn compile_contact(&self, value_hz: f64) -> Option<ContactLimits> {
        let bend = self.contact.map(ChangeToml::compile);
        let coupling = self.coupled_to.and_then(|coupled| coupled.compile_coupling(value_hz));
        (bend.is_some() || coupling.is_some()).then_some(ContactLimits { bend, coupling })
    }

    /// KF_orient's parameters: the file's, or those of the maps' residuals.
    #[must_use]
    pub fn orient_or_default(&self) -> NoiseToml {
        self.orient.clone().unwrap_or_else(|| {
            let sensors = self.bend.as_deref().unwrap_or_default();
            let variance = |rmse_deg: f64| rmse_deg.to_radians().max(1e-4).powi(2);
            let variances = sensors.iter().map(|sensor| variance(sensor.rmse_deg.unwrap_or(RMSE_DEG_UNKNOWN)));
            // The mean of n sensors whose errors are their own.
            let n = sensors.len() as f64;
            let r_bend = if sensors.is_empty() { variance(RMSE_DEG_UNKNOWN) } else { variances.sum::<f64>() / (n * n) };
            NoiseToml::from_variances(ORIENT_RATIO_UNKNOWN * r_bend, r_bend)
        })
    }

    /// KF_coord's parameters: the file's, or R_bend of KF_orient moved to the arc's end, which an error δθ shifts by
    /// L/2 δθ.
    #[must_use]
    pub fn coord_or_default(&self) -> NoiseToml {
        self.coord.clone().unwrap_or_else(|| {
            let r_bend = self.orient_or_default().r_bend * (self.length_mm / 2000.0).powi(2);
            NoiseToml::from_variances(COORD_RATIO_UNKNOWN * r_bend, r_bend)
        })
    }
}
