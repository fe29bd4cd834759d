//! Instructions of the estimator's step, in a firmware that runs nothing else.

use board_tests::elf;
use object::{Object, ObjectSymbol};
use rig_twin::Scenario;
use virtual_due::{CYCLES_PER_SECOND, Machine, WiredRig};

use crate::figure::Figure;

/// Segments of the arms that the firmware steps, in its order.
const SEGMENTS: [u32; 4] = [1, 2, 6, 8];
const STEPS: usize = 1_000;
/// Further samples at rest of an arm with the bias filter.
const REST: usize = 3_000;
/// Samples of the tare, the first ones.
const TARE: usize = 100;

/// Names of routines of the compiler and the core library that do not belong into the step: float arithmetic, float
/// conversions, 64-bit division, panics.
const UNWANTED: [&str; 9] =
    ["__aeabi_f", "__aeabi_d", "__aeabi_i2", "__aeabi_ui2", "__aeabi_l2", "__aeabi_ul2", "divmod", "divdi", "panic"];

/// Fewest and most instructions of a step.
struct Range {
    least: u64,
    most: u64,
}

impl Range {
    fn of(counts: &[u64]) -> Self {
        let least = counts.iter().copied().min().unwrap_or_default();
        Self { least, most: counts.iter().copied().max().unwrap_or_default() }
    }
}

/// Figures of the step.
///
/// # Panics
/// If the firmware does not build, or does not step the expected arms.
pub fn figures() -> [Figure; 8] {
    let growth = arms("growth", &SEGMENTS);
    let [(_, tare, after)] = &arms("step", &[6])[..] else { panic!("the firmware steps one arm") };
    let [(_, _, bias_filter)] = &arms_of("bias_filter", &[6], STEPS + REST)[..] else {
        panic!("the firmware steps one arm")
    };
    let [(_, _, of_eight)] = &arms_of("bias_filter_growth", &[8], STEPS + REST)[..] else {
        panic!("the firmware steps one arm")
    };
    let for_each =
        |arm: usize| growth.get(arm).map_or(f64::NAN, |(segments, _, after)| after.most as f64 / f64::from(*segments));
    [
        Figure { name: "step_instructions", value: after.most as f64 },
        Figure { name: "step_in_tare", value: tare.most as f64 },
        Figure { name: "step_spread", value: (after.most - after.least) as f64 / after.least as f64 * 100.0 },
        Figure { name: "step_growth", value: for_each(3) / for_each(2) },
        Figure { name: "step_routines", value: unwanted(&elf("on-target-tests", "step")) as f64 },
        Figure { name: "bias_filter_instructions", value: bias_filter.most as f64 },
        Figure { name: "bias_filter_growth", value: of_eight.most as f64 / 8.0 / (bias_filter.most as f64 / 6.0) },
        Figure { name: "bias_filter_routines", value: unwanted(&elf("on-target-tests", "bias_filter")) as f64 },
    ]
}

/// Segments, steps in the tare and steps after it, of each arm that a firmware steps.
fn arms(binary: &str, segments: &[u32]) -> Vec<(u32, Range, Range)> {
    arms_of(binary, segments, STEPS)
}

/// The same for so many samples of each arm.
fn arms_of(binary: &str, segments: &[u32], steps: usize) -> Vec<(u32, Range, Range)> {
    let mut machine = Machine::new(&elf("on-target-tests", binary), WiredRig::new(Scenario::FreeSwing, 1))
        .expect("a firmware for the Due");
    println!("instructions of a step   in the tare          after it");
    let arm = |segments: &u32| {
        let counts = counts(&mut machine, steps);
        let (tare, after) = counts.split_at(TARE);
        let (tare, after) = (Range::of(tare), Range::of(after));
        println!(
            "{segments:>8} segments     {:>6} to {:>6}  {:>6} to {:>6}",
            tare.least, tare.most, after.least, after.most
        );
        (*segments, tare, after)
    };
    let arms = segments.iter().map(arm).collect();
    assert_eq!(machine.resets(), [], "the firmware steps through all arms at once");
    arms
}

/// Instructions of the next arm's steps, each with the two calls around it.
fn counts(machine: &mut Machine<WiredRig>, steps: usize) -> Vec<u64> {
    let [begins, ends] = ["step_begins", "step_ends"].map(|name| machine.symbol(name).expect("the firmware has it"));
    let mut run_to = |address| {
        let limit = machine.now() + CYCLES_PER_SECOND;
        assert!(machine.run_to(address, limit), "the firmware steps on");
        machine.instructions()
    };
    (0..steps)
        .map(|_| {
            let before = run_to(begins);
            run_to(ends) - before
        })
        .collect()
}

/// Number of unwanted routines, each of which is printed.
fn unwanted(elf: &[u8]) -> usize {
    let file = object::File::parse(elf).expect("cargo built an ELF");
    let names = file.symbols().filter_map(|symbol| symbol.name().ok());
    names
        .filter(|name| UNWANTED.iter().any(|unwanted| name.contains(unwanted)))
        .inspect(|name| println!("{name}"))
        .count()
}
