//! The arm's true centreline: curvature that is not constant along a segment, integrated.
//!
//! Along a curve of length L the heading rises by φ(ξ), ξ = s/L from 0 to 1:
//!
//! φ = θ (ξ + m₁ (ξ² − ξ) + m₂ (2ξ³ − 3ξ² + ξ)) + Σ touch · B((ξ − ξ_c)/w)
//!
//! m₁ and m₂ multiply the first two Legendre polynomials of the curvature; B is the integral of a biweight kernel.

use crate::arm::CurveParameters;
use crate::constants::{FULL_SCALE_PA, SIMPSON_INTERVALS};
use crate::contact::Touch;
use crate::layout::PerSegment;
use crate::pose::EndPose;

/// One segment's curve at one moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curve {
    parameters: CurveParameters,
    pub(crate) free_rad: f64,
    pub(crate) touch: Touch,
    pub(crate) stretch: f64,
}

impl Curve {
    /// At rest and untouched.
    pub(crate) fn new(parameters: CurveParameters) -> Self {
        Self { parameters, free_rad: parameters.rest_bend_rad, touch: Touch::NONE, stretch: 0.0 }
    }

    /// Bends as the actuator does, `touch` added, under the pressures of its module.
    pub(crate) fn bend(&mut self, actuator_rad: f64, touch: Touch, [right_pa, left_pa]: [f64; 2]) {
        self.free_rad = actuator_rad + self.parameters.rest_bend_rad;
        self.touch = touch;
        self.stretch = self.parameters.stretch_at_full_pressure * (right_pa + left_pa) / (2.0 * FULL_SCALE_PA);
    }

    /// Angle of the tangent relative to the start, at the share `along` of the curve, rad.
    pub(crate) fn turned_rad(&self, along: f64) -> f64 {
        let slope = along * (along - 1.0);
        let bulge = along * (1.0 + along * (2.0 * along - 3.0));
        self.free_rad * (along + self.parameters.slope * slope + self.parameters.bulge * bulge)
            + self.touch.turned_rad(along)
    }

    /// End of the segment that starts at `start`, its connector included.
    fn end(&self, start: EndPose) -> EndPose {
        let CurveParameters { length_m, connector_m, connector_first, .. } = self.parameters;
        let start = if connector_first { start.ahead(connector_m) } else { start };
        let (mut x, mut y) = (0.0, 0.0);
        for node in 0..=SIMPSON_INTERVALS {
            let weight = match node {
                0 | SIMPSON_INTERVALS => 1.0,
                n if n % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let along = node as f64 / SIMPSON_INTERVALS as f64;
            let (sin, cos) = libm::sincos(start.heading_rad + self.turned_rad(along));
            x += weight * sin;
            y += weight * cos;
        }
        let scale = length_m * (1.0 + self.stretch) / (3 * SIMPSON_INTERVALS) as f64;
        let end = EndPose {
            x_m: start.x_m + scale * x,
            y_m: start.y_m + scale * y,
            heading_rad: start.heading_rad + self.turned_rad(1.0),
        };
        if connector_first { end } else { end.ahead(connector_m) }
    }
}

/// Poses of all segments' ends, the base at the origin.
pub(crate) fn poses(curves: &[Curve]) -> PerSegment<EndPose> {
    let mut end = EndPose::default();
    let poses = curves.iter().map(|curve| {
        end = curve.end(end);
        end
    });
    poses.collect()
}

#[cfg(test)]
mod tests {
    use super::{Curve, CurveParameters, EndPose, poses};
    use crate::constants::{CONNECTOR_LENGTH_M, CURVE_LENGTH_M, SEGMENTS};

    fn uniform(bend_rad: f64, connector_first: bool) -> Curve {
        let parameters = CurveParameters {
            length_m: CURVE_LENGTH_M,
            connector_m: CONNECTOR_LENGTH_M,
            connector_first,
            slope: 0.0,
            bulge: 0.0,
            rest_bend_rad: 0.0,
            stretch_at_full_pressure: 0.0,
        };
        Curve { free_rad: bend_rad, ..Curve::new(parameters) }
    }

    #[test]
    fn constant_curvature_ends_on_its_circle() {
        let bend = 1.2_f64;
        let end = uniform(bend, false).end(EndPose::default());
        let x = CURVE_LENGTH_M / bend * (1.0 - bend.cos()) + CONNECTOR_LENGTH_M * bend.sin();
        let y = CURVE_LENGTH_M / bend * bend.sin() + CONNECTOR_LENGTH_M * bend.cos();
        assert!((end.x_m - x).abs() < 1e-6 && (end.y_m - y).abs() < 1e-6, "{end:?} instead of {x}, {y}");
    }

    #[test]
    fn connector_that_precedes_the_curve_does_not_turn() {
        let bend = 1.2_f64;
        let end = uniform(bend, true).end(EndPose::default());
        let y = CURVE_LENGTH_M / bend * bend.sin() + CONNECTOR_LENGTH_M;
        assert!((end.y_m - y).abs() < 1e-6, "{} m instead of {y} m", end.y_m);
    }

    #[test]
    fn straight_arm_has_its_full_length() {
        let tip = poses(&[uniform(0.0, false); SEGMENTS])[SEGMENTS - 1];
        assert!((tip.y_m - 0.582).abs() < 1e-12 && tip.x_m.abs() < 1e-12, "{tip:?}");
    }

    #[test]
    fn clockwise_bend_goes_right() {
        let tip = poses(&[uniform(0.1, false); SEGMENTS])[SEGMENTS - 1];
        assert!(tip.x_m > 0.1 && (tip.heading_rad - 0.6).abs() < 1e-12, "{tip:?}");
    }
}
