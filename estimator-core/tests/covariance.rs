//! The covariance along the chain against J P Jᵀ, with the Jacobian J by finite differences and by levers in floats.

use estimator_core::{
    Angle, CovariancePropagation, OffsetAt, Pcc, Q, SegmentConfig, VARIANCE_SCALE, forward_kinematics, lever_arm,
};
use nalgebra::{Matrix2, Matrix2x6, Matrix6, Vector2};

const BENDS: [f64; 6] = [0.3, -0.5, 0.8, 0.4, -0.2, 0.6];
/// Deviations of the bend angles, rad.
const DEVIATIONS: [f64; 6] = [0.01, 0.02, 0.005, 0.01, 0.03, 0.01];
/// Deviation of each heading's own error, rad.
const HEADING: f64 = 0.01;
/// Deviation of each end, m.
const POINT: f64 = 0.001;

/// The reference arm: connectors behind and before the curves in turn.
fn segments() -> [SegmentConfig<f64>; 6] {
    core::array::from_fn(|i| SegmentConfig {
        offset_at: if i % 2 == 0 { OffsetAt::End } else { OffsetAt::Start },
        ..SegmentConfig::uncalibrated(0.080, 0.017)
    })
}

/// World points of all ends.
fn ends(bends: &[f64]) -> Vec<Vector2<f64>> {
    let links = segments().into_iter().zip(bends.to_vec());
    let links = links.map(|(segment, bend)| Some(Pcc::new(&segment).link(Angle::from(bend))));
    forward_kinematics(links).map(|segment| segment.end.expect("all links are known")).collect()
}

/// Chords of all segments in {W}.
fn chords() -> Vec<Vector2<f64>> {
    let ends = ends(&BENDS);
    (0..6).map(|i| ends[i] - if i == 0 { Vector2::zeros() } else { ends[i - 1] }).collect()
}

/// P of the headings, rad²: independent errors of the bend angles add up, and each heading has its own.
fn heading_covariance() -> Matrix6<f64> {
    Matrix6::from_fn(|i, j| {
        let common: f64 = DEVIATIONS[..=i.min(j)].iter().map(|deviation| deviation * deviation).sum();
        common + if i == j { HEADING * HEADING } else { 0.0 }
    })
}

/// Deviations of each end along x and y, mm, and their correlation, as the crate propagates them.
fn propagated() -> Vec<[f64; 3]> {
    let scaled = |variance: f64| Q::from_f64(variance * VARIANCE_SCALE);
    let headings = heading_covariance();
    let mut propagation = CovariancePropagation::<6>::new();
    let step = |(i, (chord, segment)): (usize, (Vector2<f64>, SegmentConfig<f64>))| {
        let headings = core::array::from_fn(|j| scaled(headings[(i, j)]));
        propagation.step(&headings, chord.map(Q::from_f64), lever_arm(&segment), scaled(POINT * POINT));
        let [xx, xy, yy] = propagation.end().square_metres();
        deviations(Matrix2::new(xx, xy, xy, yy))
    };
    chords().into_iter().zip(segments()).enumerate().map(step).collect()
}

fn deviations(covariance: Matrix2<f64>) -> [f64; 3] {
    let [xx, xy, yy] = [covariance.m11, covariance.m12, covariance.m22];
    [xx.sqrt() * 1e3, yy.sqrt() * 1e3, xy / (xx * yy).sqrt()]
}

/// Of each end J P Jᵀ, for its derivatives by the headings before it, and what the ends add.
fn expected(jacobian: impl Fn(usize, usize) -> Vector2<f64>) -> Vec<[f64; 3]> {
    let of_end = |i: usize| {
        let jacobian = Matrix2x6::from_columns(&core::array::from_fn::<_, 6, _>(|j| jacobian(i, j)));
        let points = Matrix2::identity() * ((i + 1) as f64 * POINT * POINT);
        deviations(jacobian * heading_covariance() * jacobian.transpose() + points)
    };
    (0..6).map(of_end).collect()
}

#[test]
fn the_covariance_is_that_of_the_chain_s_derivatives() {
    // A heading is more of its own bend angle and less of the next.
    let shifted = |j: usize, by: f64| {
        let mut bends = BENDS;
        bends[j] += by;
        if let Some(next) = bends.get_mut(j + 1) {
            *next -= by;
        }
        ends(&bends)
    };
    let derivatives: Vec<Vec<_>> = (0..6)
        .map(|j| shifted(j, 1e-5).iter().zip(shifted(j, -1e-5)).map(|(above, below)| (above - below) / 2e-5).collect())
        .collect();
    for (i, (found, expected)) in propagated().into_iter().zip(expected(|i, j| derivatives[j][i])).enumerate() {
        // The lever is that of a slightly bent arc.
        assert!((found[0] / expected[0] - 1.0).abs() < 0.02, "end {i}: {found:?} instead of {expected:?}");
        assert!((found[1] / expected[1] - 1.0).abs() < 0.02, "end {i}: {found:?} instead of {expected:?}");
        assert!((found[2] - expected[2]).abs() < 0.05, "end {i}: {found:?} instead of {expected:?}");
    }
}

#[test]
fn fixed_point_is_as_good_as_floats() {
    let chords = chords();
    let turned = |i: usize, share: f64| Vector2::new(chords[i].y, -chords[i].x) * share;
    let lever = |i: usize| if i.is_multiple_of(2) { 57.0 / 97.0 } else { 40.0 / 97.0 };
    let levered = |i: usize, j: usize| {
        let own = if j <= i { turned(j, lever(j)) } else { Vector2::zeros() };
        let next = if j < i { turned(j + 1, 1.0 - lever(j + 1)) } else { Vector2::zeros() };
        own + next
    };
    for (q, f) in propagated().into_iter().zip(expected(levered)) {
        for (q, f) in q.into_iter().zip(f) {
            assert!((q - f).abs() < 0.002, "{q} instead of {f}");
        }
    }
}
