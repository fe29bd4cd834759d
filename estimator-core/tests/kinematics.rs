//! PCC kinematics against sines and cosines of the standard library.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI, TAU};

use estimator_core::{
    Angle, FusedOps, OffsetAt, Pcc, Q, SegmentConfig, SegmentPose, Turns, UnitArc, forward_kinematics,
};
use nalgebra::Vector2;
use proptest::prelude::*;

/// The polynomial of (1 − cos θ)/θ² errs by 2.2e-11; sine and cosine multiply that by θ² ≤ 4, and the double angle
/// once more by up to π/2.
const FLOAT_ERROR: f64 = 2e-10;
/// One step of Q.
const LSB: f64 = 1.0 / 67_108_864.0;
/// Some ten roundings up to 1.5 rad.
const FIXED_ERROR: f64 = 4.0 * LSB;
/// Beyond, the polynomials' terms add up and θ multiplies them; swept over ±1000 rad, the worst are 15.3 steps at π.
const FIXED_ERROR_FAR: f64 = 16.0 * LSB;

fn numbers<S: FusedOps>(arc: UnitArc<S>) -> [f64; 4] {
    [arc.lateral, arc.axial, arc.cos, arc.sin].map(S::to_f64)
}

/// Lateral, axial, cosine and sine of a unit arc, by the formula.
fn formula(theta: f64) -> [f64; 4] {
    let (sin, cos) = theta.sin_cos();
    if theta.abs() < 1e-5 { [theta / 2.0, 1.0, cos, sin] } else { [(1.0 - cos) / theta, sin / theta, cos, sin] }
}

