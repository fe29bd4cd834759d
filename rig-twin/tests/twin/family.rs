//! Arms drawn from a seed: reproducible, unlike each other, and with every flaw.

use crate::recording::{Sample, bends_rad, counts, quaternions, record_of, tared_headings_rad, truth};
use rig_twin::{Motion, MotionProgram, Rig, SEGMENTS, Scenario, Setup};

fn setup(arm_seed: u64, scenario: Scenario, seed: u64) -> Setup {
    Setup { arm_seed, ..Setup::new(scenario, seed) }
}

fn session(arm_seed: u64, scenario: Scenario, seed: u64, seconds: u32) -> Vec<Sample> {
    record_of(&setup(arm_seed, scenario, seed), seconds)
}

fn readings(samples: &[Sample]) -> Vec<([u16; 2 * SEGMENTS], [[i16; 4]; SEGMENTS])> {
    samples.iter().map(|sample| (sample.counts, sample.quaternions)).collect()
}

/// Least-squares slope of y over x, of their changes from one second to the next.
fn gain(x: &[f64], y: &[f64]) -> f64 {
    let changes = |values: &[f64]| values.windows(11).map(|window| window[10] - window[0]).collect::<Vec<f64>>();
    let (dx, dy) = (changes(x), changes(y));
    let product: f64 = dx.iter().zip(&dy).map(|(dx, dy)| dx * dy).sum();
    product / dx.iter().map(|dx| dx * dx).sum::<f64>()
}

#[test]
fn seed_zero_is_the_reference_arm() {
    let of_family = session(0, Scenario::Push, 5, 30);
    let (program, mut rig) = (MotionProgram::new(Scenario::Push, 5), Rig::new(Scenario::Push, 5));
    for sample in of_family {
        (0..10).for_each(|_| rig.step(0.01, &program.duties(rig.time_s())));
        assert_eq!((sample.counts, sample.quaternions), (counts(&mut rig), quaternions(&rig)));
    }
}

#[test]
fn same_arm_seed_gives_the_same_bits() {
    let [first, second] = [(); 2].map(|()| readings(&session(9, Scenario::Push, 5, 20)));
    assert_eq!(first, second);
}

#[test]
fn two_arm_seeds_differ() {
    let [first, second] = [1, 2].map(|arm_seed| session(arm_seed, Scenario::FreeSwing, 5, 20));
    assert_ne!(readings(&first), readings(&second));
    assert_ne!(first[199].truth, second[199].truth);
}

#[test]
fn straight_arms_have_lengths_within_two_percent_of_the_nominal_one() {
    let lengths: Vec<f64> = (1..=12).map(|arm| Rig::of(&setup(arm, Scenario::FreeSwing, 1)).truth()[5].y_m).collect();
    assert!(lengths.iter().all(|length| (length / 0.582 - 1.0).abs() < 0.02), "{lengths:?}");
    assert!(lengths.iter().any(|length| (length / 0.582 - 1.0).abs() > 0.001), "{lengths:?}");
}

#[test]
fn scale_error_changes_the_gain_of_the_heading() {
    let gains: Vec<f64> = (1..=4)
        .map(|arm| {
            let samples = session(arm, Scenario::Sweep, 1, 300);
            let true_rad: Vec<f64> = samples.iter().map(|sample| sample.truth[5].heading_rad).collect();
            let read_rad: Vec<f64> = tared_headings_rad(&samples).iter().map(|row| row[5]).collect();
            gain(&true_rad, &read_rad)
        })
        .collect();
    assert!(gains.iter().all(|gain| (0.965..1.035).contains(gain)), "{gains:?}");
    assert!(gains.iter().any(|gain| (gain - 1.0).abs() > 0.01), "{gains:?}");
}

