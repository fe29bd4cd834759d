//! From the file's units to the estimator's configuration, for one sample rate.

use board_table::Wiring;
use estimator_core::{
    AnchorConfig, ArmConfig, BiasFilterConfig, ContactConfig, FusedOps, SegmentConfig, Turns, UncertaintyConfig,
};

use crate::arm::ArmFile;
use crate::board::BoardToml;
use crate::contact::ContactToml;
use crate::drift::DriftToml;
use crate::error::FileError;
use crate::uncertainty::UncertaintyToml;

/// A table's parameters in the number type `S`, for sessions of one sample rate.
#[derive(Debug, Clone, PartialEq)]
pub struct CompiledTable<S> {
    segments: Vec<SegmentConfig<S>>,
    tare_samples: u32,
    anchor: AnchorConfig,
    bias_filter: Option<BiasFilterConfig>,
    contact: Option<ContactConfig>,
    uncertainty: Option<UncertaintyConfig>,
    /// The wiring of the section `[board]`, if there is one.
    pub(crate) wiring: Option<Wiring>,
}

impl<S> CompiledTable<S> {
    /// The estimator's configuration.
    #[must_use]
    pub fn config(&self) -> ArmConfig<'_, S> {
        let Self { segments, tare_samples, anchor, bias_filter, contact, uncertainty, wiring: _ } = self;
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
    /// Converts the table to the estimator's units and number type, for samples at `rate_hz`: process noise per second
    /// becomes noise per sample, seconds of tare become samples, and the anchor averages the samples between two of its
    /// values.
    ///
    /// # Errors
    /// [`FileError::NotCalibrated`] on an arm description.
    pub fn compile<S: FusedOps>(&self, rate_hz: f64) -> Result<CompiledTable<S>, FileError> {
        self.bend_sensors()?;
        let references = self.tare.heading_deg.iter().copied().chain(std::iter::repeat(0.0));
        let segments = self.segments.iter().zip(references);
        // Above the sample rate, every sample is a value.
        let value_hz = self.anchor.rate_hz.min(rate_hz);
        Ok(CompiledTable {
            segments: segments.map(|(segment, reference)| segment.compile(reference, rate_hz, value_hz)).collect(),
            tare_samples: samples(self.tare.seconds, rate_hz),
            anchor: AnchorConfig {
                window: self.anchor.window,
                rate_millihertz: millihertz(self.anchor.rate_hz),
                sample_rate_millihertz: millihertz(rate_hz),
                threshold: Turns::from_rad(self.anchor.threshold_deg.to_radians()),
            },
            bias_filter: self.bias_filter().map(DriftToml::compile),
            contact: self.contact.as_ref().map(ContactToml::compile),
            uncertainty: self.uncertainty.as_ref().map(UncertaintyToml::compile),
            wiring: self.board.as_ref().and_then(BoardToml::wiring),
        })
    }
}

fn millihertz(rate_hz: f64) -> u32 {
    (rate_hz * 1000.0).round() as u32
}

/// Number of samples in `seconds`; at least one for a positive time.
fn samples(seconds: f64, rate_hz: f64) -> u32 {
    if seconds > 0.0 { (seconds * rate_hz).round().max(1.0) as u32 } else { 0 }
}
