//! Maps of the bend sensors: the paper's quadratic or a curve, with or without memory, by held-back error.
//!
//! The one-standard-error rule (Breiman, Friedman, Olshen and Stone 1984) decides: the simplest map whose error on the tenths that were held back
//! is within one standard error of the smallest.

use calibration_tables::{BendToml, CurveToml, MemoryToml};
use estimator_core::{BendMap, CurveMap, QuadraticMap};

use super::fit::{quadratic, volts};
use super::folds::{FOLDS, Observation, fold};
use super::options::{CalibrationOptions, HysteresisMode, MapKind, MapMode};
use super::statistics::quantile;
use super::sweep::{SensorColumn, Sweep};
use super::{memory, spline};

/// Share of the bend angles' sizes that are below the largest that the plays refer to.
const LARGEST: f64 = 0.99;

/// A sensor's map and its errors, θ − truth, rad; one value per row of the sweep.
pub(super) struct FittedMap {
    pub kind: MapKind,
    pub curve: Option<CurveToml>,
    pub memory: Option<MemoryToml>,
    pub errors: Vec<Option<f64>>,
    /// Each tenth of the sweep by a map fitted without it.
    pub held_back: Vec<Option<f64>>,
}

/// A map without memory, and those that were fitted without one tenth each.
struct Form {
    curve: Option<CurveToml>,
    map: BendMap<f64>,
    held_back: Vec<BendMap<f64>>,
}

/// Data of all fits of one sensor.
struct Fitter<'s> {
    sweep: &'s Sweep,
    counts: &'s [Option<u16>],
    observations: Vec<Observation>,
    largest_rad: f64,
}

impl FittedMap {
    /// Mean square of the held-back errors of each tenth, rad²; 0 for one without truth.
    fn held_back_squares(&self) -> [f64; FOLDS] {
        let mut sums = [(0.0, 0.0_f64); FOLDS];
        for (row, error) in self.held_back.iter().enumerate() {
            if let Some(error) = error {
                let (sum, count) = &mut sums[fold(row, self.held_back.len())];
                *sum += error * error;
                *count += 1.0;
            }
        }
        sums.map(|(sum, count)| sum / count.max(1.0))
    }
}

/// Fits a sensor whose quadratic is known.
pub(super) fn fit(
    sweep: &Sweep,
    column: &SensorColumn,
    plain: &BendToml,
    CalibrationOptions { maps, hysteresis }: CalibrationOptions,
) -> FittedMap {
    let fitter = Fitter::new(sweep, column);
    let mut candidates = Vec::new();
    let mut add = |form: Option<Form>, kind: MapKind| {
        let Some(form) = form else { return };
        let with_memory = (hysteresis != HysteresisMode::Never).then(|| fitter.with_memory(&form, kind)).flatten();
        if hysteresis != HysteresisMode::Always || with_memory.is_none() {
            candidates.push(fitter.without_memory(form, kind));
        }
        candidates.extend(with_memory);
    };
    if maps != MapMode::Curve {
        add(Some(fitter.quadratic(plain)), MapKind::Quadratic);
    }
    if maps != MapMode::Quadratic {
        add(fitter.curve(&fitter.observations), MapKind::Curve);
    }
    // The data may be too narrow for a curve.
    simplest(candidates).unwrap_or_else(|| fitter.without_memory(fitter.quadratic(plain), MapKind::Quadratic))
}

/// The first of maps, the simpler ones first, whose held-back error is within one standard error of the smallest.
fn simplest(candidates: Vec<FittedMap>) -> Option<FittedMap> {
    let squares: Vec<_> = candidates.iter().map(FittedMap::held_back_squares).collect();
    let best = *squares.iter().min_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum()))?;
    let place = squares.iter().position(|squares| is_within_standard_error(squares, &best))?;
    candidates.into_iter().nth(place)
}

/// True where the mean of `errors` exceeds that of `smallest` by no more than the standard error of their difference.
fn is_within_standard_error(errors: &[f64; FOLDS], smallest: &[f64; FOLDS]) -> bool {
    let differences: [f64; FOLDS] = std::array::from_fn(|fold| errors[fold] - smallest[fold]);
    let count = FOLDS as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let squares = differences.iter().map(|difference| (difference - mean).powi(2)).sum::<f64>();
    mean <= (squares / (count * (count - 1.0))).sqrt()
}

