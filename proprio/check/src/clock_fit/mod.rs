//! Both clocks to a fraction of a sample: lags of windows of the recording, and the regression line through them.

mod motion;
mod signal;

pub use motion::{ComparedSensors, Motion, Pair};
pub use signal::{GRID_S, Reading, Signal, Steps};

use crate::median::median;

/// Length of a window, s.
const WINDOW_S: f64 = 20.0;
/// Largest number of rounds; four are usual.
const ROUNDS: usize = 20;
/// Change of the lag in a round below which it has converged, s.
const CONVERGED_S: f64 = 1e-6;
/// Largest change of a window's lag in one round, s: the coarse lag is no further off.
const LONGEST_MOVE_S: f64 = 1.0;
/// Smallest noise of a sensor, as a share of its mean square: less would be rounding.
const LEAST_NOISE: f64 = 1e-9;
/// Fewest windows of a line whose error can be estimated.
const LEAST_WINDOWS: f64 = 2.5;

/// The camera's clock as a line over the sensors': camera = lag + (1 + skew) · sensors, each since its own start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clocks {
    /// The camera's time at the sensors' start, s.
    pub lag_s: f64,
    /// Rate by which the camera's clock is faster.
    pub skew: f64,
}

impl Clocks {
    /// The camera's time at a time of the sensors.
    #[must_use]
    pub fn camera_s(&self, sensor_s: f64) -> f64 {
        self.lag_s + sensor_s + self.skew * sensor_s
    }
}

/// The fitted clocks, with their errors.
#[derive(Debug, Clone, Copy)]
pub struct ClockFit {
    /// The line.
    pub clocks: Clocks,
    /// Middle of the overlap by the sensors' clock, s, where the lag is known best.
    pub middle_s: f64,
    /// Standard error of the lag there, s, from the scatter of the windows.
    pub lag_error_s: f64,
    /// Standard error of the skew.
    pub skew_error: f64,
    /// Root mean square of the windows' lags about the line, s.
    pub residual_s: f64,
    /// Median correlation of the pairs, some of which may be wrong.
    pub correlation: f64,
    /// Number of moments at which differences were compared.
    pub matched: usize,
}

/// Difference of a pair's sensor, its rate of change, and the difference of the camera's column at the same time.
struct Step {
    pair: usize,
    time_s: f64,
    value: f64,
    rate: f64,
    camera: Option<f64>,
}

/// Refines a lag that is right to some tenths of a second; `None` where too few windows have motion.
#[must_use]
pub fn fit(motion: &Motion, lag_s: f64) -> Option<ClockFit> {
    let mut windows = windows(motion);
    let mut clocks = Clocks { lag_s, skew: 0.0 };
    let mut rounds = 0;
    loop {
        compare(motion, &mut windows, clocks);
        let gains = gains(motion, &windows);
        let scales: Vec<[f64; 2]> = gains.iter().map(|gain| [gain.value(), gain.noise()]).collect();
        let lags: Vec<WindowLag> = windows.iter().filter_map(|window| window_lag(window, &scales)).collect();
        let line = Line::through(&lags)?;
        clocks = Clocks { lag_s: clocks.lag_s + line.at(0.0), skew: clocks.skew + line.slope };
        rounds += 1;
        if line.lag_s.abs().max(line.at(0.0).abs()) < CONVERGED_S || rounds == ROUNDS {
            compare(motion, &mut windows, clocks);
            return Some(ClockFit {
                clocks,
                middle_s: line.middle_s,
                lag_error_s: line.lag_error_s,
                skew_error: line.slope_error,
                residual_s: line.residual_s,
                correlation: median_correlation(motion.by, &gains),
                matched: matched(&windows),
            });
        }
    }
}

fn median_correlation(by: ComparedSensors, gains: &[Gain]) -> f64 {
    let known = gains.iter().map(Gain::correlation).filter(|correlation| correlation.is_finite());
    let known = match by {
        ComparedSensors::Imus => known.collect(),
        ComparedSensors::Bend => known.map(f64::abs).collect(),
    };
    median(known).unwrap_or_default()
}

/// Number of moments at which a sensor's difference has one of the camera.
fn matched(windows: &[Vec<Step>]) -> usize {
    let mut times: Vec<f64> =
        windows.iter().flatten().filter(|step| step.camera.is_some()).map(|step| step.time_s).collect();
    // Those of one moment are in succession.
    times.dedup();
    times.len()
}

/// The sensors' steps in windows, moment by moment.
fn windows(motion: &Motion) -> Vec<Vec<Step>> {
    let ends_s = motion.pairs.iter().filter_map(|pair| pair.sensor.ends_s());
    let end_s = ends_s.map(|[_, end_s]| end_s).fold(0.0, f64::max);
    let per_window = (WINDOW_S / GRID_S).round() as usize;
    let mut sensors: Vec<Steps> = motion.pairs.iter().map(|pair| pair.sensor.steps()).collect();
    let moments = (end_s / GRID_S) as usize;
    let mut windows = Vec::with_capacity(moments.div_ceil(per_window));
    for first in (0..moments).step_by(per_window) {
        let mut window = Vec::with_capacity(per_window * sensors.len());
        for k in first..moments.min(first + per_window) {
            let time_s = k as f64 * GRID_S;
            for (pair, sensor) in sensors.iter_mut().enumerate() {
                let step = sensor.at_time(time_s);
                window.extend(step.map(|[value, rate]| Step { pair, time_s, value, rate, camera: None }));
            }
        }
        windows.push(window);
    }
    windows
}

