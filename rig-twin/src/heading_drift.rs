//! Recorded drift of a real IMU's heading, to be added to simulated ones.

/// Drift of a heading over time, from a recording at even times.
///
/// The recording repeats without end; each round begins where the last one ended.
///
/// ```
/// use rig_twin::HeadingDrift;
///
/// let csv = "recording,time_s,heading_error_deg\n02,0.0,0.5\n02,0.1,0.7\n02,0.2,0.6\n05,0.0,9.0\n";
/// let drift = HeadingDrift::parse(csv, "02", 2.0).expect("three samples");
/// assert!((drift.at(0.1).to_degrees() - 0.4).abs() < 1e-9, "from its start, twice as large");
/// assert!((drift.at(0.4).to_degrees() - 0.4).abs() < 1e-9, "after two rounds of 0.2° each");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HeadingDrift {
    drift_rad: Vec<f64>,
    period_s: f64,
}

impl HeadingDrift {
    /// Reads one recording of CSV text with the columns recording, time in s and heading error in degrees, clockwise positive,
    /// scaled by `factor`. `None` if it has fewer than two samples or cells that are no numbers.
    pub fn parse(csv: &str, recording: &str, factor: f64) -> Option<Self> {
        let rows = csv.lines().skip(1).map(|line| line.split(',').map(str::trim).collect::<Vec<_>>());
        let samples = rows.filter(|row| row.first() == Some(&recording)).map(|row| {
            let [_, time_s, error_deg] = row[..] else { return None };
            Some((time_s.parse::<f64>().ok()?, error_deg.parse::<f64>().ok()?.to_radians()))
        });
        let samples: Vec<(f64, f64)> = samples.collect::<Option<_>>()?;
        let [(start_s, start_rad), .., (end_s, _)] = samples[..] else { return None };
        let period_s = (end_s - start_s) / (samples.len() - 1) as f64;
        let drift_rad = samples.iter().map(|(_, error_rad)| factor * (error_rad - start_rad)).collect();
        (period_s > 0.0).then_some(Self { drift_rad, period_s })
    }

    /// Drift since time 0, rad, interpolated; `time_s` is not negative.
    pub fn at(&self, time_s: f64) -> f64 {
        let last = self.drift_rad.len() - 1;
        let steps = time_s / self.period_s;
        let rounds = libm::floor(steps / last as f64);
        let in_round = steps - rounds * last as f64;
        let index = (in_round as usize).min(last - 1);
        let (from_rad, to_rad) = (self.drift_rad[index], self.drift_rad[index + 1]);
        rounds * self.drift_rad[last] + from_rad + (in_round - index as f64) * (to_rad - from_rad)
    }

    /// A quaternion w, x, y, z, in steps of 1/16384, with this drift added to its heading.
    pub fn turn(&self, time_s: f64, quaternion: [i16; 4]) -> [i16; 4] {
        let [w, x, y, z] = quaternion.map(f64::from);
        let (sin, cos) = libm::sincos(-self.at(time_s) / 2.0);
        let turned = [cos * w - sin * z, cos * x - sin * y, cos * y + sin * x, cos * z + sin * w];
        turned.map(|component| component.round() as i16)
    }
}

#[cfg(test)]
mod tests {
    use super::HeadingDrift;

    #[test]
    fn drift_is_added_to_the_heading_of_a_tilted_quaternion() {
        let drift = HeadingDrift::parse("header\na,0,0\na,10,30\n", "a", 1.0).expect("two samples");
        let heading_deg = |quaternion: [i16; 4]| {
            let [w, x, y, z] = quaternion.map(|step| f64::from(step) / 16384.0);
            -(2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)).to_degrees()
        };
        let before = [15_000, 800, -500, 6_500];
        let turned = heading_deg(drift.turn(5.0, before)) - heading_deg(before);
        assert!((turned - 15.0).abs() < 0.02, "{turned}°");
    }

    #[test]
    fn recordings_that_are_short_or_no_numbers_are_refused() {
        for csv in ["", "header\na,0,1\n", "header\na,0,1\na,x,2\n", "header\na,0,1\na,0,2\n", "header\na,0\na,1\n"] {
            assert_eq!(HeadingDrift::parse(csv, "a", 1.0), None, "{csv:?}");
        }
    }
}