impl<'s> Fitter<'s> {
    fn new(sweep: &'s Sweep, column: &'s SensorColumn) -> Self {
        let rows = column.counts.len();
        let pairs = column.counts.iter().zip(&sweep.theta[column.segment]).enumerate();
        let observation = |(row, (counts, theta)): (usize, (&Option<u16>, &Option<f64>))| {
            Some(Observation { row, volts: volts((*counts)?), theta: (*theta)?, fold: fold(row, rows) })
        };
        let mut sizes: Vec<f64> = sweep.theta[column.segment].iter().flatten().map(|theta| theta.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        Self {
            sweep,
            counts: &column.counts,
            observations: pairs.filter_map(observation).collect(),
            largest_rad: quantile(&sizes, LARGEST),
        }
    }

    fn curve(&self, observations: &[Observation]) -> Option<Form> {
        let fitted = spline::fit(observations, self.sweep.rate_hz)?;
        let map = |curve: &CurveToml| {
            let angles: Vec<f64> = curve.theta_deg.iter().copied().map(f64::to_radians).collect();
            BendMap::Curve(CurveMap::from_volts(&angles, curve.volts))
        };
        Some(Form {
            map: map(&fitted.curve),
            held_back: fitted.held_back.iter().map(map).collect(),
            curve: Some(fitted.curve),
        })
    }

    fn quadratic(&self, plain: &BendToml) -> Form {
        let map = |of: &BendToml| BendMap::Quadratic(QuadraticMap::from_volts(of.c2, of.c1, of.c0, of.range_volts()));
        let held_back = |fold: usize| {
            let others = self.observations.iter().filter(|observation| observation.fold != fold);
            let pairs: Vec<_> = others.filter_map(|of| Some((self.counts[of.row]?, of.theta))).collect();
            quadratic(&pairs).map_or_else(|| map(plain), |fit| map(&fit.map))
        };
        Form { curve: None, map: map(plain), held_back: (0..FOLDS).map(held_back).collect() }
    }

    /// Angle of every row by `map`.
    fn angles(&self, map: &BendMap<f64>) -> Vec<Option<f64>> {
        self.counts.iter().map(|counts| map.angle((*counts)?)).collect()
    }

    /// One value per row of the sweep; `None` for rows without truth.
    fn errors(&self, error: impl Fn(&Observation) -> Option<f64>) -> Vec<Option<f64>> {
        let mut errors = vec![None; self.counts.len()];
        for observation in &self.observations {
            errors[observation.row] = error(observation);
        }
        errors
    }

    fn held_back_angle(&self, form: &Form, of: &Observation) -> Option<f64> {
        form.held_back[of.fold].angle(self.counts[of.row]?)
    }

    fn without_memory(&self, form: Form, kind: MapKind) -> FittedMap {
        let angles = self.angles(&form.map);
        let errors = self.errors(|of| Some(angles[of.row]? - of.theta));
        let held_back = self.errors(|of| Some(self.held_back_angle(&form, of)? - of.theta));
        FittedMap { kind, curve: form.curve, memory: None, errors, held_back }
    }

    /// Fits the memory. A curve is fitted again to the residual of the memory; a quadratic stays unchanged.
    fn with_memory(&self, form: &Form, kind: MapKind) -> Option<FittedMap> {
        let second;
        let form = match kind {
            MapKind::Quadratic => form,
            MapKind::Curve => {
                let (features, fitted) = self.memory(form)?;
                let without_memory = |of: &Observation| {
                    Some(Observation { theta: of.theta - fitted.weights.dot(&features[of.row]?), ..*of })
                };
                second = self.curve(&self.observations.iter().filter_map(without_memory).collect::<Vec<_>>())?;
                &second
            }
        };
        let (features, fitted) = self.memory(form)?;
        let angles = self.angles(&form.map);
        let errors = self.errors(|of| Some(angles[of.row]? + fitted.weights.dot(&features[of.row]?) - of.theta));
        let held_back = self.errors(|of| {
            let memory = fitted.held_back[of.fold].dot(&features[of.row]?);
            Some(self.held_back_angle(form, of)? + memory - of.theta)
        });
        let memory = Some(memory::keys(&fitted.weights, self.largest_rad));
        Some(FittedMap { kind, curve: form.curve.clone(), memory, errors, held_back })
    }

    fn memory(&self, form: &Form) -> Option<(memory::Features, memory::FittedMemory)> {
        let angles = self.angles(&form.map);
        let features = memory::features(&angles, self.sweep, self.largest_rad);
        let errors = self.errors(|of| Some(of.theta - angles[of.row]?));
        let fitted = memory::fit(&features, &errors)?;
        Some((features, fitted))
    }
}

#[cfg(test)]
mod tests {
    use super::super::fit::{quadratic, volts};
    use super::super::sweep::Sweep;
    use super::{
        CalibrationOptions, FOLDS, FittedMap, HysteresisMode, MapKind, MapMode, fit, is_within_standard_error,
    };

