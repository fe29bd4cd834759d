//! Limits of contact detection: coupled segments and their responses, and the scatter of the residuals over the sweep.
//!
//! The response of a segment to the one that it is coupled to is fitted to the true angles; the scatter is that of the IMUs
//! and bend sensors at the detector's rate. The same model in fixed point is `estimator_core`'s `contact`.

use calibration_tables::{ArmFile, ChangeToml, CoupledToml, RATIO_RANGE};

use super::maps::FittedMap;
use super::statistics::{quantile, rms};
use super::sweep::{LEAST_ROWS, Sweep};

/// Squared correlation of two segments whose response is fitted, and the share of the later one's variance that a response
/// of coupled segments explains.
const CANDIDATE: f64 = 0.9;
const COUPLED: f64 = 0.98;
/// Plays and lags that are tried, as multiples of their steps.
const PLAY_STEPS: i32 = 6;
const PLAY_STEP_DEG: f64 = 0.5;
const LAG_STEPS: i32 = 3;
const LAG_STEP_S: f64 = 0.1;
/// Share of the fitted lag that is used: a part of it is motion of a slow sweep that the ratios and the play do not explain.
/// Chosen on fast motion of development arms.
const LAG_SHARE: f64 = 0.85;
/// Values of the detector's window, and of its motion, which is the window of the fit, too.
const WINDOW: usize = 10;
const MOTION_WINDOW: usize = 5;
/// Decay of the largest motion in one value.
const MOTION_DECAY: f64 = 1.0 / 16.0;
/// Share of the values whose motion is within that of the sweep.
const USUAL: f64 = 0.99;
/// Limits in root mean squares of the change; chosen on development arms, for no false alarm but in motion much faster than
/// the sweep's.
const FACTOR: f64 = 8.0;
/// Limits in largest changes of the sweep: friction that sticks and slips has heavy tails.
const LARGEST_FACTOR: f64 = 1.5;
/// Smallest limit that a sweep of a quarter of an hour can show, and the largest that detects anything, degrees.
const LIMITS_DEG: [f64; 2] = [2.0, 10.0];
/// Largest change within the window that a sweep's arm can make; a larger one is a fault of a sensor, degrees.
const FAULT_DEG: f64 = 45.0;
/// Largest limit that a table can have, degrees.
const MOST_DEG: f64 = 90.0;

/// The sweep at the detector's rate.
struct Values {
    runs: Vec<u32>,
    /// True bend angle of each segment, and the same by its IMUs, rad.
    theta: Vec<Vec<Option<f64>>>,
    imu: Vec<Vec<Option<f64>>>,
    step_s: f64,
}

/// Response of a segment to the one that it is coupled to.
#[derive(Debug, Clone, Copy)]
struct Model {
    play_rad: f64,
    lag_s: f64,
    /// θ over that of the coupled segment, where the latter is positive and where it is negative.
    ratios: [f64; 2],
}

/// A play and a first-order lag.
struct Response {
    radius: f64,
    share: f64,
    state: Option<[f64; 2]>,
}

/// One value of a residual, and the angle whose motion explains a part of it.
type Residual = Option<[f64; 2]>;

/// Sets `coupled_to` and `contact` of all segments; limits where the arm description has none. `sensors`: the fitted maps of
/// each segment.
pub(super) fn set(sweep: &Sweep, sensors: &[Vec<&FittedMap>], has_limits: bool, table: &mut ArmFile) {
    let scales: Vec<f64> = table.segments.iter().map(|segment| segment.imu_scale.unwrap_or(1.0)).collect();
    let values = Values::of(sweep, &scales, table.anchor.rate_hz);
    for (i, segment) in table.segments.iter_mut().enumerate() {
        let bend = sensors.get(i).and_then(|sensors| values.bend_limit(sweep, i, sensors));
        segment.contact = bend.filter(|_| has_limits);
        segment.coupled_to = values.coupled(i).map(|coupled| {
            let CoupledToml { segment, ratio, ratio_left, .. } = coupled;
            let one_ratio = ratio_left.map_or(ratio, |left| f64::midpoint(ratio, left));
            if has_limits { coupled } else { CoupledToml::with_ratio(segment, one_ratio) }
        });
    }
}

impl Values {
    fn of(sweep: &Sweep, scales: &[f64], value_hz: f64) -> Self {
        let per = (sweep.rate_hz / value_hz).round().max(1.0) as usize;
        let scaled: Vec<Vec<Option<f64>>> =
            sweep.imu.iter().zip(scales).map(|(imu, scale)| divided(imu, *scale)).collect();
        let zero = vec![Some(0.0); sweep.runs.len()];
        let below = std::iter::once(&zero).chain(&scaled);
        let imu = scaled.iter().zip(below).map(|(imu, below)| {
            imu.iter().zip(below).map(|(imu, below)| Some((*imu)? - (*below)?)).collect::<Vec<Option<f64>>>()
        });
        Self {
            runs: sweep.runs.chunks_exact(per).map(|runs| runs[0]).collect(),
            theta: sweep.theta.iter().map(|theta| means(theta, per)).collect(),
            imu: imu.map(|imu| means(&imu, per)).collect(),
            step_s: per as f64 / sweep.rate_hz,
        }
    }

