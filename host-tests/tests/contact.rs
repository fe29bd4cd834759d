//! Contact as the estimator tells it, against what touches the simulated arm.

use std::path::Path;

use calibration_tables::{AlikeKeys, ArmFile, ContactKeys, DriftKeys};
use estimator_core::{Estimator, ImuReading, Q, Sample};
use proprio::replay::HostEstimator;
use rig_twin::{Program, Push, Rig, SEGMENTS, Scenario};

const RATE_HZ: f64 = 10.0;
const TICKS: u32 = 10;
const SECONDS: f64 = 900.0;
const SEEDS: [u64; 3] = [71, 72, 73];

/// A run in which every segment is either touched or not in each sample.
struct Run {
    touched: Vec<[bool; SEGMENTS]>,
    pushes: Vec<Push>,
}

/// What the first segment's angle of a module is multiplied by to be the second's, as a sweep shows.
fn ratio(segment: usize) -> f64 {
    let (mut rig, program) = (Rig::new(Scenario::Sweep, 1), Program::new(Scenario::Sweep, 1));
    let (mut both, mut first) = (0.0, 0.0);
    while rig.time_s() < 300.0 {
        rig.step(1.0 / RATE_HZ, program.duties(rig.time_s()));
        let headings = rig.truth().map(|pose| pose.heading_rad);
        let theta = |i: usize| headings[i] - if i == 0 { 0.0 } else { headings[i - 1] };
        (both, first) = (both + theta(segment) * theta(segment - 1), first + theta(segment - 1).powi(2));
    }
    both / first
}

/// The reference table with the observer, and with what tells of contact.
fn table() -> ArmFile {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../calibration-tables/planar-6.toml");
    let mut table = ArmFile::load(&path).expect("the reference table");
    (table.drift, table.contact) = (Some(DriftKeys::observer()), Some(ContactKeys::default()));
    for segment in [1, 3, 5] {
        table.segments[segment].alike = Some(AlikeKeys { segment, ratio: ratio(segment) });
    }
    table
}

fn run(table: &ArmFile, scenario: Scenario, seed: u64) -> Run {
    let baked = table.bake::<Q>(RATE_HZ).expect("it is a table");
    let table = baked.table();
    let mut estimator: Box<HostEstimator<Q>> = Box::new(Estimator::new(&table).expect("it fits"));
    let (mut rig, program) = (Rig::new(scenario, seed), Program::new(scenario, seed));
    let mut touched = Vec::new();
    while rig.time_s() < SECONDS {
        let mut sample = Sample::missing((rig.time_s() * 1e6) as u64);
        for (i, counts) in rig.adc_counts().into_iter().enumerate() {
            sample.bend[i / 2][i % 2] = Some(counts);
        }
        for (i, registers) in rig.imu_quaternions().into_iter().enumerate() {
            sample.imu[i] = Some(ImuReading::from_bno055(registers));
        }
        estimator.step(&sample);
        let contacts = estimator.contacts();
        touched.push(core::array::from_fn(|i| contacts[i].is_touched));
        for _ in 0..TICKS {
            rig.step(1.0 / RATE_HZ / f64::from(TICKS), program.duties(rig.time_s()));
        }
    }
    Run { touched, pushes: rig.pushes().to_vec() }
}

#[test]
fn a_free_arm_is_touched_less_than_once_in_ten_minutes() {
    let table = table();
    let begins = SEEDS.map(|seed| {
        let run = run(&table, Scenario::One, seed);
        run.touched.windows(2).filter(|pair| pair[1] != [false; SEGMENTS] && pair[0] == [false; SEGMENTS]).count()
    });
    let minutes = SEEDS.len() as f64 * SECONDS / 60.0;
    let found: usize = begins.iter().sum();
    assert!((found as f64) < minutes / 10.0, "{begins:?} in {minutes} minutes");
}

#[test]
fn nine_in_ten_pushes_over_ten_degrees_are_found_within_half_a_second() {
    let table = table();
    let (mut found, mut all) = (0, 0);
    for seed in SEEDS {
        let Run { touched, pushes } = run(&table, Scenario::Two, seed);
        let at = |time_s: f64| (time_s * RATE_HZ).ceil() as usize;
        let strong = |push: &&Push| push.bend_rad.abs() > 10_f64.to_radians() && at(push.start_s + 0.5) < touched.len();
        for push in pushes.iter().filter(strong) {
            let within = at(push.start_s)..=at(push.start_s + 0.5);
            all += 1;
            found += usize::from(touched[within].iter().any(|touched| touched[push.segment]));
        }
    }
    assert!(all > 50 && found * 10 > all * 9, "{found} of {all}");
}
