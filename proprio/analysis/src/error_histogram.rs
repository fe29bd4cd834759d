//! Histogram of distances and their quantiles, in memory that does not grow with their number.

use hdrhistogram::Histogram;

/// Digits of a quantile: distances that differ by 1/10 000 are resolved.
const DIGITS: u8 = 4;
/// Whole steps in which distances are counted, in 1 m: nanometres.
const STEPS_PER_M: f64 = 1e9;

/// Histogram of distances: their exact number and mean square, their quantiles to 10⁻⁴ of the value.
#[derive(Debug, Clone)]
pub struct ErrorHistogram {
    counts: Histogram<u64>,
    square_sum_m2: f64,
}

/// Statistics of a box plot, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxStats {
    /// Smallest distance within 1.5 box heights below the first quartile.
    pub low_m: f64,
    /// First quartile, median and third quartile.
    pub quartiles_m: [f64; 3],
    /// Largest distance within 1.5 box heights above the third quartile.
    pub high_m: f64,
    /// Largest of all.
    pub largest_m: f64,
}

impl Default for ErrorHistogram {
    fn default() -> Self {
        let counts = Histogram::new(DIGITS).expect("a histogram may have 0 to 5 digits");
        Self { counts, square_sum_m2: 0.0 }
    }
}

impl ErrorHistogram {
    /// Adds one distance.
    ///
    /// # Panics
    /// Never: the histogram grows with its values.
    pub fn add(&mut self, distance_m: f64) {
        self.square_sum_m2 += distance_m * distance_m;
        let steps = (distance_m * STEPS_PER_M).round() as u64;
        self.counts.record(steps).expect("a histogram that resizes takes any value");
    }

    /// Adds all distances of another histogram.
    ///
    /// # Panics
    /// Never, as [`ErrorHistogram::add`].
    pub fn append(&mut self, other: &Self) {
        self.square_sum_m2 += other.square_sum_m2;
        self.counts.add(&other.counts).expect("a histogram that resizes takes any other");
    }

    /// Their number.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.counts.len()
    }

    /// Root mean square, m; `None` without any distance.
    #[must_use]
    pub fn rms_m(&self) -> Option<f64> {
        (self.count() > 0).then(|| (self.square_sum_m2 / self.count() as f64).sqrt())
    }

    /// The quantile, linearly interpolated between the two nearest distances, m; `None` without any distance.
    #[must_use]
    pub fn quantile_m(&self, share: f64) -> Option<f64> {
        let last = self.count().checked_sub(1)?;
        let place = share * last as f64;
        let below = place.floor();
        let [lo, hi] = [below, (below + 1.0).min(last as f64)].map(|rank| self.at_m(rank));
        Some(lo + (hi - lo) * place.fract())
    }

    /// Quartiles and whiskers (Tukey's); `None` without any distance.
    #[must_use]
    pub fn box_stats(&self) -> Option<BoxStats> {
        let [first, median, third] = [0.25, 0.5, 0.75].map(|share| self.quantile_m(share));
        let quartiles_m = [first?, median?, third?];
        let [first, _, third] = quartiles_m;
        let reach = 1.5 * (third - first);
        let inside = |m: &f64| (first - reach..=third + reach).contains(m);
        let mut within = self.counts.iter_recorded().map(|step| metres(step.value_iterated_to())).filter(inside);
        let low_m = within.next().unwrap_or(first);
        Some(BoxStats {
            low_m,
            quartiles_m,
            high_m: within.last().unwrap_or(low_m),
            largest_m: metres(self.counts.max()),
        })
    }

    /// The distance of this rank, m.
    fn at_m(&self, rank: f64) -> f64 {
        metres(self.counts.value_at_quantile((rank + 0.5) / self.count() as f64))
    }
}

fn metres(steps: u64) -> f64 {
    steps as f64 / STEPS_PER_M
}

#[cfg(test)]
mod tests {
    use super::ErrorHistogram;

    fn of(values: &[f64]) -> ErrorHistogram {
        let mut distances = ErrorHistogram::default();
        for value in values {
            distances.add(*value);
        }
        distances
    }

    fn assert_near(found: Option<f64>, expected: f64) {
        let found = found.expect("there are distances");
        assert!((found / expected - 1.0).abs() < 1e-4, "{found}, expected {expected}");
    }

    #[test]
    fn a_quantile_lies_between_its_neighbours() {
        assert_near(of(&[0.004, 0.001, 0.003, 0.002]).quantile_m(0.75), 0.00325);
        assert_near(of(&[0.007]).quantile_m(0.75), 0.007);
        assert_eq!(of(&[]).quantile_m(0.75), None);
    }

    /// From tenths of a millimetre to kilometres, as a wild estimate in floats may be.
    #[test]
    fn quantiles_keep_four_digits_at_any_size() {
        let mut values: Vec<f64> = (0..20_001).map(|i| 1e-4 * 1.001_f64.powi(i)).collect();
        let distances = of(&values);
        values.sort_by(f64::total_cmp);
        for percent in 0..=100_u32 {
            let exact = values[percent as usize * 200];
            assert_near(distances.quantile_m(f64::from(percent) / 100.0), exact);
        }
    }

    #[test]
    fn the_root_mean_square_is_exact() {
        assert_eq!(of(&[0.003, 0.004]).rms_m(), Some(f64::midpoint(0.003 * 0.003, 0.004 * 0.004).sqrt()));
        assert_eq!(of(&[]).rms_m(), None);
    }

    #[test]
    fn a_distance_beyond_all_measure_is_counted() {
        let distances = of(&[0.0, 1e5, 1e300, f64::INFINITY]);
        assert_eq!(distances.count(), 4);
        assert!(distances.quantile_m(1.0).is_some_and(|m| m > 1e9));
    }

    #[test]
    fn sets_add_up() {
        let (mut one, whole) = (of(&[0.5, 0.001]), of(&[0.5, 0.001, 0.02, 7.0]));
        one.append(&of(&[0.02, 7.0]));
        assert_eq!(one.count(), 4);
        assert_eq!(one.box_stats(), whole.box_stats());
    }

    #[test]
    fn whiskers_end_at_the_last_distances_within_one_and_a_half_boxes() {
        // Quartiles 3, 5 and 7 mm, so that whiskers reach to −3 and 13 mm.
        let spread = of(&[0.001, 0.003, 0.003, 0.005, 0.005, 0.007, 0.007, 0.0125, 0.050]);
        let spread = spread.box_stats().expect("there are distances");
        for (found, expected) in spread.quartiles_m.into_iter().zip([0.003, 0.005, 0.007]) {
            assert_near(Some(found), expected);
        }
        assert_near(Some(spread.low_m), 0.001);
        assert_near(Some(spread.high_m), 0.0125);
        assert_near(Some(spread.largest_m), 0.050);
    }
}