    /// Limit of the IMUs against the bend sensors of segment `i`.
    fn bend_limit(&self, sweep: &Sweep, i: usize, sensors: &[&FittedMap]) -> Option<ChangeToml> {
        let (first, last) = (sensors.first()?, sensors.last()?);
        let errors = first.errors.iter().zip(&last.errors).map(|(a, b)| Some(f64::midpoint((*a)?, (*b)?)));
        let per = sweep.runs.len() / self.runs.len().max(1);
        let errors = means(&errors.collect::<Vec<_>>(), per);
        let angles = self.imu[i].iter().zip(&self.theta[i]).zip(&errors);
        let residuals = angles.map(|((imu, theta), error)| {
            let bend = (*theta)? + (*error)?;
            Some([(*imu)? - bend, bend])
        });
        self.limit(&residuals.collect::<Vec<Residual>>())
    }

    /// The earlier segment that segment `j` is coupled to, with the response and the limit.
    fn coupled(&self, j: usize) -> Option<CoupledToml> {
        let candidates = (0..j).map(|i| (i, correlation(&self.theta[i], &self.theta[j])));
        let (i, correlation) = candidates.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        if correlation < CANDIDATE {
            return None;
        }
        let model = self.fit(i, j)?;
        let limit = self.limit(&self.residuals(&model, i, j, &self.imu));
        let is_within = model.ratios.iter().all(|ratio| RATIO_RANGE.contains(ratio));
        let limit = limit.filter(|limit| is_within && limit.change_deg <= LIMITS_DEG[1])?;
        Some(CoupledToml {
            segment: i + 1,
            ratio: model.ratios[0],
            ratio_left: Some(model.ratios[1]),
            lag_s: rounded(model.lag_s),
            play_deg: rounded(model.play_rad.to_degrees()),
            limit: Some(limit),
        })
    }

    /// The response that leaves the smallest change of the residual, of coupled segments.
    fn fit(&self, i: usize, j: usize) -> Option<Model> {
        let trial = |(play, lag): (i32, i32)| {
            let response = Model {
                play_rad: (f64::from(play) * PLAY_STEP_DEG).to_radians(),
                lag_s: f64::from(lag) * LAG_STEP_S,
                ratios: [1.0; 2],
            };
            let angles = self.responses(&response, i, j, &self.theta);
            let model = Model { ratios: ratios(&angles)?, ..response };
            let residuals = self.residuals(&model, i, j, &self.theta);
            Some((rms_change(&residuals, &self.runs, MOTION_WINDOW)?, model, residuals))
        };
        let trials = (-PLAY_STEPS..=PLAY_STEPS).flat_map(|play| (-LAG_STEPS..=LAG_STEPS).map(move |lag| (play, lag)));
        let (_, model, residuals) = trials.filter_map(trial).min_by(|(a, ..), (b, ..)| a.total_cmp(b))?;
        let left = variance(residuals.iter().flatten().map(|[residual, _]| *residual));
        let all = variance(self.theta[j].iter().flatten().copied());
        // A lag at the bound is an artefact: friction looks like a lag at the sweep's pace alone.
        let is_lag = model.lag_s.abs() < (f64::from(LAG_STEPS) - 0.5) * LAG_STEP_S;
        (is_lag && left < (1.0 - COUPLED) * all).then_some(Model { lag_s: LAG_SHARE * model.lag_s, ..model })
    }

    /// Angles of segments `i` and `j` behind the response, and the motion of that of `i`.
    fn responses(&self, model: &Model, i: usize, j: usize, angles: &[Vec<Option<f64>>]) -> Vec<Option<[f64; 3]>> {
        let [mut lead, mut own] = [1.0, -1.0].map(|sign| Response::new(model, sign, self.step_s));
        let values = angles[i].iter().zip(&angles[j]);
        let step = |(lead_angle, own_angle): (&Option<f64>, &Option<f64>)| {
            let (lead_angle, own_angle) = (*lead_angle).zip(*own_angle)?;
            let ([lead, motion], [own, _]) = (lead.step(lead_angle), own.step(own_angle));
            Some([lead, own, motion])
        };
        values.map(step).collect()
    }

    /// Residuals of segment `j` against segment `i`, as the detector accumulates them.
    fn residuals(&self, model: &Model, i: usize, j: usize, angles: &[Vec<Option<f64>>]) -> Vec<Residual> {
        let mut expected = 0.0;
        let behind = self.responses(model, i, j, angles).into_iter().zip(angles[i].iter().zip(&self.theta[i]));
        let residuals = behind.map(|(behind, (angle, theta))| {
            let [lead, own, motion] = behind?;
            // The ratio changes where the true angle is zero.
            let theta = lead + (*theta)? - (*angle)?;
            expected += model.curve(theta) - model.curve(theta - motion);
            Some([own - expected, expected])
        });
        residuals.collect()
    }