/// Sets the camera's differences, by a guess of the clocks.
fn compare(motion: &Motion, windows: &mut [Vec<Step>], clocks: Clocks) {
    let mut cameras: Vec<Steps> = motion.pairs.iter().map(|pair| motion.cameras[pair.camera].steps()).collect();
    for step in windows.iter_mut().flatten() {
        let of_camera = cameras[step.pair].at_time(clocks.camera_s(step.time_s));
        step.camera = of_camera.map(|[value, _]| value);
    }
}

/// Regression of a pair's sensor on the camera.
#[derive(Debug, Default, Clone, Copy)]
struct Gain {
    sensor_square: f64,
    camera_square: f64,
    product: f64,
    count: f64,
}

impl Gain {
    fn add(&mut self, sensor: f64, camera: f64) {
        self.sensor_square += sensor * sensor;
        self.camera_square += camera * camera;
        self.product += sensor * camera;
        self.count += 1.0;
    }

    /// The sensor's step for one of the camera's.
    fn value(&self) -> f64 {
        if self.camera_square > 0.0 { self.product / self.camera_square } else { 0.0 }
    }

    /// Mean square of the residual that the camera does not explain.
    fn noise(&self) -> f64 {
        let rest = self.sensor_square - self.value() * self.product;
        rest.max(LEAST_NOISE * self.sensor_square) / self.count
    }

    fn correlation(&self) -> f64 {
        self.product / (self.sensor_square * self.camera_square).sqrt()
    }
}

fn gains(motion: &Motion, windows: &[Vec<Step>]) -> Vec<Gain> {
    let mut gains = vec![Gain::default(); motion.pairs.len()];
    for step in windows.iter().flatten() {
        if let Some(camera) = step.camera {
            gains[step.pair].add(step.value, camera);
        }
    }
    gains
}

/// Lead of the camera's clock over the line in one window.
#[derive(Debug, Clone, Copy)]
struct WindowLag {
    /// Middle of the compared moments, s.
    time_s: f64,
    lag_s: f64,
    /// Inverse variance of the lag: its information from the motion in the window.
    weight: f64,
}

/// One Gauss–Newton step: the lag that maps the camera's differences to the sensors'. The slope is that of the sensors, which is
/// less noisy than a single camera's. `scales` has the value and the noise of each pair's gain.
fn window_lag(window: &[Step], scales: &[[f64; 2]]) -> Option<WindowLag> {
    let (mut pull, mut weight, mut time) = (0.0, 0.0, 0.0);
    for Step { pair, time_s, value, rate, camera } in window {
        let [gain, noise] = scales[*pair];
        if let Some(camera) = camera.filter(|_| noise > 0.0) {
            pull += rate * (value - gain * camera) / noise;
            weight += rate * rate / noise;
            time += rate * rate / noise * time_s;
        }
    }
    let lag_s = (pull / weight).clamp(-LONGEST_MOVE_S, LONGEST_MOVE_S);
    (weight > 0.0).then(|| WindowLag { time_s: time / weight, lag_s, weight })
}

/// A line through the windows' lags.
#[derive(Debug, Clone, Copy)]
struct Line {
    middle_s: f64,
    lag_s: f64,
    slope: f64,
    lag_error_s: f64,
    slope_error: f64,
    residual_s: f64,
}

impl Line {
    /// Weighted least squares; `None` with too few windows of any weight.
    fn through(lags: &[WindowLag]) -> Option<Self> {
        let sum = |of: &dyn Fn(&WindowLag) -> f64| lags.iter().map(|lag| lag.weight * of(lag)).sum::<f64>();
        let weight = sum(&|_| 1.0);
        let windows = weight * weight / sum(&|lag| lag.weight);
        if lags.is_empty() || windows < LEAST_WINDOWS {
            return None;
        }
        let middle_s = sum(&|lag| lag.time_s) / weight;
        let lag_s = sum(&|lag| lag.lag_s) / weight;
        let spread = sum(&|lag| (lag.time_s - middle_s).powi(2));
        let slope = sum(&|lag| (lag.time_s - middle_s) * lag.lag_s) / spread;
        let square = sum(&|lag| (lag.lag_s - lag_s - slope * (lag.time_s - middle_s)).powi(2));
        // The line takes two degrees of freedom.
        let variance = square / weight * windows / (windows - 2.0);
        Some(Self {
            middle_s,
            lag_s,
            slope,
            lag_error_s: (variance / windows).sqrt(),
            slope_error: (variance * weight / (windows * spread)).sqrt(),
            residual_s: variance.sqrt(),
        })
    }

    fn at(&self, time_s: f64) -> f64 {
        self.lag_s + self.slope * (time_s - self.middle_s)
    }
}
