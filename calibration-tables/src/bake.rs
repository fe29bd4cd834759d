//! From the file's units to the estimator's parameters, for one sample rate.

use estimator_core::{
    AnchorRule, BendMap, COVARIANCE_LIMIT, ContactRule, Hysteresis, Noise, ObserverRule, OffsetAt, PLAYS, Play,
    SENSORS_PER_SEGMENT, Scalar, Segment, Table, Turns, UncertaintyRule,
};

use crate::file::{ArmFile, FileError, NoiseKeys, SegmentKeys, Side};
use crate::uncertainty::{AlikeKeys, ContactKeys};

/// A table's parameters in the number type `S`, for sessions of one sample rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Baked<S> {
    segments: Vec<Segment<S>>,
    tare_samples: u32,
    anchor: AnchorRule,
    observer: Option<ObserverRule>,
    contact: Option<ContactRule>,
    uncertainty: Option<UncertaintyRule<S>>,
}

impl<S: Copy> Baked<S> {
    /// The parameters as the estimator takes them.
    #[must_use]
    pub fn table(&self) -> Table<'_, S> {
        let Self { segments, tare_samples, anchor, observer, contact, uncertainty } = self;
        Table {
            segments,
            tare_samples: *tare_samples,
            anchor: *anchor,
            observer: *observer,
            contact: *contact,
            uncertainty: *uncertainty,
        }
    }
}

impl ArmFile {
    /// The estimator's parameters for samples at `rate_hz`: process noise per second becomes noise per sample, seconds
    /// of tare become samples, and the anchor averages the samples that come between its own.
    ///
    /// # Errors
    /// [`FileError::NotCalibrated`] on an arm description.
    pub fn bake<S: Scalar>(&self, rate_hz: f64) -> Result<Baked<S>, FileError> {
        self.bend_sensors()?;
        let references = self.tare.heading_deg.iter().copied().chain(std::iter::repeat(0.0));
        let segments = self.segments.iter().zip(references);
        let value_hz = self.anchor.rate_hz.min(rate_hz);
        let observer = self.observer();
        let measurement_deg2 = observer.map_or(0.0, |drift| drift.measurement_deg2(value_hz));
        Ok(Baked {
            segments: segments.map(|(segment, reference)| segment.bake(reference, rate_hz)).collect(),
            tare_samples: samples(self.tare.seconds, rate_hz),
            anchor: AnchorRule {
                window: self.anchor.window,
                rate_millihertz: millihertz(self.anchor.rate_hz),
                sample_rate_millihertz: millihertz(rate_hz),
                threshold: Turns::from_rad(self.anchor.threshold_deg.to_radians()),
            },
            observer: observer.map(|drift| drift.bake(value_hz)),
            contact: self.contact.as_ref().map(ContactKeys::bake),
            uncertainty: self.uncertainty.as_ref().map(|keys| keys.bake(measurement_deg2)),
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
    fn bake<S: Scalar>(&self, reference_deg: f64, rate_hz: f64) -> Segment<S> {
        let mut bend = [None; SENSORS_PER_SEGMENT];
        for (place, map) in bend.iter_mut().zip(self.bend.iter().flatten()) {
            *place = Some(BendMap::from_volts(map.c2, map.c1, map.c0, map.range_volts()));
        }
        Segment {
            length: S::from_f64(self.length_mm / 1000.0),
            offset: S::from_f64(self.offset_mm / 1000.0),
            offset_at: match self.offset_at {
                Side::Start => OffsetAt::Start,
                Side::End => OffsetAt::End,
            },
            bend,
            hysteresis: self.bake_hysteresis(),
            alike: self.alike.map(AlikeKeys::bake),
            reference: Turns::from_rad(reference_deg.to_radians()),
            orient: self.orient_or_default().bake(rate_hz),
            coord: self.coord_or_default().bake(rate_hz),
        }
    }
}

impl SegmentKeys {
    fn bake_hysteresis<S: Scalar>(&self) -> Option<Hysteresis<S>> {
        let none = Play { half_width: S::zero(), weight: S::zero() };
        let mut plays = [none; PLAYS];
        for (place, play) in plays.iter_mut().zip(&self.hysteresis) {
            let half_width = S::from_f64(play.half_width_deg.to_radians());
            *place = Play { half_width, weight: S::from_f64(play.weight) };
        }
        (!self.hysteresis.is_empty()).then_some(plays)
    }
}

impl NoiseKeys {
    /// Covariances as ratios to the larger R, as the estimator takes them.
    fn bake<S: Scalar>(&self, rate_hz: f64) -> Noise<S> {
        let unit = self.r_imu.max(self.r_bend);
        Noise {
            q: S::from_f64((self.q / rate_hz / unit).min(COVARIANCE_LIMIT)),
            r_imu: S::from_f64(self.r_imu / unit),
            r_bend: S::from_f64(self.r_bend / unit),
            h_imu: S::from_f64(self.h_imu),
            h_bend: S::from_f64(self.h_bend),
        }
    }
}
