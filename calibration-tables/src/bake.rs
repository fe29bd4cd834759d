//! From the file's units to the estimator's configuration, for one sample rate.

use estimator_core::{
    AnchorConfig, ArmConfig, BiasFilterConfig, COVARIANCE_LIMIT, ContactConfig, FusedOps, KalmanParams, OffsetAt,
    PLAYS, Play, SENSORS_PER_SEGMENT, Scalar, SegmentConfig, Turns, UncertaintyConfig,
};

use crate::contact::{ContactKeys, CoupledKeys};
use crate::drift::DriftKeys;
use crate::file::{ArmFile, FileError, NoiseKeys, SegmentKeys, Side};
use crate::uncertainty::UncertaintyKeys;

/// A table's parameters in the number type `S`, for sessions of one sample rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Baked<S> {
    segments: Vec<SegmentConfig<S>>,
    tare_samples: u32,
    anchor: AnchorConfig,
    bias_filter: Option<BiasFilterConfig>,
    contact: Option<ContactConfig>,
    uncertainty: Option<UncertaintyConfig>,
}

impl<S> Baked<S> {
    /// The configuration as the estimator takes it.
    #[must_use]
    pub fn config(&self) -> ArmConfig<'_, S> {
        let Self { segments, tare_samples, anchor, bias_filter, contact, uncertainty } = self;
        ArmConfig {
            segments,
            tare_samples: *tare_samples,
            anchor: *anchor,
            bias_filter: *bias_filter,
            contact: *contact,
            uncertainty: *uncertainty,
        }
    }
}

impl ArmFile {
    /// The estimator's configuration for samples at `rate_hz`: process noise per second becomes noise per sample, seconds of
    /// tare become samples, and the anchor averages the samples that come between its own.
    ///
    /// # Errors
    /// [`FileError::NotCalibrated`] on an arm description.
    pub fn bake<S: FusedOps>(&self, rate_hz: f64) -> Result<Baked<S>, FileError> {
        self.bend_sensors()?;
        let references = self.tare.heading_deg.iter().copied().chain(std::iter::repeat(0.0));
        let segments = self.segments.iter().zip(references);
        // Above the sample rate, every sample is a value.
        let value_hz = self.anchor.rate_hz.min(rate_hz);
        Ok(Baked {
            segments: segments.map(|(segment, reference)| segment.bake(reference, rate_hz, value_hz)).collect(),
            tare_samples: samples(self.tare.seconds, rate_hz),
            anchor: AnchorConfig {
                window: self.anchor.window,
                rate_millihertz: millihertz(self.anchor.rate_hz),
                sample_rate_millihertz: millihertz(rate_hz),
                threshold: Turns::from_rad(self.anchor.threshold_deg.to_radians()),
            },
            bias_filter: self.bias_filter().map(DriftKeys::bake),
            contact: self.contact.as_ref().map(ContactKeys::bake),
            uncertainty: self.uncertainty.as_ref().map(UncertaintyKeys::bake),
        })
    }
}

fn millihertz(rate_hz: f64) -> u32 {
    (rate_hz * 1000.0).round() as u32
}

/// Samples in `seconds`; at least one where there is any time at all.
fn samples(seconds: f64, rate_hz: f64) -> u32 {
    if seconds > 0.0 { (seconds * rate_hz).round().max(1.0) as u32 } else { 0 }
}

impl SegmentKeys {
    fn bake<S: FusedOps>(&self, reference_deg: f64, rate_hz: f64, value_hz: f64) -> SegmentConfig<S> {
        let mut bend = [None; SENSORS_PER_SEGMENT];
        for (place, sensor) in bend.iter_mut().zip(self.bend.iter().flatten()) {
            *place = Some(sensor.bake());
        }
        SegmentConfig {
            length: S::from_f64(self.length_mm / 1000.0),
            offset: S::from_f64(self.offset_mm / 1000.0),
            offset_at: match self.offset_at {
                Side::Start => OffsetAt::Start,
                Side::End => OffsetAt::End,
            },
            bend,
            hysteresis: self.bake_hysteresis(),
            bend_error: self.bake_bend_error(),
            // The reading is divided by the scale: less (1 − 1/scale) of it.
            imu_scale_error: ((1.0 - 1.0 / self.imu_scale.unwrap_or(1.0)) * f64::powi(2.0, 32)).round() as i32,
            coupled_to: self.coupled_to.map(CoupledKeys::bake),
            contact: self.bake_contact(value_hz),
            reference: Turns::from_rad(reference_deg.to_radians()),
            orient: self.orient_or_default().bake(rate_hz),
            coord: self.coord_or_default().bake(rate_hz),
        }
    }

    fn bake_hysteresis<S: Scalar>(&self) -> Option<[Play<S>; PLAYS]> {
        let none = Play { radius: S::zero(), weight: S::zero() };
        let mut plays = [none; PLAYS];
        for (place, play) in plays.iter_mut().zip(&self.hysteresis) {
            let radius = S::from_f64(play.radius_deg.to_radians());
            *place = Play { radius, weight: S::from_f64(play.weight) };
        }
        (!self.hysteresis.is_empty()).then_some(plays)
    }
}

impl NoiseKeys {
    /// Covariances as ratios to the larger R, as the estimator takes them.
    fn bake<S: Scalar>(&self, rate_hz: f64) -> KalmanParams<S> {
        let unit = self.r_imu.max(self.r_bend);
        KalmanParams {
            q: S::from_f64((self.q / rate_hz / unit).min(COVARIANCE_LIMIT)),
            r_imu: S::from_f64(self.r_imu / unit),
            r_bend: S::from_f64(self.r_bend / unit),
            h_imu: S::from_f64(self.h_imu),
            h_bend: S::from_f64(self.h_bend),
        }
    }
}
