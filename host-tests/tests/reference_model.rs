//! The estimator against the reference model, over random sessions.
//!
//! The tolerances: fixed point within 1e-6 rad and 0.002 mm of floats; floats within 1e-7 rad and m of the
//! reference model, as angles are whole numbers of 2⁻³² turns and the polynomials err by up to 2e-11.

mod synthetic;

use estimator_core::{ArmConfig, Estimator, FusedOps, Method, Q};
use host_tests::reference_model::{self, Answer, Shape};
use synthetic::{Kind, NoiseRanges, Random};

/// Distance from the threshold within which one side may correct and the other not, rad.
const BRINK: f64 = 1e-6;

/// The estimator's answers in the reference model's form.
fn estimated<S: FusedOps>(arm: &reference_model::Arm, samples: &[estimator_core::Sample<16>]) -> Vec<[Shape; 4]> {
    let segments = synthetic::segments::<S>(arm);
    let (anchor, tare_samples) = synthetic::rule(arm);
    let table = ArmConfig { tare_samples, anchor, ..ArmConfig::uncalibrated(&segments) };
    let mut estimator = Estimator::<S, 16, 100>::new(&table).expect("a table within capacity");
    let shape = |shape: estimator_core::Shape<S, 16>| Shape {
        theta: shape.iter().map(|segment| segment.theta.map(estimator_core::Angle::rad)).collect(),
        end: shape.iter().map(|segment| segment.end.map(|end| [end.x.to_f64(), end.y.to_f64()])).collect(),
    };
    let step = |sample| {
        let estimate = estimator.update_full(sample);
        Method::ALL.map(|method| shape(estimator.shape(&estimate, method)))
    };
    samples.iter().map(step).collect()
}

/// Largest differences by method, and what was compared.
#[derive(Debug, Default)]
struct Differences {
    theta: [f64; 4],
    end: [f64; 4],
    cells: usize,
    rows_on_the_brink: usize,
    fusion_rows_left_out: usize,
}

impl Differences {
    /// Compares two answers to all rows of a session. Where an offset is on the brink of the threshold and imu_c steps,
    /// that row's imu_c is left out, and the fusion from there on, as the filters remember the step.
    fn compare(
        &mut self,
        what: &str,
        one: &[[Shape; 4]],
        other: &[[Shape; 4]],
        offsets: &[Answer],
        arm: &reference_model::Arm,
    ) {
        let mut stepped = false;
        for (t, (one, other)) in one.iter().zip(other).enumerate() {
            let on_brink = |offset: &f64| (offset.abs() - arm.threshold).abs() < BRINK;
            let brink = offsets[t].offsets.iter().flatten().any(on_brink);
            let steps = brink && differs(&one[2], &other[2], arm.threshold / 2.0);
            self.rows_on_the_brink += usize::from(brink);
            stepped |= steps;
            self.fusion_rows_left_out += usize::from(stepped);
            for (m, method) in Method::ALL.into_iter().enumerate() {
                if !(steps && method == Method::ImuC || stepped && method == Method::Fusion) {
                    self.shapes(&format!("{what}, row {t}, {}", method.name()), m, &one[m], &other[m]);
                }
            }
        }
    }

    fn shapes(&mut self, what: &str, method: usize, one: &Shape, other: &Shape) {
        assert_eq!((one.theta.len(), one.end.len()), (other.theta.len(), other.end.len()), "{what}");
        for i in 0..one.theta.len() {
            self.cells += 1;
            match (one.theta[i], other.theta[i]) {
                (Some(one), Some(other)) => self.theta[method] = self.theta[method].max((one - other).abs()),
                (one, other) => assert_eq!(one, other, "{what}: θ{}", i + 1),
            }
            match (one.end[i], other.end[i]) {
                (Some(one), Some(other)) => {
                    self.end[method] = self.end[method].max((one[0] - other[0]).hypot(one[1] - other[1]));
                }
                (one, other) => assert_eq!(one, other, "{what}: end of segment {}", i + 1),
            }
        }
    }

    fn assert_within(&self, what: &str, theta: f64, end: f64) {
        println!("{what}: {self:?}");
        let worst = |of: &[f64; 4]| of.iter().copied().fold(0.0, f64::max);
        assert!(worst(&self.theta) <= theta, "{what}: θ of bend, imu_o, imu_c, fusion differ by {:?}", self.theta);
        assert!(worst(&self.end) <= end, "{what}: ends by bend, imu_o, imu_c, fusion differ by {:?}", self.end);
        assert!(self.fusion_rows_left_out * 10 <= self.cells, "{what}: too little is compared");
    }
}

fn differs(one: &Shape, other: &Shape, by: f64) -> bool {
    one.theta.iter().zip(&other.theta).any(|pair| matches!(pair, (Some(one), Some(other)) if (one - other).abs() > by))
}

