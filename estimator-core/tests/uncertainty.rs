//! The covariance along the chain against its derivatives by finite differences, and in fixed point against floats.

use estimator_core::{Angle, CovariancePropagation, OffsetAt, Pcc, Q, Scalar, SegmentConfig, VARIANCE_SCALE, chain};
use nalgebra::Vector2;

const BENDS: [f64; 6] = [0.3, -0.5, 0.8, 0.4, -0.2, 0.6];
/// Deviations of the bend angles, rad.
const DEVIATIONS: [f64; 6] = [0.01, 0.02, 0.005, 0.01, 0.03, 0.01];
/// Deviation of each heading by itself, rad.
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

/// Deviations of each end along x and y, mm, and their correlation.
fn spread<S: Scalar>() -> Vec<[f64; 3]> {
    let [heading, point] = [HEADING, POINT].map(|deviation| S::from_f64(deviation.powi(2) * VARIANCE_SCALE));
    let mut spread = CovariancePropagation::<S>::base(heading, point);
    let mut before = Vector2::zeros();
    let of = |(i, end): (usize, Vector2<f64>)| {
        let chord: Vector2<f64> = end - before;
        before = end;
        let lever = if i % 2 == 0 { 57.0 / 97.0 } else { 40.0 / 97.0 };
        let [lever, theta] = [lever, DEVIATIONS[i].powi(2) * VARIANCE_SCALE].map(<S as Scalar>::from_f64);
        spread.step(chord.map(<S as Scalar>::from_f64), lever, theta);
        deviations(spread.end().square_metres())
    };
    ends(&BENDS).into_iter().enumerate().map(of).collect()
}

fn deviations([xx, xy, yy]: [f64; 3]) -> [f64; 3] {
    [xx.sqrt() * 1e3, yy.sqrt() * 1e3, xy / (xx * yy).sqrt()]
}

#[test]
fn the_covariance_is_that_of_the_chain_s_derivatives() {
    let mut sums = [[0.0; 3]; 6];
    for (k, deviation) in DEVIATIONS.iter().enumerate() {
        let shifted = |by: f64| ends(&core::array::from_fn::<f64, 6, _>(|i| BENDS[i] + if i == k { by } else { 0.0 }));
        for (sum, (above, below)) in sums.iter_mut().zip(shifted(1e-5).into_iter().zip(shifted(-1e-5))) {
            let d = (above - below) / 2e-5 * *deviation;
            *sum = [sum[0] + d.x * d.x, sum[1] + d.x * d.y, sum[2] + d.y * d.y];
        }
    }
    let chord = |i: usize| ends(&BENDS)[i] - if i == 0 { Vector2::zeros() } else { ends(&BENDS)[i - 1] };
    for (i, (found, mut sum)) in spread::<f64>().into_iter().zip(sums).enumerate() {
        // A heading's own error turns one chord.
        for turn in (0..=i).map(|k| chord(k) * HEADING) {
            sum = [sum[0] + turn.y * turn.y, sum[1] - turn.x * turn.y, sum[2] + turn.x * turn.x];
        }
        let points = (i + 1) as f64 * POINT * POINT;
        let expected = deviations([sum[0] + points, sum[1], sum[2] + points]);
        // The lever is that of a slightly bent arc.
        assert!((found[0] / expected[0] - 1.0).abs() < 0.02, "end {i}: {found:?} instead of {expected:?}");
        assert!((found[1] / expected[1] - 1.0).abs() < 0.02, "end {i}: {found:?} instead of {expected:?}");
        assert!((found[2] - expected[2]).abs() < 0.05, "end {i}: {found:?} instead of {expected:?}");
    }
}

#[test]
fn fixed_point_is_as_good_as_floats() {
    for (q, f) in spread::<Q>().into_iter().zip(spread::<f64>()) {
        for (q, f) in q.into_iter().zip(f) {
            assert!((q - f).abs() < 0.002, "{q} instead of {f}");
        }
    }
}
