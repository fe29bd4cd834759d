//! Minimax polynomials in θ² for sin θ / θ, (1 − cos θ) / θ² and cos θ, |θ| ≤ 2 rad.

use crate::numeric::scalar::Constant;

/// Terms of a polynomial in θ²/8, multiplied by 8 for [`FusedOps::polynomials`](crate::FusedOps::polynomials).
pub(crate) type Terms<T> = [T; 7];

/// sin θ / θ.
pub(crate) const AXIAL: Terms<Constant> = eightfold([
    0.999_999_999_998_558,
    -0.666_666_666_525_055_1,
    0.133_333_331_062_445_16,
    -0.012_698_399_036_356_584,
    7.054_281_954_497_206e-4,
    -2.559_557_300_796_330_8e-5,
    6.152_922_495_571_073e-7,
]);

/// (1 − cos θ) / θ².
pub(crate) const VERSINE: Terms<Constant> = eightfold([
    0.499_999_999_978_359_6,
    -0.166_666_665_104_189_15,
    0.022_222_203_937_815_63,
    -0.001_587_223_271_061_236,
    7.039_481_349_596_013e-5,
    -2.001_239_275_599_844e-6,
    0.0,
]);

/// cos θ = 1 − θ² (1 − cos θ) / θ².
pub(crate) const COSINE: Terms<Constant> = {
    let mut terms = [Constant::new(8.0); 7];
    let mut k = 1;
    while k < terms.len() {
        terms[k] = Constant::new(-8.0 * VERSINE[k - 1].value);
        k += 1;
    }
    terms
};

/// Converts terms of a polynomial in θ²/4.
const fn eightfold(terms: Terms<f64>) -> Terms<Constant> {
    let mut constants = [Constant::new(0.0); 7];
    let mut k = 0;
    while k < terms.len() {
        constants[k] = Constant::new((8_u32 << k) as f64 * terms[k]);
        k += 1;
    }
    constants
}
