//! The same seed results in the same bits, on every machine and for all step sizes.

use crate::recording::{Sample, record, record_of};
use rig_twin::{Motion, MotionProgram, Rig, Scenario, Setup};

/// All readings and truths of a session in one number (FNV-1a).
fn checksum(samples: &[Sample]) -> u64 {
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let mut eat = |word: u64| {
        for byte in word.to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3);
        }
    };
    for sample in samples {
        sample.counts.iter().for_each(|&count| eat(u64::from(count)));
        sample.quaternions.iter().flatten().for_each(|&step| eat(step as u64));
        for pose in sample.truth {
            for number in [pose.x_m, pose.y_m, pose.heading_rad] {
                eat(number.to_bits());
            }
        }
    }
    hash
}

#[test]
fn same_seed_gives_the_same_bits() {
    let [first, second] = [(); 2].map(|()| checksum(&record(Scenario::Push, 5, 60)));
    assert_eq!(first, second);
}

#[test]
fn another_seed_differs() {
    let [first, second] = [5, 6].map(|seed| checksum(&record(Scenario::FreeSwing, seed, 1)));
    assert_ne!(first, second, "even at rest, by noise and power-up headings");
}

/// Fails if a platform, a compiler or a change of the twin changes any bit. If you changed the twin's behaviour on
/// purpose, copy the printed numbers here, and record the sessions that were made with the former twin again.
#[test]
fn bits_are_those_of_every_platform() {
    let found = [Scenario::Sweep, Scenario::FreeSwing, Scenario::Push, Scenario::Obstacle]
        .map(|scenario| checksum(&record(scenario, 1, 60)));
    let golden = [0x6000_896a_e7bf_f627, 0x08f5_859b_d9d9_691a, 0xd561_64b8_e133_2c20, 0x4f6c_6b18_cfb0_38f1];
    assert_eq!(found, golden, "found {found:#018x?}");
}

#[test]
fn bits_of_other_arms_and_motions_are_those_of_every_platform() {
    let found = [Motion::Swings, Motion::OneModule, Motion::Rests, Motion::BentStart, Motion::MovingStart]
        .map(|motion| checksum(&record_of(&Setup { arm_seed: 1, motion, ..Setup::new(Scenario::Obstacle, 1) }, 60)));
    let golden = [
        0xe19d_7c99_d9bd_c699,
        0xf5b6_9ad9_f19f_bc90,
        0xb76a_7819_d3a5_d4d8,
        0x884f_c69c_8db6_aaae,
        0x95d4_bcda_12e2_064a,
    ];
    assert_eq!(found, golden, "found {found:#018x?}");
}

#[test]
fn result_does_not_depend_on_how_time_is_cut() {
    let cuts: [&[f64]; 4] = [&[0.01], &[0.003, 0.0045, 0.0025], &[0.002; 5], &[1.0 / 84e6 * 1000.0; 840]];
    let [whole, others @ ..] = cuts.map(|cut| {
        let program = MotionProgram::new(Scenario::Push, 3);
        let mut rig = Rig::new(Scenario::Push, 3);
        for tick in 0..1500 {
            let duties = program.duties(f64::from(tick) * 0.01);
            for &dt_s in cut {
                rig.step(dt_s, &duties);
            }
        }
        (rig.truth(), rig.imu_quaternions(), rig.adc_counts())
    });
    for other in others {
        assert_eq!(whole, other);
    }
}

#[test]
fn reading_the_converter_disturbs_nothing_else() {
    let program = MotionProgram::new(Scenario::FreeSwing, 3);
    let mut quiet = Rig::new(Scenario::FreeSwing, 3);
    let mut busy = quiet.clone();
    for tick in 0..1000 {
        let duties = program.duties(f64::from(tick) * 0.01);
        quiet.step(0.01, &duties);
        busy.step(0.01, &duties);
        busy.adc_counts();
    }
    assert_eq!((quiet.truth(), quiet.imu_quaternions()), (busy.truth(), busy.imu_quaternions()));
}
