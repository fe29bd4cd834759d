//! Contacts: the sticks of scenario II and the obstacle of scenario III.
//!
//! Both are modelled by their effect on the curvature, not by forces: a touch adds a peak of curvature at one place of
//! a segment.

use crate::constants::{
    CONTACT_HALF_WIDTH, OBSTACLE_BELOW_M, OBSTACLE_LEVER_M, OBSTACLE_NEXT_SHARE, OBSTACLE_PLACE, OBSTACLE_WRAP_SHARE,
    OBSTACLE_X_M, OBSTACLE_YIELD_RAD, PUSH_BEND_RAD, PUSH_DURATION_S, PUSH_NEIGHBOUR_SHARE, PUSH_PAUSE_S, PUSH_PLACE,
    PUSH_RISE_S, REACTION_HALF_WIDTH, REST_S,
};
use crate::layout::{Layout, PerSegment};
use crate::noise::{Noise, Seeds, Source};
use crate::scenario::Scenario;
use crate::smooth_step::smooth_step;

/// Effect of a contact on one segment's curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    pub(crate) bend_rad: f64,
    place: f64,
    half_width: f64,
}

impl Touch {
    pub(crate) const NONE: Self = Self::reaction(0.0);

    /// A peak of curvature where the arm is touched.
    const fn contact(bend_rad: f64, place: f64) -> Self {
        Self { bend_rad, place, half_width: CONTACT_HALF_WIDTH }
    }

    /// A bend that spreads over the curve of a segment that is not itself touched.
    const fn reaction(bend_rad: f64) -> Self {
        Self { bend_rad, place: 0.5, half_width: REACTION_HALF_WIDTH }
    }

    /// Its turning up to the share `along` of the curve, rad: the integral of a biweight kernel.
    pub(crate) fn turned_rad(&self, along: f64) -> f64 {
        let u = ((along - self.place) / self.half_width).clamp(-1.0, 1.0);
        let u2 = u * u;
        self.bend_rad * (0.5 + u * (15.0 + u2 * (3.0 * u2 - 10.0)) / 16.0)
    }
}

/// One push of a stick in scenario II.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Start of the contact, s.
    pub start_s: f64,
    /// Duration of the contact, s.
    pub duration_s: f64,
    /// The pushed segment, counted from 0.
    pub segment: usize,
    /// Place along the segment's curve, a share of its length.
    pub place: f64,
    /// Bend added to that segment at full strength, rad, clockwise positive.
    pub bend_rad: f64,
}

impl Push {
    /// Push `number` of the session on one of `segments` segments, at the end of a pause that begins at `pause_s`.
    fn new(seeds: Seeds, segments: usize, number: usize, pause_s: f64) -> Self {
        let mut noise = Noise::of_session(seeds, Source::Contact, number);
        Self {
            start_s: pause_s + noise.between(PUSH_PAUSE_S),
            duration_s: noise.between(PUSH_DURATION_S),
            segment: noise.pick(segments),
            place: noise.between(PUSH_PLACE),
            bend_rad: noise.sign() * noise.between(PUSH_BEND_RAD),
        }
    }

    fn end_s(&self) -> f64 {
        self.start_s + self.duration_s
    }

    fn touches(&self, time_s: f64, segments: usize) -> PerSegment<Touch> {
        let strength =
            smooth_step((time_s - self.start_s) / PUSH_RISE_S) * smooth_step((self.end_s() - time_s) / PUSH_RISE_S);
        let bend_rad = strength * self.bend_rad;
        let touch = |segment: usize| match segment.abs_diff(self.segment) {
            0 => Touch::contact(bend_rad, self.place),
            1 => Touch::reaction(-PUSH_NEIGHBOUR_SHARE * bend_rad),
            _ => Touch::NONE,
        };
        (0..segments).map(touch).collect()
    }
}

/// The obstacle of scenario III: a post next to the arm, which the segment after half of all segments meets: the fourth
/// of six. An arm of one segment has nothing below it that could turn back, and does not meet it.
#[derive(Clone, Debug)]
pub(crate) struct Obstacle {
    /// 1 to the right of the arm, −1 to its left.
    pub(crate) side: f64,
    distance_m: f64,
    lever_m: f64,
    /// Lengths of the segments below the contact.
    below_m: PerSegment<f64>,
}

impl Obstacle {
    pub(crate) fn new(layout: &Layout, seeds: Seeds) -> Self {
        let mut noise = Noise::of_session(seeds, Source::Contact, 0);
        let segments = layout.segments();
        let below = segments[..segments.len() / 2].iter().map(|segment| segment.curve_m + segment.connector_m);
        let below_m: PerSegment<f64> = below.collect();
        let scale = below_m.iter().sum::<f64>() / OBSTACLE_BELOW_M;
        Self {
            side: noise.sign(),
            distance_m: scale * noise.between(OBSTACLE_X_M),
            lever_m: scale * OBSTACLE_LEVER_M,
            below_m,
        }
    }