fn differ(one: [f64; 4], other: [f64; 4]) -> f64 {
    one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// θ on both sides of a seam, so close that the arc itself changes by less than `LSB`.
fn step_across<S: FusedOps>(seam: f64) -> f64 {
    let sides = [-LSB / 2.0, LSB].map(|off| numbers(UnitArc::new(Angle::from(S::from_f64(seam + off)))));
    differ(sides[0], sides[1])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn a_float_arc_is_the_formula_up_to_1000_rad(rad in prop_oneof![-2.0..2.0, -7.0..7.0, -1000.0..1000.0]) {
        let turns = Turns::from_rad(rad);
        let error = differ(numbers(UnitArc::<f64>::new(Angle::from(turns))), formula(turns.rad()));
        prop_assert!(error <= FLOAT_ERROR, "{} at {} rad", error, rad);
    }

    #[test]
    fn a_fixed_point_arc_is_the_formula_up_to_1000_rad(rad in prop_oneof![-1.5..1.5, -7.0..7.0, -1000.0..1000.0]) {
        let turns = Turns::from_rad(rad);
        let error = differ(numbers(UnitArc::<Q>::new(Angle::from(turns))), formula(turns.rad()));
        prop_assert!(error <= if rad.abs() <= 1.5 { FIXED_ERROR } else { FIXED_ERROR_FAR }, "{} at {} rad", error, rad);
    }

    /// A bend sensor may read any angle without turns.
    #[test]
    fn an_angle_without_turns_is_reduced(rad in -31.9..31.9_f64) {
        let float = UnitArc::<f64>::new(Angle::from(rad));
        prop_assert!(differ(numbers(float), formula(rad)) <= FLOAT_ERROR);
        let rounded = Q::from_f64(rad);
        let error = differ(numbers(UnitArc::new(Angle::from(rounded))), formula(rounded.to_f64()));
        prop_assert!(error <= FIXED_ERROR_FAR, "{} at {} rad", error, rad);
    }

    #[test]
    fn arcs_to_the_left_mirror_arcs_to_the_right(rad in -9.0..9.0_f64) {
        let [lateral, axial, cos, sin] = numbers(UnitArc::<f64>::new(Angle::from(rad)));
        let mirrored = numbers(UnitArc::<f64>::new(Angle::from(-rad)));
        prop_assert_eq!(mirrored.map(f64::to_bits), [-lateral, axial, cos, -sin].map(f64::to_bits));
    }

    #[test]
    fn a_straight_arm_is_as_long_as_its_parts(parts in prop::collection::vec((0.01..0.2, 0.0..0.05, any::<bool>()), 1..=16)) {
        let segments: Vec<_> = parts.iter().map(|&(length, offset, start)| segment::<Q>(length, offset, start)).collect();
        let straight = segments.iter().map(|segment| Some(link(Q::from_bits(0), segment)));
        let tip = forward_kinematics(straight).last().and_then(|segment| segment.end).expect("all links are known");
        let length = segments.iter().fold(Q::from_bits(0), |sum, segment| sum + segment.length + segment.offset);
        prop_assert_eq!(tip, Vector2::new(Q::from_bits(0), length));
    }

    /// P_W,i = P_W,i−1 + R(Θ_i−1) P_i by cumulated headings. 16 arcs of up to 0.2 m err by 2e-10 each, and each error
    /// in a direction turns all that follows.
    #[test]
    fn a_chain_is_the_sum_of_rotated_links(links in prop::collection::vec((0.01..0.2, 0.0..0.05, any::<bool>(), -3.0..3.0_f64), 1..=16)) {
        let link = |&(length, offset, start, theta)| Some(link::<f64>(theta, &segment(length, offset, start)));
        let ends: Vec<_> = forward_kinematics(links.iter().map(link)).map(|segment| segment.end).collect();
        let (mut heading, mut x, mut y) = (0.0_f64, 0.0, 0.0);
        for (end, &(length, offset, start, theta)) in ends.iter().zip(&links) {
            let [lateral, axial, cos, sin] = formula(theta);
            let [dx, dy] = if start { [0.0, offset] } else { [offset * sin, offset * cos] };
            let [px, py] = [length * lateral + dx, length * axial + dy];
            x += px * heading.cos() + py * heading.sin();
            y += -px * heading.sin() + py * heading.cos();
            heading += theta;
            let end = end.expect("all links are known");
            prop_assert!((end.x - x).hypot(end.y - y) <= 16.0 * 0.25 * 16.0 * FLOAT_ERROR);
        }
    }

    /// The polynomials of a link add up those of its arc, whose errors they share.
    #[test]
    fn a_float_link_is_the_formula(rad in prop_oneof![-2.1..2.1, -7.0..7.0], parts in parts()) {
        let error = (link(rad, &segment::<f64>(parts.0, parts.1, parts.2)).end - end_by_formula(rad, parts)).norm();
        prop_assert!(error <= (parts.0 + parts.1) * 2.0 * FLOAT_ERROR, "{} m at {} rad", error, rad);
    }

    /// Lengths are rounded to half a step, and θ too.
    #[test]
    fn a_fixed_point_link_is_the_formula(rad in prop_oneof![-2.1..2.1, -7.0..7.0], parts in parts()) {
        let end = link(Q::from_f64(rad), &segment(parts.0, parts.1, parts.2)).end.map(Q::to_f64);
        let error = (end - end_by_formula(Q::from_f64(rad).to_f64(), parts)).norm();
        let scale = if parts.0 + parts.1 < 0.5 { 1.0 } else { parts.0 + parts.1 };
        prop_assert!(error <= 2.0 * scale * FIXED_ERROR_FAR, "{} m at {} rad", error, rad);
    }
}

/// Length, offset and its side, for a segment of the usual size or one too long for polynomials.
fn parts() -> impl Strategy<Value = (f64, f64, bool)> {
    prop_oneof![(0.01..0.3, 0.0..0.1, any::<bool>()), (0.5..2.0, 0.0..2.0, any::<bool>())]
}

/// P_i in {S_i}.
fn end_by_formula(theta: f64, (length, offset, start): (f64, f64, bool)) -> Vector2<f64> {
    let [lateral, axial, cos, sin] = formula(theta);
    let connector = if start { Vector2::new(0.0, offset) } else { Vector2::new(offset * sin, offset * cos) };
    Vector2::new(length * lateral, length * axial) + connector
}

fn link<S: FusedOps>(theta: S, segment: &SegmentConfig<S>) -> SegmentPose<S> {
    Pcc::new(segment).link(Angle::from(theta))
}

fn segment<S: FusedOps>(length: f64, offset: f64, start: bool) -> SegmentConfig<S> {
    let offset_at = if start { OffsetAt::Start } else { OffsetAt::End };
    SegmentConfig { offset_at, ..SegmentConfig::uncalibrated(length, offset) }
}

#[test]
fn a_float_arc_does_not_step_at_its_seams() {
    for seam in [0.0, 2.0, -2.0, PI, -PI, TAU, -TAU, 3.0 * PI, 4.0 * PI] {
        let step = step_across::<f64>(seam);
        assert!(step <= 1.5 * LSB + FLOAT_ERROR, "a step of {step} at {seam} rad");
    }
}

/// Each side is rounded independently.
#[test]
fn a_fixed_point_arc_does_not_step_at_its_seams() {
    for seam in [0.0, 2.0, -2.0, PI, -PI, TAU, -TAU, 3.0 * PI, 4.0 * PI] {
        let step = step_across::<Q>(seam);
        assert!(step <= 2.0 * LSB + FIXED_ERROR, "a step of {step} at {seam} rad");
    }
}

#[test]
fn whole_turns_beside_the_remainder_join_where_it_wraps() {
    for turns in [-1000, -1, 0, 5, 1000] {
        let below = UnitArc::new(Angle { remainder: Q::from_f64(PI - 1e-8), whole_turns: turns });
        let above = UnitArc::new(Angle { remainder: Q::from_f64(1e-8 - PI), whole_turns: turns + 1 });
        let step = differ(numbers(below), numbers(above));
        assert!(step <= 2.0 * LSB + FIXED_ERROR, "a step of {step} after {turns} turns");
    }
}

#[test]
fn a_vanishing_arc_is_exact() {
    for bits in -3..=3 {
        let arc = UnitArc::new(Angle::from(Q::from_bits(bits)));
        assert_eq!((arc.axial.to_f64(), arc.cos.to_f64(), arc.sin.to_bits()), (1.0, 1.0, bits));
        assert!((arc.lateral.to_f64() - f64::from(bits) * LSB / 2.0).abs() <= LSB / 2.0);
    }
    for theta in [1e-300, 1e-12, 1e-8] {
        let arc = UnitArc::new(Angle::from(theta));
        assert!((arc.lateral / theta - 0.5).abs() < 1e-10 && (arc.axial - 1.0).abs() < 1e-10);
    }
}

/// Each side is rounded independently.
#[test]
fn a_link_does_not_step_where_its_polynomials_end() {
    let sides = |seam: f64| [seam - LSB, seam, seam + LSB];
    for segment in [segment::<Q>(0.1, 0.02, false), segment(0.1, 0.02, true)] {
        for ends in
            [2.0, -2.0].map(|seam| sides(seam).map(|theta| link(Q::from_f64(theta), &segment).end.map(Q::to_f64)))
        {
            assert!((ends[1] - ends[0]).norm() <= 2.0 * LSB + FIXED_ERROR);
            assert!((ends[2] - ends[1]).norm() <= 2.0 * LSB + FIXED_ERROR);
        }
    }
}

/// End of a segment that is bent by a quarter turn, and chord of a straight segment of 1 m that follows it, m.
fn quarter_turn(start: bool) -> [Vector2<f64>; 2] {
    let links = [link(FRAC_PI_2, &segment(0.1, 0.02, start)), link(0.0, &segment(1.0, 0.0, false))];
    let ends: Vec<_> =
        forward_kinematics(links.into_iter().map(Some)).map(|segment| segment.end.expect("all is known")).collect();
    [ends[0], ends[1] - ends[0]]
}

/// A quarter turn of 0.1 m ends 2/π of it to the right and ahead; its tangent then is the x axis.
#[test]
fn a_connector_at_the_end_follows_the_curves_tangent() {
    let [end, tangent] = quarter_turn(false);
    let curve = 0.1 * FRAC_2_PI;
    assert!((end - Vector2::new(curve + 0.02, curve)).norm() < FLOAT_ERROR);
    assert!((tangent - Vector2::new(1.0, 0.0)).norm() < FLOAT_ERROR);
}

#[test]
fn a_connector_at_the_start_keeps_the_bases_tangent() {
    let [end, tangent] = quarter_turn(true);
    let curve = 0.1 * FRAC_2_PI;
    assert!((end - Vector2::new(curve, curve + 0.02)).norm() < FLOAT_ERROR);
    assert!((tangent - Vector2::new(1.0, 0.0)).norm() < FLOAT_ERROR);
}

#[test]
fn beyond_an_unknown_link_every_end_is_unknown() {
    let link = |theta: f64| Some(link(theta, &segment(0.1, 0.0, false)));
    let links = [link(0.1), link(0.2), None, link(0.3)];
    let known: Vec<_> = forward_kinematics(links.into_iter()).map(|segment| segment.end.is_some()).collect();
    assert_eq!(known, [true, true, false, false]);
}