    fn limit(&self, residuals: &[Residual]) -> Option<ChangeToml> {
        let is_motion = |change: &f64| change.abs() <= FAULT_DEG.to_radians();
        let changes_of = || changes(residuals, &self.runs, WINDOW).map(|[change, _]| change).filter(is_motion);
        if changes_of().count() < LEAST_ROWS {
            return None;
        }
        let scatter = rms(changes_of());
        let mut held = 0.0_f64;
        let motions = changes(residuals, &self.runs, MOTION_WINDOW).map(|[_, motion]| {
            held = motion.abs().max(held * (1.0 - MOTION_DECAY));
            held
        });
        let mut motions: Vec<f64> = motions.collect();
        motions.sort_unstable_by(f64::total_cmp);
        let largest = changes_of().map(f64::abs).fold(0.0, f64::max);
        let change_rad = (FACTOR * scatter).max(LARGEST_FACTOR * largest);
        Some(ChangeToml {
            change_deg: rounded(change_rad.to_degrees().clamp(LIMITS_DEG[0], MOST_DEG)),
            motion_deg: rounded(quantile(&motions, USUAL).to_degrees()),
        })
    }
}

impl Model {
    fn curve(&self, theta: f64) -> f64 {
        theta * if theta < 0.0 { self.ratios[1] } else { self.ratios[0] }
    }
}

impl Response {
    /// The response of the coupled segment for a `sign` of 1, of the segment itself for −1.
    fn new(model: &Model, sign: f64, step_s: f64) -> Self {
        let lag_s = (sign * model.lag_s).max(0.0);
        let share = if lag_s > 0.0 { 1.0 - (-step_s / lag_s).exp() } else { 1.0 };
        Self { radius: (sign * model.play_rad).max(0.0), share, state: None }
    }

    /// Takes one value; returns the output and its change.
    fn step(&mut self, angle: f64) -> [f64; 2] {
        let [play, lag] = self.state.unwrap_or([angle; 2]);
        let play = play.clamp(angle - self.radius, angle + self.radius);
        let change = self.share * (play - lag);
        self.state = Some([play, lag + change]);
        [lag + change, change]
    }
}

/// A column over its scale.
fn divided(column: &[Option<f64>], scale: f64) -> Vec<Option<f64>> {
    column.iter().map(|value| value.map(|value| value / scale)).collect()
}

/// Means of `per` rows; `None` where one is missing.
fn means(column: &[Option<f64>], per: usize) -> Vec<Option<f64>> {
    let mean = |rows: &[Option<f64>]| Some(rows.iter().copied().sum::<Option<f64>>()? / rows.len() as f64);
    column.chunks_exact(per).map(mean).collect()
}

/// Changes over a window that lies in one run of the estimator and misses no value.
fn changes<'r>(residuals: &'r [Residual], runs: &'r [u32], window: usize) -> impl Iterator<Item = [f64; 2]> + 'r {
    let windows = residuals.windows(window + 1).zip(runs.windows(window + 1));
    windows.filter_map(move |(residuals, runs)| {
        let is_whole = runs[0] == runs[window] && residuals.iter().all(Option::is_some);
        let ([now, angle], [before, angle_before]) = residuals[window].zip(residuals[0]).filter(|_| is_whole)?;
        Some([now - before, angle - angle_before])
    })
}

fn rms_change(residuals: &[Residual], runs: &[u32], window: usize) -> Option<f64> {
    let count = changes(residuals, runs, window).count();
    (count >= LEAST_ROWS).then(|| rms(changes(residuals, runs, window).map(|[change, _]| change)))
}

/// Squared correlation of two columns without their means.
fn correlation(a: &[Option<f64>], b: &[Option<f64>]) -> f64 {
    let both = a.iter().zip(b).filter_map(|(a, b)| a.zip(*b));
    let [aa, ab, bb] = both.fold([0.0; 3], |[aa, ab, bb], (a, b)| [aa + a * a, ab + a * b, bb + b * b]);
    if aa * bb > 0.0 { ab * ab / (aa * bb) } else { 0.0 }
}

/// Least-squares ratios where the coupled segment's angle is positive and where it is negative.
fn ratios(angles: &[Option<[f64; 3]>]) -> Option<[f64; 2]> {
    let of_side = |is_left: bool| {
        let side = angles.iter().flatten().filter(|[lead, ..]| (*lead < 0.0) == is_left);
        let [square, product] =
            side.fold([0.0; 2], |[square, product], [lead, own, _]| [square + lead * lead, product + lead * own]);
        (square > 0.0).then(|| product / square)
    };
    let (right, left) = (of_side(false), of_side(true));
    Some([right.or(left)?, left.or(right)?])
}

fn variance(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    values.map(|value| (value - mean).powi(2)).sum::<f64>() / count
}

/// Rounds to a thousandth, the resolution of a sweep.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}