    /// The arm below the contact is turned back until it is level with the post, or slides; the contact's segment and
    /// the next wrap around it. `free_rad` are the bends without the obstacle.
    fn touches(&self, free_rad: &[f64]) -> PerSegment<Touch> {
        let below = self.below_m.len();
        if below == 0 {
            return untouched(free_rad.len());
        }
        let depth_m = (self.side * self.chord_x_m(free_rad) - self.distance_m).max(0.0);
        let wanted_rad = depth_m / self.lever_m;
        let back_rad = self.side * OBSTACLE_YIELD_RAD * wanted_rad / (OBSTACLE_YIELD_RAD + wanted_rad);
        let touch = |segment: usize| {
            if segment < below {
                Touch::reaction(-back_rad / below as f64)
            } else if segment == below {
                Touch::contact(OBSTACLE_WRAP_SHARE * back_rad, OBSTACLE_PLACE)
            } else if segment == below + 1 {
                Touch::reaction(OBSTACLE_NEXT_SHARE * back_rad)
            } else {
                Touch::NONE
            }
        };
        (0..free_rad.len()).map(touch).collect()
    }

    /// Approximate distance of the contact across the base's axis, m: each segment below it as long as its arc, at its
    /// mean heading.
    fn chord_x_m(&self, free_rad: &[f64]) -> f64 {
        let mut heading_rad = 0.0;
        let mut x_m = 0.0;
        for (bend_rad, length_m) in free_rad.iter().zip(&self.below_m) {
            x_m += length_m * libm::sin(heading_rad + bend_rad / 2.0);
            heading_rad += bend_rad;
        }
        x_m
    }
}

/// Touches of segments that nothing touches.
fn untouched(segments: usize) -> PerSegment<Touch> {
    (0..segments).map(|_| Touch::NONE).collect()
}

/// Contacts of the arm in a session.
#[derive(Clone, Debug)]
pub(crate) enum Contacts {
    None,
    Sticks { seeds: Seeds, begun: Vec<Push>, next: Push },
    Obstacle(Obstacle),
}

impl Contacts {
    pub(crate) fn new(scenario: Scenario, layout: &Layout, seeds: Seeds) -> Self {
        let segments = layout.segments().len();
        match scenario {
            Scenario::Sweep | Scenario::FreeSwing => Self::None,
            Scenario::Push => Self::Sticks { seeds, begun: Vec::new(), next: Push::new(seeds, segments, 0, REST_S) },
            Scenario::Obstacle => Self::Obstacle(Obstacle::new(layout, seeds)),
        }
    }

    /// Touch of each segment at `time_s`, for the bends of the free arm.
    pub(crate) fn touches(&mut self, time_s: f64, free_rad: &[f64]) -> PerSegment<Touch> {
        let segments = free_rad.len();
        match self {
            Self::None => untouched(segments),
            Self::Sticks { seeds, begun, next } => {
                if time_s >= next.start_s {
                    begun.push(*next);
                    *next = Push::new(*seeds, segments, begun.len(), next.end_s());
                }
                begun.last().map_or_else(|| untouched(segments), |push| push.touches(time_s, segments))
            }
            Self::Obstacle(obstacle) => obstacle.touches(free_rad),
        }
    }

    /// The pushes that have begun.
    pub(crate) fn pushes(&self) -> &[Push] {
        match self {
            Self::Sticks { begun, .. } => begun,
            Self::None | Self::Obstacle(_) => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{OBSTACLE_LEVER_M, Obstacle, Touch};
    use crate::constants::SEGMENTS;

    /// The obstacle of an arm with three segments of 97 mm below it.
    fn obstacle(side: f64) -> Obstacle {
        Obstacle { side, distance_m: 0.05, lever_m: OBSTACLE_LEVER_M, below_m: [0.097; 3].into_iter().collect() }
    }

    #[test]
    fn touch_turns_by_its_bend_from_start_to_end() {
        for touch in [Touch::contact(0.3, 0.3), Touch::contact(-0.3, 0.7), Touch::reaction(0.3)] {
            assert!(touch.turned_rad(0.0).abs() < 1e-12);
            assert!((touch.turned_rad(1.0) - touch.bend_rad).abs() < 1e-12);
        }
    }

    #[test]
    fn obstacle_leaves_an_arm_alone_that_bends_away() {
        let obstacle = obstacle(1.0);
        assert!(obstacle.touches(&[-0.5; SEGMENTS]).iter().all(|touch| touch.bend_rad.abs() < f64::EPSILON));
    }

    #[test]
    fn obstacle_turns_back_below_and_wraps_at_the_contact() {
        let obstacle = obstacle(-1.0);
        let touches = obstacle.touches(&[-0.5; SEGMENTS]);
        assert!(touches[0].bend_rad > 0.05 && touches[3].bend_rad < -0.1, "{touches:?}");
    }
}