/// Runs a session by the reference model, f64 and Q, and compares; returns the rows and the reference model's answers.
fn check(
    kind: &Kind,
    against_model: &mut Differences,
    against_float: &mut Differences,
) -> (Vec<reference_model::Row>, Vec<Answer>) {
    let mut random = Random(kind.seed);
    let arm = synthetic::arm(kind, &mut random);
    let (rows, samples) = synthetic::session(kind, &arm, &mut random);
    let answers = reference_model::replay(&arm, &rows);
    let expected: Vec<_> =
        answers.iter().map(|a| [a.bend.clone(), a.imu_o.clone(), a.imu_c.clone(), a.fusion.clone()]).collect();
    let float = estimated::<f64>(&arm, &samples);
    against_model.compare(
        &format!("f64 core against the reference model, {kind:?}"),
        &float,
        &expected,
        &answers,
        &arm,
    );
    let board = estimated::<Q>(&arm, &samples);
    against_float.compare(&format!("Q core against f64 core, {kind:?}"), &board, &float, &answers, &arm);
    (rows, answers)
}

/// Filters around those that calibration proposes, and every H that is possible with |θ| ≤ 21 rad.
const NORMAL: NoiseRanges = NoiseRanges { q: [0.05, 10.0], r_imu: [0.05, 5.0], h: [0.8, 1.25] };

fn kind(seed: u64) -> Kind {
    Kind {
        seed,
        segments: 6,
        rate: 10.0,
        tare_seconds: 1.0,
        rows: 1500,
        quaternions: seed % 3 == 2,
        bend: [0, 2],
        drift: 14.0,
        noise: NORMAL,
    }
}

/// Sessions of all numbers of segments, with and without a tare, at one rate.
fn kinds(rate: f64, rows: usize, seeds: u64) -> impl Iterator<Item = Kind> {
    let arms = [1, 3, 6, 16].into_iter().flat_map(|segments| [0.0, 1.0].map(|tare_seconds| (segments, tare_seconds)));
    arms.flat_map(move |(segments, tare_seconds)| {
        let seeds = (0..seeds).map(move |seed| seed + 100 * segments as u64 + 10_000 * rate as u64);
        seeds.map(move |seed| Kind { segments, rate, tare_seconds, rows, ..kind(seed) })
    })
}

/// Checks these sessions within the tolerances, and that they wrap and drift enough.
fn check_all(what: &str, kinds: impl Iterator<Item = Kind>) {
    let (mut against_model, mut against_float) = (Differences::default(), Differences::default());
    let (mut wraps, mut farthest) = (0, 0.0_f64);
    for kind in kinds {
        let (rows, answers) = check(&kind, &mut against_model, &mut against_float);
        let headings: Vec<_> = rows.iter().filter_map(|row| row.headings[0]).collect();
        wraps += headings.windows(2).filter(|pair| (pair[1] - pair[0]).abs() > 3.0).count();
        let angles = answers.iter().flat_map(|answer| answer.imu_o.theta.iter().flatten());
        farthest = angles.fold(farthest, |far, theta| far.max(theta.abs()));
    }
    against_model.assert_within(&format!("f64 core against the reference model, {what}"), 1e-7, 1e-7);
    against_float.assert_within(&format!("Q core against f64 core, {what}"), 1e-6, 2e-6);
    assert!(wraps > 50, "the sessions wrap through 0/360: {wraps} times");
    assert!(farthest.to_degrees() > 720.0, "the sessions drift beyond 720°: {}°", farthest.to_degrees());
}

#[test]
fn the_estimator_agrees_with_the_reference_model_at_10_hz() {
    check_all("10 Hz", kinds(10.0, 1500, 4));
}

#[test]
fn the_estimator_agrees_with_the_reference_model_at_100_hz() {
    check_all("100 Hz", kinds(100.0, 3000, 3));
}

#[test]
fn a_day_of_drift_costs_an_arm_with_bend_sensors_no_digit() {
    let day = |seed| Kind { segments: 3, rows: 20_000, bend: [1, 2], drift: 75.0, ..kind(seed) };
    check_all("75 rad of drift", (0..4).map(day));
}

/// Parameters of all tables, also those outside fixed point's range: floats only.
#[test]
fn filters_of_any_parameters_agree_with_the_reference_model_in_floats() {
    let noise = NoiseRanges { q: [1e-6, 10.0], r_imu: [1e-4, 31.0], h: [0.3, 3.0] };
    let (mut against_model, mut unused) = (Differences::default(), Differences::default());
    for kind in kinds(10.0, 1500, 2) {
        check(&Kind { noise, ..kind }, &mut against_model, &mut unused);
    }
    against_model.assert_within("f64 core against the reference model, any filter", 1e-7, 1e-7);
}

#[test]
fn an_arm_without_any_bend_sensor_has_imu_o_alone() {
    let (mut against_model, mut against_float) = (Differences::default(), Differences::default());
    let (_, answers) = check(&Kind { bend: [0, 0], ..kind(1) }, &mut against_model, &mut against_float);
    against_model.assert_within("f64 core against the reference model, no bend sensor", 1e-7, 1e-7);
    against_float.assert_within("Q core against f64 core, no bend sensor", 1e-6, 2e-6);
    let has_angles =
        |shape: fn(&Answer) -> &Shape| answers.iter().any(|answer| shape(answer).theta.iter().any(Option::is_some));
    assert_eq!(
        [has_angles(|a| &a.bend), has_angles(|a| &a.imu_o), has_angles(|a| &a.imu_c), has_angles(|a| &a.fusion)],
        [false, true, false, false]
    );
}