    /// A sensor of this angle at its voltage, with noise of some tenths of a degree.
    fn sweep(theta: impl Fn(f64) -> f64) -> Sweep {
        let rows = 6000;
        let counts = |row: usize| (2000.0 + 900.0 * libm::sin(row as f64 * 0.1 * std::f64::consts::TAU / 27.0)) as u16;
        let noise = |row: usize| f64::from((row as u32).wrapping_mul(2_654_435_769) >> 16) / 65536.0 - 0.5;
        let angle = |row: usize| theta(volts(counts(row))) + 0.01 * noise(row);
        Sweep::of_sensor(
            10.0,
            (0..rows).map(|row| Some(counts(row))).collect(),
            (0..rows).map(|row| Some(angle(row))).collect(),
            vec![0; rows],
        )
    }

    fn fitted(sweep: &Sweep, maps: MapMode, hysteresis: HysteresisMode) -> FittedMap {
        let column = &sweep.sensors[0];
        let pairs: Vec<_> = column.counts.iter().zip(&sweep.theta[0]).filter_map(|(a, b)| a.zip(*b)).collect();
        let plain = quadratic(&pairs).expect("many voltages").map;
        fit(sweep, column, &plain, CalibrationOptions { maps, hysteresis })
    }

    fn rippled(volts: f64) -> f64 {
        0.9 * (volts - 1.6) + 0.05 * libm::sin(9.0 * volts)
    }

    fn held_back_rmse(found: &FittedMap) -> f64 {
        crate::calibrate::statistics::rms(found.held_back.iter().flatten().copied())
    }

    #[test]
    fn a_rippled_sensor_is_fitted_by_a_curve_better_than_by_a_quadratic() {
        let sweep = sweep(rippled);
        let [curve, quadratic] = [MapMode::Curve, MapMode::Quadratic]
            .map(|maps| held_back_rmse(&fitted(&sweep, maps, HysteresisMode::Never)));
        assert!(curve < 0.2 * quadratic, "{curve} and {quadratic} rad");
        assert_eq!(fitted(&sweep, MapMode::Auto, HysteresisMode::Auto).kind, MapKind::Curve);
    }

    #[test]
    fn a_quadratic_is_kept_with_the_option_quadratic() {
        let found = fitted(&sweep(rippled), MapMode::Quadratic, HysteresisMode::Never);
        assert!(found.kind == MapKind::Quadratic && found.curve.is_none() && found.memory.is_none());
    }

    #[test]
    fn a_sensor_that_a_quadratic_describes_gets_a_quadratic_without_memory() {
        let found = fitted(&sweep(|volts| 0.9 * (volts - 1.6)), MapMode::Auto, HysteresisMode::Auto);
        assert!(found.kind == MapKind::Quadratic && found.curve.is_none() && found.memory.is_none());
    }

    #[test]
    fn a_map_with_the_smallest_error_by_luck_gives_way_to_a_simpler_one() {
        let squares = |one: f64| std::array::from_fn(|fold| if fold == 3 { one } else { 1.0 });
        assert!(is_within_standard_error(&squares(1.5), &squares(1.0)), "one tenth is no evidence");
        assert!(!is_within_standard_error(&[1.01; FOLDS], &[1.0; FOLDS]), "every tenth is better");
    }

    /// The angle exceeds the map's by 0.4 times a play's difference, up to a tenth of the range.
    #[test]
    fn a_sensor_with_hysteresis_gets_a_memory() {
        let mut sweep = sweep(|volts| 0.9 * (volts - 1.6));
        let mut play = None;
        for theta in sweep.theta[0].iter_mut().flatten() {
            let play = play.get_or_insert(*theta);
            *play = play.clamp(*theta - 0.1, *theta + 0.1);
            *theta += 0.4 * (*theta - *play);
        }
        let [without, with] =
            [HysteresisMode::Never, HysteresisMode::Auto].map(|mode| fitted(&sweep, MapMode::Auto, mode));
        assert!(with.memory.is_some() && without.memory.is_none());
        assert!(held_back_rmse(&with) < 0.3 * held_back_rmse(&without));
    }
}
