//! The lag to a tenth of a second: cross-correlation of both recordings' low-frequency differences at every lag at once.

use std::cmp::Ordering;
use std::sync::Arc;

use proprio_check::clock_fit::{ComparedSensors, GRID_S, Motion, Signal};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::error::AlignmentError;

/// Shortest overlap of the recordings, s.
pub(super) const LEAST_OVERLAP_S: f64 = 60.0;
/// Smallest correlation where there is no rival: one sensor of six may be inverted, and the clocks' rates may differ.
const LEAST_CORRELATION: f64 = 0.6;
/// Size of a negative correlation above which it is significant.
const MIRRORED: f64 = 0.95;
/// Share of the best lag's F-like score above which another lag is a rival.
const RIVAL: f64 = 0.5;
/// Smallest root mean square difference of a column that moves, rad or counts: smaller ones are rounding.
const LEAST_STEP: f64 = 1e-6;
/// Share of its usual motion below which a recording rests.
const STILL: f64 = 0.01;

/// Fit of the recordings at one lag.
#[derive(Debug, Clone, Copy)]
struct LagFit {
    lag_s: f64,
    correlation: f64,
    /// F-like score, which separates a match from chance: explained over unexplained motion, times the length of the overlap,
    /// s. It has the sign of the correlation.
    f_score: f64,
}

/// The camera's time since its first frame less the sensors' since their first row, s, at the best fit.
pub(super) fn lag_s(motion: &Motion) -> Result<f64, AlignmentError> {
    let fits = fits(motion)?;
    let unrelated = |correlation| AlignmentError::Unrelated { correlation, least: motion.by.least_correlation() };
    let hidden = AlignmentError::Hidden { least_s: LEAST_OVERLAP_S };
    let peak = (0..fits.len()).max_by(by_f_score(&fits)).ok_or(hidden)?;
    let best = fits[peak];
    let mirrored = fits.iter().find(|fit| -fit.f_score > best.f_score && -fit.correlation > MIRRORED);
    if let Some(LagFit { correlation, .. }) = mirrored {
        return Err(AlignmentError::Mirrored { correlation: *correlation });
    }
    if best.correlation < LEAST_CORRELATION {
        return Err(unrelated(best.correlation));
    }
    // The peak ends where the correlation has fallen to half.
    let fallen = |k: &usize| fits[*k].correlation < best.correlation / 2.0;
    let before = 0..(0..peak).rev().find(fallen).unwrap_or(0);
    let after = (peak..fits.len()).find(fallen).unwrap_or(fits.len())..fits.len();
    let rival = before.chain(after).max_by(by_f_score(&fits)).map(|k| fits[k]);
    match rival.filter(|rival| rival.f_score > RIVAL * best.f_score) {
        None => Ok(best.lag_s),
        // Similar motions also match at wrong lags by chance.
        Some(_) if best.correlation < motion.by.least_correlation() => Err(unrelated(best.correlation)),
        Some(rival) => Err(AlignmentError::Ambiguous {
            apart_s: (rival.lag_s - best.lag_s).abs(),
            correlations: [best.correlation, rival.correlation],
        }),
    }
}

fn by_f_score(fits: &[LagFit]) -> impl Fn(&usize, &usize) -> Ordering {
    |a, b| fits[*a].f_score.total_cmp(&fits[*b].f_score)
}

