//! Residual of a segment against the one that it is coupled to, as both follow the same pressure.
//!
//! The segments of a module differ in gain to either side, in play and in lag. The segment with less play or lag is
//! filtered by the difference; the ratios then apply to the motion of the filtered angle, so that drift of the IMUs has
//! no effect.

use crate::config::{CoupledSegment, Coupling, Response};
use crate::contact::detector::{Residual, scaled};

/// State of a segment's coupling. Angles are in units of 2⁻³² turns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CouplingModel {
    lead: ResponseFilter,
    own: ResponseFilter,
    /// θ predicted from the coupled segment, up to a constant.
    expected: i32,
    is_started: bool,
}

/// State of a [`Response`].
#[derive(Debug, Clone, Copy)]
struct ResponseFilter {
    play: i32,
    lag: i32,
}

impl CouplingModel {
    pub const fn new() -> Self {
        let filter = ResponseFilter { play: 0, lag: 0 };
        Self { lead: filter, own: filter, expected: 0, is_started: false }
    }

    /// Updates the model with one value of the segment's angle and of the coupled segment's; the latter plus
    /// `lead_steps` is its θ_c.
    #[inline(never)]
    pub fn update(
        &mut self,
        coupled: CoupledSegment,
        coupling: &Coupling,
        own: i32,
        lead: i32,
        lead_steps: i32,
    ) -> Residual {
        if !self.is_started {
            self.is_started = true;
            self.lead = ResponseFilter { play: lead, lag: lead };
            self.own = ResponseFilter { play: own, lag: own };
        }
        let motion = self.lead.step(coupling.lead, lead);
        let _ = self.own.step(coupling.own, own);
        // The ratio changes where the corrected angle is zero.
        let theta = self.lead.lag.wrapping_add(lead_steps);
        let before = theta.wrapping_sub(motion);
        let curve = |theta: i32| scaled(theta, if theta < 0 { coupling.ratio_left } else { coupled.ratio });
        self.expected = self.expected.wrapping_add(curve(theta).wrapping_sub(curve(before)));
        Residual { residual: self.own.lag.wrapping_sub(self.expected), angle: self.expected }
    }
}

impl ResponseFilter {
    /// Filters one value; returns the change of the output.
    fn step(&mut self, response: Response, angle: i32) -> i32 {
        let ahead = angle.wrapping_sub(self.play);
        self.play = self.play.wrapping_add(ahead.saturating_sub(ahead.min(response.play).max(-response.play)));
        let behind = self.play.wrapping_sub(self.lag);
        let change = ((i64::from(behind) * i64::from(response.share)) >> 16) as i32;
        self.lag = self.lag.wrapping_add(change);
        change
    }
}

#[cfg(test)]
mod tests {
    use super::CouplingModel;
    use crate::config::{ChangeLimit, CoupledSegment, Coupling, Response};
    use crate::numeric::phase::Turns;

    const DEGREE: i32 = 11_930_465;
    const COUPLED: CoupledSegment = CoupledSegment { segment: 0, ratio: (1.25 * CoupledSegment::ONE) as i32 };
    const PLAIN: Coupling = Coupling {
        ratio_left: (0.75 * CoupledSegment::ONE) as i32,
        lead: Response::NONE,
        own: Response::NONE,
        limit: ChangeLimit { change: Turns::ZERO, motion: Turns::ZERO },
    };

    /// Residual after a swing of the coupled segment through these angles, degrees, while the segment does not move.
    fn residual(coupling: &Coupling, lead: &[i32], lead_steps: i32) -> i32 {
        let mut model = CouplingModel::new();
        lead.iter().fold(0, |_, lead| {
            let lead = lead * DEGREE;
            model.update(COUPLED, coupling, 0, lead.wrapping_sub(lead_steps), lead_steps).residual
        })
    }

    #[test]
    fn each_side_has_a_ratio_of_its_own() {
        assert_eq!(residual(&PLAIN, &[0, 20], 0) / DEGREE, -25);
        assert_eq!(residual(&PLAIN, &[0, -20], 0) / DEGREE, 15);
        assert_eq!(residual(&PLAIN, &[-20, 20], 0) / DEGREE, -40);
    }

    #[test]
    fn a_bias_of_the_imus_changes_nothing() {
        for steps in [-170, 10, 170] {
            assert_eq!(residual(&PLAIN, &[-20, 20], steps * DEGREE) / DEGREE, -40);
        }
    }

    #[test]
    fn play_of_the_segment_is_passed_by_the_coupled_one_first() {
        let coupling = Coupling { lead: Response { play: 2 * DEGREE, ..Response::NONE }, ..PLAIN };
        assert_eq!(residual(&coupling, &[0, 10], 0) / DEGREE, -10);
        assert_eq!(residual(&coupling, &[0, 10, 7], 0) / DEGREE, -10);
    }

    #[test]
    fn lag_of_the_segment_is_passed_by_the_coupled_one_first() {
        let coupling = Coupling { lead: Response { share: Response::PROMPT / 2, ..Response::NONE }, ..PLAIN };
        assert_eq!(residual(&coupling, &[0, 16], 0) / DEGREE, -10);
        assert_eq!(residual(&coupling, &[0, 16, 16], 0) / DEGREE, -15);
    }
}
