//! The fused operations of fixed point against their plain forms in floats, over the ranges that they are made for.

use std::f64::consts::PI;

use estimator_core::{Constant, FusedOps, Q, plain};
use proptest::prelude::*;

/// One unit of 2⁻²⁶.
const LSB: f64 = 1.0 / 67_108_864.0;

/// A number of any magnitude below `limit`.
fn q(limit: f64) -> impl Strategy<Value = Q> {
    (-limit..limit, 0..24).prop_map(|(value, shift)| Q::from_f64(value / f64::from(1 << shift)))
}

fn floats<const K: usize>(values: [Q; K]) -> [f64; K] {
    values.map(Q::to_f64)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    /// 2π in fixed point is half a step off, the same share of each turn; the quotient is rounded.
    #[test]
    fn share_of_unwrapped(rest in -PI..PI, turns in prop_oneof![-9..0, 1..9, -100_000..-9, 9..100_000]) {
        let rest = Q::from_f64(rest);
        let (fused, plain) = (Q::share_of_unwrapped(rest, turns), plain::share_of_unwrapped(rest.to_f64(), turns));
        prop_assert!((fused.to_f64() - plain).abs() <= 2.0 * LSB, "{fused:?} instead of {plain}");
    }

    /// Terms within ±1.875 and θ²/8 within ½, so that all sums of last terms are within ±4. Sums have 29 bits, and θ
    /// doubles what the odd one loses.
    #[test]
    fn polynomials(theta in -1.999..1.999, odd: [i16; 7], even: [i16; 7]) {
        let theta = Q::from_f64(theta);
        let [odd, even] = [odd, even].map(|terms| terms.map(|term| Q::from_f64(f64::from(term) * 15.0 / 32768.0)));
        let (fused_odd, fused_even) = theta.polynomials(&odd, &even);
        let (plain_odd, plain_even) = plain::polynomials(theta.to_f64(), &floats(odd), &floats(even));
        prop_assert!((fused_odd.to_f64() - plain_odd).abs() <= 2.0 * LSB, "{fused_odd:?} instead of {plain_odd}");
        prop_assert!((fused_even.to_f64() - plain_even).abs() <= 1.5 * LSB, "{fused_even:?} instead of {plain_even}");
    }

    /// The default is the plain form with the terms of sine and cosine, which fixed point rounds by half a 2⁻²⁹ each.
    #[test]
    fn sin_cos(theta in -1.999..1.999) {
        let theta = Q::from_f64(theta);
        let (fused, plain) = (theta.sin_cos(), theta.to_f64().sin_cos());
        prop_assert!((fused.0.to_f64() - plain.0).abs() <= 3.0 * LSB, "{fused:?} instead of {plain:?}");
        prop_assert!((fused.1.to_f64() - plain.1).abs() <= 3.0 * LSB, "{fused:?} instead of {plain:?}");
    }

    /// Rounded down.
    #[test]
    fn rotate_clockwise(x in q(22.0), y in q(22.0), angle in -PI..PI) {
        let (sin, cos) = (Q::from_f64(angle.sin()), Q::from_f64(angle.cos()));
        let fused = Q::rotate_clockwise(x, y, sin, cos);
        let plain = plain::rotate_clockwise(x.to_f64(), y.to_f64(), sin.to_f64(), cos.to_f64());
        prop_assert!((fused.0.to_f64() - plain.0).abs() <= LSB, "{fused:?} instead of {plain:?}");
        prop_assert!((fused.1.to_f64() - plain.1).abs() <= LSB, "{fused:?} instead of {plain:?}");
    }

    /// Rounded once, to nearest.
    #[test]
    fn dot(a in [q(3.2), q(3.2), q(3.2)], b in [q(3.2), q(3.2), q(3.2)]) {
        let (fused, plain) = (Q::dot(a, b), plain::dot(floats(a), floats(b)));
        prop_assert!((fused.to_f64() - plain).abs() <= 0.5 * LSB, "{fused:?} instead of {plain}");
    }

    /// Rounded down.
    #[test]
    fn mul_unchecked_range(a in q(31.9), share in -1.0..1.0_f64) {
        let b = Q::from_f64((16.0 * share / a.to_f64().abs().max(0.51)).clamp(-31.0, 31.0));
        let (fused, plain) = (a.mul_unchecked_range(b), a.to_f64() * b.to_f64());
        prop_assert!((fused.to_f64() - plain).abs() <= LSB, "{fused:?} instead of {plain}");
    }

    /// The slope is rounded down, and u multiplies that.
    #[test]
    fn eval_quadratic(value in -4095..=4095, shift in 7_u32..=12, c0 in q(8.0), c1 in q(15.0), c2 in q(0.4)) {
        const LIMIT: f64 = 6.3;
        /// The limit is checked by the upper word alone.
        const STEP: f64 = 64.0 * LSB;
        let plain = plain::eval_quadratic(value, shift, &floats([c0, c1, c2]));
        let fused = Q::eval_quadratic(value, shift, &[c0, c1, c2], Constant::new(LIMIT));
        let u = f64::from(value) / f64::from(1 << shift);
        match fused {
            Some(fused) => {
                prop_assert!((fused.to_f64() - plain).abs() <= (u.abs() + 1.0) * LSB, "{fused:?} instead of {plain}");
                prop_assert!(plain.abs() < LIMIT + STEP);
            }
            None => prop_assert!(plain.abs() > LIMIT - STEP, "no value for {plain}"),
        }
    }

    /// The divisor is rounded down by a step, and the quotient by one and its 2²⁸th part.
    #[test]
    fn gain_over_innovation_variance(p in 0.0..16.0, r in 0.0..4.0, h in 0.0..1.7, shift in 0..20) {
        let [p, r, h] = [p, r / f64::from(1 << shift), h].map(Q::from_f64);
        let divisor = r.to_f64() + p.to_f64() * h.to_f64();
        prop_assume!(divisor > 4.0 * LSB && p.to_f64() / divisor < 31.0);
        let fused = p.gain_over_innovation_variance(r, h).to_f64();
        let plain = plain::gain_over_innovation_variance(p.to_f64(), r.to_f64(), h.to_f64());
        let tolerance = 2.0 * LSB + plain * (LSB / (divisor - LSB) + 4e-9);
        prop_assert!((fused - plain).abs() <= tolerance, "{fused} instead of {plain}");
    }

    /// To the bit as the operators of fixed point, saturated differences too.
    #[test]
    fn subtract_products(values in [q(32.0), q(32.0), q(32.0)], others in [q(32.0), q(32.0), q(32.0)], factor in q(1.0)) {
        let (mut fused, mut plain) = (values, values);
        Q::subtract_products(&mut fused, &others, factor);
        plain::subtract_products(&mut plain, &others, factor);
        prop_assert_eq!(fused, plain);
    }

    /// Products that end with a half, which rounding to nearest takes up.
    #[test]
    fn subtract_products_of_halves(value in q(1.0), odd in -1000..1000_i32, shift in 0_u32..=25) {
        let (other, factor) = (Q::from_bits((2 * odd + 1) << (25 - shift)), Q::from_bits(1 << shift));
        let (mut fused, mut plain) = ([value], [value]);
        Q::subtract_products(&mut fused, &[other], factor);
        plain::subtract_products(&mut plain, &[other], factor);
        prop_assert_eq!(fused, plain);
    }

    /// To the bit as the operator, overflows and a divisor of zero too.
    #[test]
    fn divide_all(values in [q(32.0), q(32.0), q(32.0)], divisor in prop_oneof![q(32.0), Just(Q::from_bits(0))]) {
        let (mut fused, mut plain) = (values, values);
        Q::divide_all(&mut fused, divisor);
        plain::divide_all(&mut plain, divisor);
        prop_assert_eq!(fused, plain);
    }

    /// The innovation is rounded down, and the ratio multiplies that.
    #[test]
    fn kalman_update(
        x in [q(3.0), q(3.0)], ratio in 0.0..2.0, weights in [q(1.5), q(1.5), q(1.5)], a in [q(3.0), q(3.0)], b in [q(3.0), q(3.0)],
    ) {
        let ratio = Q::from_f64(ratio);
        let fused = Q::kalman_update(x, ratio, &weights, [a, b]);
        for (k, fused) in fused.into_iter().enumerate() {
            let [x, a, b] = floats([x[k], a[k], b[k]]);
            let plain = plain::kalman_update(x, ratio.to_f64(), &floats(weights), a, b);
            prop_assert!((fused.to_f64() - plain).abs() <= (ratio.to_f64() + 1.0) * LSB, "{fused:?} instead of {plain}");
        }
    }
}
