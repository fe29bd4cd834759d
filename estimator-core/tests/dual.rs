//! Dual numbers through the same pipeline: what tuning will need of the scalar trait.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use estimator_core::{
    BendMap, Constant, Estimator, ImuReading, Method, Noise, Phase, Sample, Scalar, Segment, Table, Turns,
};
use num_dual::Dual64;
use num_traits::{One, Zero};

/// A float and its derivative by one parameter.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
struct Dual(Dual64);

macro_rules! operators {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident),*) => {$(
        impl $operator for Dual {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
        impl $assign for Dual {
            fn $assign_method(&mut self, other: Self) {
                self.0.$assign_method(other.0);
            }
        }
    )*};
}
operators!(Add add AddAssign add_assign, Sub sub SubAssign sub_assign, Mul mul MulAssign mul_assign);

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Zero for Dual {
    fn zero() -> Self {
        Self(Dual64::zero())
    }
    fn is_zero(&self) -> bool {
        self.0.is_zero()
    }
}

impl One for Dual {
    fn one() -> Self {
        Self(Dual64::one())
    }
}

impl Scalar for Dual {
    fn constant(constant: Constant) -> Self {
        Self::from_f64(constant.value)
    }
    fn from_f64(value: f64) -> Self {
        Self(Dual64::from_re(value))
    }
    fn to_f64(self) -> f64 {
        self.0.re
    }
    fn from_int(value: i32) -> Self {
        Self::from_f64(f64::from(value))
    }
    fn from_fraction(value: i32, shift: u32) -> Self {
        Self::from_f64(f64::from_fraction(value, shift))
    }
    fn round(self) -> i32 {
        Scalar::round(self.0.re)
    }
    fn from_phase(phase: Phase) -> Self {
        Self::from_f64(phase.rad())
    }
    fn to_turns(self) -> Turns {
        Turns::from_rad(self.0.re)
    }
}

/// Fusion's tip after two seconds of bending, for filters with this R_imu.
fn tip<S: Scalar>(r_imu: S) -> [S; 2] {
    let one = S::one();
    let noise = Noise { q: S::from_f64(0.2), r_imu, r_bend: one, h_imu: one, h_bend: one };
    let map = BendMap::from_volts(0.1, 1.2, -2.0, [0.5, 2.5]);
    let segment = Segment { bend: [Some(map); 2], orient: noise, coord: noise, ..Segment::bare(0.080, 0.017) };
    let segments = [segment; 3];
    let table = Table::bare(&segments);
    let mut estimator = Estimator::<S, 3, 100>::new(&table).expect("a valid table");
    let mut ends = [S::zero(); 2];
    for k in 0..20_u16 {
        let mut sample = Sample::missing(u64::from(k) * 100_000);
        for i in 0..3 {
            sample.bend[i] = [Some(1800 + 10 * k), Some(1850 + 9 * k)];
            sample.imu[i] = Some(ImuReading::Heading(Phase::from_degrees(f64::from(k) * (i + 1) as f64)));
        }
        let estimate = estimator.step(&sample);
        let end = estimator.shape(&estimate, Method::Fusion)[2].end.expect("the filters have begun");
        ends = [end.x, end.y];
    }
    ends
}

#[test]
fn a_derivative_through_the_pipeline_is_that_of_finite_differences() {
    let (r_imu, h) = (0.3, 1e-5);
    let exact = tip(Dual(Dual64::new(r_imu, 1.0)));
    let (above, below) = (tip(r_imu + h), tip(r_imu - h));
    for axis in 0..2 {
        let finite = (above[axis] - below[axis]) / (2.0 * h);
        // Central differences leave h² of the third derivative and rounding over h: 1e-9 here.
        assert!((exact[axis].0.eps - finite).abs() < 1e-8, "axis {axis}: {} instead of {finite}", exact[axis].0.eps);
        assert!(finite.abs() > 1e-4, "axis {axis}: the tip depends on the parameter");
    }
}