#[test]
fn turn_on_bias_differs_from_session_to_session() {
    let drift_deg = |seed| {
        let samples = session(3, Scenario::FreeSwing, seed, 600);
        let last = samples.len() - 1;
        (tared_headings_rad(&samples)[last][0] - samples[last].truth[0].heading_rad).to_degrees()
    };
    let drifts: Vec<f64> = (1..=4).map(drift_deg).collect();
    let mean = drifts.iter().sum::<f64>() / 4.0;
    assert!(drifts.iter().any(|drift| (drift - mean).abs() > 2.0), "{drifts:?}");
    assert!(drifts.iter().all(|drift| drift.abs() < 80.0), "{drifts:?}");
}

#[test]
fn two_segments_of_a_module_bend_by_more_than_a_degree_apart() {
    for arm in 1..=6 {
        let samples = session(arm, Scenario::Sweep, 1, 100);
        let apart = samples.iter().flat_map(|sample| {
            let bends = bends_rad(&sample.truth);
            [0, 2, 4].map(|first| (bends[first] - bends[first + 1]).abs().to_degrees())
        });
        let apart = apart.fold(0.0, f64::max);
        assert!(apart > 1.5, "arm {arm}: {apart}°");
    }
}

/// Readings of a vented arm, 1000 conversions of a strip, counts: of a session, after `after_s`.
fn counts_at_rest(arm_seed: u64, seed: u64, after_s: f64) -> [f64; 2 * SEGMENTS] {
    let mut rig = Rig::of(&setup(arm_seed, Scenario::FreeSwing, seed));
    rig.step(after_s, &[0.0; 6]);
    let mut sums = [0.0; 2 * SEGMENTS];
    for _ in 0..1000 {
        sums.iter_mut().zip(counts(&mut rig)).for_each(|(sum, count)| *sum += f64::from(count) / 1000.0);
    }
    sums
}

#[test]
fn strips_creep_and_warm_up_for_minutes_at_rest() {
    let [early, late] = [10.0, 900.0].map(|after_s| counts_at_rest(1, 1, after_s));
    let moved = early.iter().zip(late).map(|(early, late)| (early - late).abs()).fold(0.0, f64::max);
    assert!(moved > 5.0, "{moved} counts");
}

/// Spread over sessions of the common-mode error of both strips of a segment, counts: mean over the segments.
fn shared_spread(arm_seed: u64) -> f64 {
    let sessions: Vec<_> = (1..=12).map(|seed| counts_at_rest(arm_seed, seed, 5.0)).collect();
    let deviation = |segment: usize| {
        let bends: Vec<f64> =
            sessions.iter().map(|counts| (counts[2 * segment] - counts[2 * segment + 1]) / 2.0).collect();
        let mean = bends.iter().sum::<f64>() / bends.len() as f64;
        f64::sqrt(bends.iter().map(|bend| (bend - mean).powi(2)).sum::<f64>() / bends.len() as f64)
    };
    (0..SEGMENTS).map(deviation).sum::<f64>() / SEGMENTS as f64
}

#[test]
fn some_arms_have_pairs_of_strips_that_err_alike_far_more_than_others() {
    let spreads: Vec<f64> = (1..=12).map(shared_spread).collect();
    let (low, high) = spreads.iter().fold((f64::MAX, 0.0_f64), |(low, high), &s| (low.min(s), high.max(s)));
    assert!(high > 1.5 * low, "{spreads:?}");
}

#[test]
fn regulators_differ_so_that_the_same_duty_bends_by_other_angles() {
    let bends: Vec<f64> = (1..=6)
        .map(|arm| {
            let mut rig = Rig::of(&Setup { motion: Motion::Swings, ..setup(arm, Scenario::FreeSwing, 1) });
            rig.step(60.0, &[0.6, 0.0, 0.0, 0.0, 0.0, 0.0]);
            bends_rad(&truth(&rig))[0].to_degrees()
        })
        .collect();
    let (low, high) = bends.iter().fold((f64::MAX, f64::MIN), |(low, high), &b| (low.min(b), high.max(b)));
    assert!(low > 20.0 && high < 80.0 && high - low > 5.0, "{bends:?}");
}
