//! The CPU engine on small firmwares: the board's arithmetic is the host's, and interrupts follow ARM's manual.

use board_tests::{UART, elf};
use on_target_tests::arithmetic::hashes;
use rig_twin::Scenario;
use virtual_due::{CYCLES_PER_SECOND, Machine, WiredRig};

/// Runs an on-target test to its end; returns its output.
fn output_of(test: &str) -> String {
    let mut machine = Machine::new(&elf("on-target-tests", test), WiredRig::new(Scenario::FreeSwing, 1))
        .expect("a firmware for the Due");
    let mut text = String::new();
    for _ in 0..1_000 {
        machine.run_for(CYCLES_PER_SECOND / 10);
        let bytes = machine.world_mut().take_transmitted(UART);
        text.extend(bytes.into_iter().map(|(_, byte)| char::from(byte)));
        if let Some(output) = text.strip_suffix("end\n") {
            assert!(machine.reports().is_empty() && machine.resets().is_empty(), "{test} does nothing out of order");
            return output.to_owned();
        }
    }
    panic!("{test} does not end; its output: {text}");
}

/// The same hashes of the arithmetic, computed on this host, as the board prints them.
fn hashes_of_the_host(inputs: u32) -> String {
    let lines: Vec<String> = hashes(inputs).map(|(name, hash)| format!("{name} {hash:08x}\n")).collect();
    lines.concat()
}

#[test]
fn the_boards_arithmetic_is_the_hosts_on_a_million_random_inputs() {
    assert_eq!(output_of("arithmetic"), hashes_of_the_host(1_000_000));
}

#[test]
fn interrupts_anywhere_leave_the_arithmetic_alone() {
    let output = output_of("interrupted");
    let (hashes, counts) = output.split_at(output.find("interrupts").expect("it counts them"));
    assert_eq!(hashes, hashes_of_the_host(50_000));
    let counts: Vec<u32> = counts.lines().filter_map(|line| line.rsplit(' ').next()?.parse().ok()).collect();
    let [interrupts, in_it_blocks] = counts[..] else { panic!("{output}") };
    assert!(interrupts > 100_000 && in_it_blocks > 1_000, "{interrupts} interrupts, {in_it_blocks} inside IT blocks");
}

/// Expected by ARMv7-M, B1.5.4 (priorities, BASEPRI, PRIMASK) and B1.5.8 (what is pending at a return is next).
#[test]
fn tasks_preempt_wait_and_follow_each_other_by_their_priorities() {
    let expected = "\
        lock L(.Hh)Mml\n\
        nested L({.}Hh)Mml\n\
        chain LMHhml\n\
        from-above H.hMmLl\n\
        again M.mMm\n\
        critical [...]HhMmLl\n\
        equals [..]MmNn\n\
        unpended Ll\n";
    assert_eq!(output_of("preemption"), expected);
}
