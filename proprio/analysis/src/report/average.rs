//! The moving average of the drift anchor, for the figures.

use std::collections::VecDeque;

use calibration_tables::AnchorToml;

/// Mean of the newest values, over the time of the anchor's window.
#[derive(Debug, Clone)]
pub struct MovingAverage {
    rate_hz: f64,
    window: u64,
    /// Sums of the values in each step of the anchor.
    steps: VecDeque<Step>,
    sum: f64,
    count: u64,
}

#[derive(Debug, Clone, Copy)]
struct Step {
    number: u64,
    sum: f64,
    count: u64,
}

impl MovingAverage {
    pub fn new(anchor: &AnchorToml) -> Self {
        let window = u64::from(anchor.window);
        Self { rate_hz: anchor.rate_hz, window, steps: VecDeque::new(), sum: 0.0, count: 0 }
    }

    /// Takes a value, if there is one, and returns the mean of the window that ends with it.
    pub fn add(&mut self, time_us: u64, value: Option<f64>) -> Option<f64> {
        let number = (time_us as f64 * self.rate_hz / 1e6) as u64;
        while let Some(oldest) = self.steps.pop_front_if(|step| step.number + self.window <= number) {
            self.sum -= oldest.sum;
            self.count -= oldest.count;
        }
        if let Some(value) = value {
            match self.steps.back_mut().filter(|step| step.number == number) {
                Some(step) => (step.sum, step.count) = (step.sum + value, step.count + 1),
                None => self.steps.push_back(Step { number, sum: value, count: 1 }),
            }
            self.sum += value;
            self.count += 1;
        }
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

#[cfg(test)]
mod tests {
    use calibration_tables::AnchorToml;

    use super::MovingAverage;

    #[test]
    fn the_window_is_as_long_at_any_sample_rate() {
        let anchor = AnchorToml { window: 20, threshold_deg: 0.5, rate_hz: 10.0 };
        for step_us in [100_000, 10_000] {
            let mut average = MovingAverage::new(&anchor);
            let mut last = None;
            for time_us in (0..10_000_000).step_by(step_us) {
                last = average.add(time_us, Some(if time_us < 9_000_000 { 0.0 } else { 1.0 }));
            }
            // The last of two seconds.
            assert!((last.expect("there are values") - 0.5).abs() < 1e-9, "{last:?}");
        }
    }

    #[test]
    fn a_window_without_values_has_no_mean() {
        let mut average = MovingAverage::new(&AnchorToml { window: 20, threshold_deg: 0.5, rate_hz: 10.0 });
        assert_eq!(average.add(0, Some(3.0)), Some(3.0));
        assert_eq!(average.add(1_900_000, None), Some(3.0));
        assert_eq!(average.add(2_000_000, None), None);
    }
}
