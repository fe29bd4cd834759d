//! `[contact]`, `contact` and `coupled_to`: thresholds of contact detection, and coupled segments.

use std::ops::RangeInclusive;

use estimator_core::{ChangeLimit, ContactConfig, CoupledSegment, Coupling, Response, Turns};
use serde::{Deserialize, Serialize};

use crate::error::{FileError, ensure, within};

/// `[contact]`: thresholds of the change within five values (half a second at 10 Hz), for segments without limits of
/// their own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ContactToml {
    /// Threshold of the IMUs against the bend sensors of a segment, after a quarter of the motion is subtracted.
    pub bend_deg: f64,
    /// Threshold of a segment against the segment that it is coupled to.
    #[serde(alias = "alike_deg")]
    pub coupling_deg: f64,
}

impl Default for ContactToml {
    fn default() -> Self {
        Self { bend_deg: 5.0, coupling_deg: 4.0 }
    }
}

/// `coupled_to`: an earlier segment that bends in proportion in free motion, θ = ratio · θ of that segment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoupledToml {
    /// Its number, from 1.
    pub segment: usize,
    /// Ratio of this segment's θ to that of the earlier one.
    pub ratio: f64,
    /// The ratio where θ of the earlier segment is negative; `None`: `ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio_left: Option<f64>,
    /// Time constant by which the segment lags the earlier one, s; negative: leads.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub lag_s: f64,
    /// Radius of the segment's play less that of the earlier one, degrees.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub play_deg: f64,
    /// Limit of the change of the residual; `None`: that of `[contact]`, without response to the earlier segment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<ChangeToml>,
}

/// Limit of the change of a residual within ten values, a second at 10 Hz.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChangeToml {
    /// Change that the free arm does not reach.
    pub change_deg: f64,
    /// Largest motion within five values in the calibration sweep; a part of the excess over it is subtracted from the
    /// change.
    pub motion_deg: f64,
}

impl ContactToml {
    pub(crate) fn check(&self) -> Result<(), FileError> {
        within("contact.bend_deg", self.bend_deg, 0.1..=90.0)?;
        within("contact.coupling_deg", self.coupling_deg, 0.1..=90.0)
    }

    pub(crate) fn compile(&self) -> ContactConfig {
        let [bend, coupling] = [self.bend_deg, self.coupling_deg].map(|degrees| Turns::from_rad(degrees.to_radians()));
        ContactConfig { bend, coupling }
    }
}

/// Range of the `ratio` of coupled segments.
pub const RATIO_RANGE: RangeInclusive<f64> = -7.9..=7.9;

/// Longest lag and largest play between two coupled segments.
const LONGEST_LAG_S: f64 = 10.0;
const LARGEST_PLAY_DEG: f64 = 30.0;

impl CoupledToml {
    /// θ = ratio · θ of the segment of this number, without response and limit.
    #[must_use]
    pub const fn with_ratio(segment: usize, ratio: f64) -> Self {
        Self { segment, ratio, ratio_left: None, lag_s: 0.0, play_deg: 0.0, limit: None }
    }

    /// Checks the key of segment number `segment`.
    pub(crate) fn check(&self, key: &str, segment: usize) -> Result<(), FileError> {
        let is_earlier = (1..segment).contains(&self.segment);
        ensure(is_earlier, &format!("{key}.segment"), &self.segment, "the number of an earlier segment")?;
        within(&format!("{key}.ratio"), self.ratio, RATIO_RANGE)?;
        within(&format!("{key}.ratio_left"), self.ratio_left.unwrap_or(self.ratio), RATIO_RANGE)?;
        within(&format!("{key}.lag_s"), self.lag_s, -LONGEST_LAG_S..=LONGEST_LAG_S)?;
        within(&format!("{key}.play_deg"), self.play_deg, -LARGEST_PLAY_DEG..=LARGEST_PLAY_DEG)?;
        self.limit.map_or(Ok(()), |limit| limit.check(&format!("{key}.limit")))
    }

    pub(crate) fn compile(self) -> CoupledSegment {
        CoupledSegment { segment: (self.segment - 1) as u8, ratio: ratio(self.ratio) }
    }

    /// Converts the response at `value_hz` values a second; `None` without a limit.
    pub(crate) fn compile_coupling(self, value_hz: f64) -> Option<Coupling> {
        let play = (self.play_deg.abs() / 360.0 * 2.0_f64.powi(32)).round() as i32;
        let share = 1.0 - (-1.0 / (value_hz * self.lag_s.abs())).exp();
        let share = if self.lag_s.abs() > 0.0 { share } else { 1.0 };
        let share = ((share * f64::from(Response::PROMPT)).round() as i32).max(1);
        let is_play_own = self.play_deg < 0.0;
        let is_lag_own = self.lag_s < 0.0;
        let response = |is_own: bool| Response {
            play: if is_own == is_play_own { play } else { 0 },
            share: if is_own == is_lag_own { share } else { Response::PROMPT },
        };
        Some(Coupling {
            ratio_left: ratio(self.ratio_left.unwrap_or(self.ratio)),
            lead: response(false),
            own: response(true),
            limit: self.limit?.compile(),
        })
    }
}

impl ChangeToml {
    pub(crate) fn check(&self, key: &str) -> Result<(), FileError> {
        within(&format!("{key}.change_deg"), self.change_deg, 0.1..=90.0)?;
        within(&format!("{key}.motion_deg"), self.motion_deg, 0.0..=90.0)
    }

    pub(crate) fn compile(self) -> ChangeLimit {
        let [change, motion] = [self.change_deg, self.motion_deg].map(|degrees| Turns::from_rad(degrees.to_radians()));
        ChangeLimit { change, motion }
    }
}

fn ratio(ratio: f64) -> i32 {
    (ratio * CoupledSegment::ONE).round() as i32
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(value: &f64) -> bool {
    value.abs() <= 0.0
}
