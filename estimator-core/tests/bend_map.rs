//! Curves as V–Orient maps.

use estimator_core::{BendMap, CurveMap, FusedOps, Q, VOLTS_PER_COUNT};
use proptest::prelude::*;

/// A sensor that saturates: 33 angles over 0.8 V to 2.4 V.
const VOLTS: [f64; 2] = [0.8, 2.4];

fn curve_at(share: f64) -> f64 {
    (3.0 * (share - 0.5)).tanh()
}

fn angles() -> Vec<f64> {
    (0..33).map(|k| curve_at(f64::from(k) / 32.0)).collect()
}

fn map<S: FusedOps>() -> BendMap<S> {
    BendMap::Curve(CurveMap::from_volts(&angles(), VOLTS))
}

fn counts(volts: f64) -> u16 {
    (volts / VOLTS_PER_COUNT).round() as u16
}

fn share(counts: u16) -> f64 {
    (f64::from(counts) * VOLTS_PER_COUNT - VOLTS[0]) / (VOLTS[1] - VOLTS[0])
}

proptest! {
    /// Twice piecewise linear: the curve bends by up to 7 rad per square of the range, so 33 points lose 7/8 of the square
    /// of a 32nd, and the knots, 64 of 1985 counts apart, 7/8 of that square: 0.0018 rad.
    #[test]
    fn inside_it_is_the_curve(volts in 0.81..2.39) {
        let counts = counts(volts);
        let angle = map::<f64>().angle(counts).expect("a reading");
        prop_assert!((angle - curve_at(share(counts))).abs() < 0.0018);
    }

    /// A knot and a product are rounded by half a step each.
    #[test]
    fn fixed_point_is_within_two_steps_of_floats(counts in 0_u16..=4095) {
        let (float, fixed) = (map::<f64>().angle(counts), map::<Q>().angle(counts));
        prop_assert_eq!(float.is_some(), fixed.is_some());
        if let (Some(float), Some(fixed)) = (float, fixed) {
            prop_assert!((fixed.to_f64() - float).abs() <= 2.0 / 67_108_864.0);
        }
    }

    #[test]
    fn it_never_steps(counts in 0_u16..4095) {
        if let (Some(here), Some(next)) = (map::<f64>().angle(counts), map::<f64>().angle(counts + 1)) {
            // At most 3 rad over the range of 1985 counts.
            prop_assert!((next - here).abs() < 3.1 / 1985.0, "from {} to {}", here, next);
        }
    }

    #[test]
    fn any_curve_and_range_are_survived(
        angles in prop::collection::vec(-10.0..10.0_f64, 2..80), lo in 0.0..3.2, width in 0.01..3.3, counts: u16,
    ) {
        let map = BendMap::Curve(CurveMap::<Q>::from_volts(&angles, [lo, lo + width]));
        let _ = (map.angle(counts), map.is_extrapolated(counts));
    }
}

/// The slope of the outer eighth: four of 32 intervals.
#[test]
fn outside_it_goes_on_as_a_straight_line() {
    let angles = angles();
    let slope = (angles[32] - angles[28]) / (4.0 / 32.0);
    for volts in [2.45, 2.6, 2.75] {
        let counts = counts(volts);
        let expected = angles[32] + slope * (share(counts) - 1.0);
        let angle = map::<f64>().angle(counts).expect("a quarter of the range is read");
        assert!((angle - expected).abs() < 2e-3, "{angle} instead of {expected} at {volts} V");
    }
    let slope = (angles[4] - angles[0]) / (4.0 / 32.0);
    let counts = counts(0.5);
    let angle = map::<f64>().angle(counts).expect("a quarter of the range is read");
    assert!((angle - (angles[0] + slope * share(counts))).abs() < 2e-3);
}

#[test]
fn what_the_calibration_has_not_seen_is_extrapolated() {
    let map = map::<Q>();
    let known = [0.7, 0.79, 0.81, 2.39, 2.41].map(|volts| map.is_extrapolated(counts(volts)));
    assert_eq!(known, [true, true, false, false, true]);
}

#[test]
fn beyond_a_quarter_of_the_range_there_is_no_reading() {
    let map = map::<Q>();
    assert!(map.angle(counts(0.41)).is_some() && map.angle(counts(2.79)).is_some());
    assert_eq!([0.39, 2.81].map(|volts| map.angle(counts(volts))), [None, None]);
}

/// A curve over the whole range of the ADC: an open or shorted sensor reads one of its ends.
#[test]
fn the_rails_are_no_reading() {
    let map = BendMap::Curve(CurveMap::<Q>::from_volts(&[-1.0, 1.0], [0.0, 3.3]));
    assert!((0..=10).chain(4085..=4095).chain([u16::MAX]).all(|counts| map.angle(counts).is_none()));
    assert!((11..4085).all(|counts| map.angle(counts).is_some()));
}
