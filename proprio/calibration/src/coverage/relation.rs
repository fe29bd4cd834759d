//! Least-squares quadratic of one value over another, from sums that forget the past, so that a sensor which comes loose late
//! in a sweep shows within a minute.

use nalgebra::{Matrix3, Vector3};

/// Time constant of the forgetting, s: two swings of a sweep, as one alone is like that of another segment by chance.
const MEMORY_S: f64 = 60.0;
/// Time that the sums need before they are judged, s.
const LEAST_S: f64 = 10.0;
/// Middle of the converter's counts.
const MIDDLE_COUNTS: f64 = 2048.0;

/// Counts about the middle of the converter's range, as a share of it: powers of them are well conditioned.
pub(super) fn centred(counts: u16) -> f64 {
    (f64::from(counts) - MIDDLE_COUNTS) / MIDDLE_COUNTS
}

/// Sums over the last swings of a sensor's counts and a value that should follow them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Relation {
    /// Sums of 1, u, u², u³, u⁴, with u the [`centred`] counts; in seconds.
    powers: [f64; 5],
    /// Sums of y, u·y, u²·y.
    products: Vector3<f64>,
    /// Sum of y².
    square: f64,
}

impl Relation {
    /// Adds a pair that has held for `seconds`.
    pub fn update(&mut self, seconds: f64, counts: u16, y: f64) {
        let keep = libm::exp(-seconds / MEMORY_S);
        let u = centred(counts);
        let basis = Vector3::new(1.0, u, u * u);
        for (power, sum) in self.powers.iter_mut().enumerate() {
            *sum = *sum * keep + seconds * u.powi(power as i32);
        }
        self.products = self.products * keep + basis * (seconds * y);
        self.square = self.square * keep + seconds * y * y;
    }

    /// Standard deviation of the counts; `None` before ten seconds.
    pub fn counts_deviation(&self) -> Option<f64> {
        let [all, sum, square, ..] = self.powers;
        (all >= LEAST_S).then(|| MIDDLE_COUNTS * (square / all - (sum / all).powi(2)).max(0.0).sqrt())
    }

    /// Standard deviation of y; `None` before ten seconds.
    pub fn value_deviation(&self) -> Option<f64> {
        (self.powers[0] >= LEAST_S).then(|| self.value_variance().sqrt())
    }

    /// Share of the variance of y that a quadratic of the counts does not explain; `None` before ten seconds.
    pub fn unexplained(&self) -> Option<f64> {
        let variance = self.value_variance();
        if self.powers[0] < LEAST_S || variance <= 0.0 {
            return None;
        }
        let normal = Matrix3::from_fn(|row, column| self.powers[row + column]);
        // Counts that do not change explain nothing.
        let Some(solved) = normal.cholesky() else { return Some(1.0) };
        let residual = self.square - solved.solve(&self.products).dot(&self.products);
        Some((residual / self.powers[0] / variance).clamp(0.0, 1.0))
    }

    fn value_variance(&self) -> f64 {
        let mean = self.products.x / self.powers[0];
        (self.square / self.powers[0] - mean * mean).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Relation;

    fn relation(seconds: f64, value: impl Fn(u16) -> f64) -> Relation {
        let mut relation = Relation::default();
        for row in 0..(seconds * 100.0) as u32 {
            let counts = (2300.0 + 200.0 * libm::sin(f64::from(row) * 0.003)) as u16;
            relation.update(0.01, counts, value(counts));
        }
        relation
    }

    #[test]
    fn a_quadratic_explains_all_and_a_value_that_stays_alternates_or_is_too_new_does_not() {
        let followed = relation(60.0, |counts| 1e-4 * (f64::from(counts) - 2000.0).powi(2) - 3.0);
        assert!(followed.unexplained().expect("a minute") < 1e-6, "{followed:?}");
        let alternates = relation(60.0, |counts| f64::from(counts % 2));
        assert!(alternates.unexplained().expect("a minute") > 0.9);
        assert_eq!(relation(5.0, f64::from).unexplained(), None);
        assert_eq!(relation(60.0, |_| 7.0).value_deviation().map(f64::round), Some(0.0));
    }

    #[test]
    fn what_was_minutes_ago_is_forgotten() {
        let mut relation = relation(300.0, f64::from);
        for row in 0..20_000_u32 {
            let phase = f64::from(row);
            let counts = (2300.0 + 200.0 * libm::sin(phase * 0.003)) as u16;
            relation.update(0.01, counts, 200.0 * libm::cos(phase * 0.003));
        }
        assert!(relation.unexplained().expect("minutes") > 0.5);
    }
}
