//! Corrections of the headings: by its bias for a heading that was read, by its neighbours for an absent one.

use estimator_core::ABSENT_TIME_S;

use super::correction::Correction;

/// Readings of a segment that are present in a row.
#[derive(Debug, Clone, Copy)]
pub struct Present {
    /// The filter has used the heading.
    pub heading: bool,
    /// The bend angle was read.
    pub bend: bool,
}

/// Corrections of the bend angles, row after row.
///
/// The filter takes an absent heading from below and above by the motion of the bend sensors, and draws it to
/// θ_bend − o; a path without a bend sensor counts only where neither has one, and the path from above is drawn only
/// where it is the only one. The correction of such a heading follows the same rule, from that which it had when it was
/// last read.
#[derive(Debug, Clone)]
pub struct HeadingCorrections {
    /// Corrections of θ_i, rad.
    angles: Vec<f64>,
}

impl HeadingCorrections {
    /// At the start of a session.
    pub fn new(segments: usize) -> Self {
        Self { angles: vec![0.0; segments] }
    }

    /// Corrections of the bend angles in a row, rad, `elapsed_s` after the last one.
    pub fn advance(&mut self, correction: &Correction, present: &[Present], elapsed_s: f64) -> &[f64] {
        let (mut below, mut is_below_measured) = (0.0, true);
        for i in 0..self.angles.len() {
            let mut is_measured = present[i].heading;
            let heading = if is_measured {
                -correction.biases[i]
            } else {
                let own = below + self.carried(i, correction, present, elapsed_s);
                let is_by_own = is_below_measured && present[i].bend;
                let above = present.get(i + 1).filter(|above| above.heading);
                is_measured = is_by_own || above.is_some_and(|above| above.bend);
                above.map_or(own, |above| {
                    let drawn_s = if is_by_own { 0.0 } else { elapsed_s };
                    let from_above = -correction.biases[i + 1] - self.carried(i + 1, correction, present, drawn_s);
                    match (is_by_own, above.bend) {
                        (true, false) => own,
                        (false, true) => from_above,
                        _ => f64::midpoint(own, from_above),
                    }
                })
            };
            self.angles[i] = heading - below;
            (below, is_below_measured) = (heading, is_measured);
        }
        &self.angles
    }

    /// The last correction of θ_i, drawn to that of θ_bend.
    fn carried(&self, i: usize, correction: &Correction, present: &[Present], elapsed_s: f64) -> f64 {
        let share = if present[i].bend { (elapsed_s / ABSENT_TIME_S).min(1.0) } else { 0.0 };
        self.angles[i] + share * (-correction.offsets[i] - self.angles[i])
    }

    /// Follows an update, which has turned the filter's headings by its change of the `biases`, rad. Smoothed headings do
    /// not depend on the time of the filter's updates.
    pub fn follow_update(&mut self, biases: impl Iterator<Item = f64>) {
        let mut below = 0.0;
        for (angle, bias) in self.angles.iter_mut().zip(biases) {
            *angle += bias - below;
            below = bias;
        }
    }
}