/// The fit at every lag at which the overlap is long enough and has motion in it.
fn fits(motion: &Motion) -> Result<Vec<LagFit>, AlignmentError> {
    let cameras: Vec<Option<LowFrequencyDifference>> = motion.cameras.iter().map(LowFrequencyDifference::of).collect();
    let pairs = motion
        .pairs
        .iter()
        .filter_map(|pair| LowFrequencyDifference::of(&pair.sensor).zip(cameras[pair.camera].as_ref()));
    let pairs: Vec<(LowFrequencyDifference, &LowFrequencyDifference)> = pairs.collect();
    if pairs.is_empty() {
        return Err(AlignmentError::Still);
    }
    let longest = |steps: &dyn Fn(&(LowFrequencyDifference, &LowFrequencyDifference)) -> usize| {
        pairs.iter().map(steps).max().unwrap_or_default()
    };
    let (sensor_length, camera_length) =
        (longest(&|(sensor, _)| sensor.values.len()), longest(&|(_, camera)| camera.values.len()));
    let correlator = Correlator::new(sensor_length + camera_length);

    let n = correlator.length;
    let (mut product, mut count) = (vec![0.0; n], vec![0.0; n]);
    let (mut sensor_square, mut camera_square) = (vec![0.0; n], vec![0.0; n]);
    for (sensor, camera) in &pairs {
        let [of_values, of_known] =
            correlator.cross_correlate_pair([&sensor.values, &camera.values], [&sensor.known, &camera.known]);
        let (sensor_squares, camera_squares) = (sensor.squares(), camera.squares());
        let squares =
            correlator.cross_correlate_pair([&sensor_squares, &camera.known], [&sensor.known, &camera_squares]);
        for k in 0..n {
            product[k] += match motion.by {
                ComparedSensors::Imus => of_values[k],
                ComparedSensors::Bend => of_values[k].abs(),
            };
            count[k] += of_known[k];
            sensor_square[k] += squares[0][k];
            camera_square[k] += squares[1][k];
        }
    }
    let lags = (1 - sensor_length as isize)..camera_length as isize;
    let fit = |lag: isize| {
        let k = lag.rem_euclid(n as isize) as usize;
        let overlap_s = count[k] / pairs.len() as f64 * GRID_S;
        let moves = sensor_square[k].min(camera_square[k]) > STILL * count[k];
        let correlation = product[k] / (sensor_square[k] * camera_square[k]).sqrt();
        let explained = correlation * correlation;
        let f_score = overlap_s * correlation.signum() * explained / (1.0 - explained).max(f64::EPSILON);
        (overlap_s >= LEAST_OVERLAP_S && moves).then_some(LagFit { lag_s: lag as f64 * GRID_S, correlation, f_score })
    };
    Ok(lags.filter_map(fit).collect())
}

/// Low-frequency differences of a signal on the grid, scaled to a mean square of 1: 0 where they are not known.
struct LowFrequencyDifference {
    values: Vec<f64>,
    /// 1 where they are known.
    known: Vec<f64>,
}

impl LowFrequencyDifference {
    /// The differences of a signal; `None` without any motion.
    fn of(signal: &Signal) -> Option<Self> {
        let [_, end_s] = signal.ends_s()?;
        let mut of_signal = signal.steps();
        let step = |k: usize| of_signal.at_time(k as f64 * GRID_S).map(|[step, _]| step);
        let steps: Vec<Option<f64>> = (0..(end_s / GRID_S) as usize).map(step).collect();
        let known = steps.iter().flatten().count();
        let mean_square = steps.iter().flatten().map(|step| step * step).sum::<f64>() / known as f64;
        (mean_square > LEAST_STEP * LEAST_STEP).then(|| Self {
            values: steps.iter().map(|step| step.unwrap_or_default() / mean_square.sqrt()).collect(),
            known: steps.iter().map(|step| f64::from(u8::from(step.is_some()))).collect(),
        })
    }

    fn squares(&self) -> Vec<f64> {
        self.values.iter().map(|value| value * value).collect()
    }
}

/// Cross-correlation by fast Fourier transform.
struct Correlator {
    length: usize,
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
}

impl Correlator {
    fn new(least_length: usize) -> Self {
        let length = least_length.next_power_of_two();
        let mut planner = FftPlanner::new();
        Self { length, forward: planner.plan_fft_forward(length), inverse: planner.plan_fft_inverse(length) }
    }

    fn spectrum(&self, values: &[f64]) -> Vec<Complex<f64>> {
        let mut spectrum: Vec<Complex<f64>> = values.iter().map(Complex::from).collect();
        spectrum.resize(self.length, Complex::default());
        self.forward.process(&mut spectrum);
        spectrum
    }

    /// Cross-correlations Σ_t a(t) b(t + lag) of two pairs of columns at every lag, negative ones counted from the end. Both are
    /// real, so that one transform gives both.
    fn cross_correlate_pair(&self, [a, b]: [&[f64]; 2], [c, d]: [&[f64]; 2]) -> [Vec<f64>; 2] {
        let [a, b, c, d] = [a, b, c, d].map(|values| self.spectrum(values));
        let product = |k: usize| a[k].conj() * b[k] + Complex::<f64>::I * c[k].conj() * d[k];
        let mut both: Vec<Complex<f64>> = (0..self.length).map(product).collect();
        self.inverse.process(&mut both);
        let scale = self.length as f64;
        [both.iter().map(|z| z.re / scale).collect(), both.iter().map(|z| z.im / scale).collect()]
    }
}
