//! Boots and crashes are counted over resets, and a boot loop is detected.

use board_core::{BootCounter, CRASHES, RETAINED_WORDS, UPTIME_WORD, WINDOW_TICKS};
use proptest::prelude::*;
use telemetry::ResetCause;

/// Words of a boot that ends after some ticks.
fn after(boot: &BootCounter, ticks: u32) -> [u32; RETAINED_WORDS] {
    let mut words = boot.retained();
    words[UPTIME_WORD] = boot.uptime(ticks);
    words
}

fn power_on() -> BootCounter {
    BootCounter::start([0; RETAINED_WORDS], ResetCause::PowerOn, false)
}

fn next(boot: &BootCounter, ticks: u32, cause: ResetCause) -> BootCounter {
    BootCounter::start(after(boot, ticks), cause, false)
}

#[test]
fn power_on_is_the_first_boot_with_any_words() {
    let retained = after(&next(&power_on(), 10, ResetCause::Watchdog), 10);
    for words in [[0; RETAINED_WORDS], [u32::MAX; RETAINED_WORDS], retained] {
        let boot = BootCounter::start(words, ResetCause::PowerOn, false);
        assert_eq!((boot.number(), boot.crashes(), boot.safe_mode()), (1, 0, false));
        assert_eq!(boot.uptime(7), 7);
    }
}

#[test]
fn every_reset_counts_and_only_crashes_count_as_crashes() {
    let mut boot = power_on();
    for (number, (cause, panicked, crashes)) in (2..).zip([
        (ResetCause::Pin, false, 0),
        (ResetCause::Software, false, 0),
        (ResetCause::Software, true, 1),
        (ResetCause::Watchdog, false, 2),
        (ResetCause::Pin, true, 3),
        (ResetCause::Backup, false, 3),
    ]) {
        boot = BootCounter::start(after(&boot, 10 * WINDOW_TICKS), cause, panicked);
        assert_eq!((boot.number(), boot.crashes()), (number, crashes));
    }
}

#[test]
fn three_crashes_within_a_minute_are_a_boot_loop() {
    let mut boot = next(&power_on(), 1_000_000, ResetCause::Watchdog);
    assert!(!boot.safe_mode());
    boot = next(&boot, WINDOW_TICKS / 2, ResetCause::Watchdog);
    assert!(!boot.safe_mode());
    boot = next(&boot, WINDOW_TICKS / 2, ResetCause::Watchdog);
    assert!(boot.safe_mode());
}

#[test]
fn three_crashes_in_more_than_a_minute_are_no_boot_loop() {
    let mut boot = next(&power_on(), 1_000_000, ResetCause::Watchdog);
    boot = next(&boot, WINDOW_TICKS / 2, ResetCause::Watchdog);
    boot = next(&boot, WINDOW_TICKS / 2 + 1, ResetCause::Watchdog);
    assert!(!boot.safe_mode());
}

#[test]
fn two_crashes_right_after_power_on_are_no_boot_loop() {
    let boot = next(&next(&power_on(), 0, ResetCause::Watchdog), 0, ResetCause::Watchdog);
    assert!(!boot.safe_mode());
    assert!(next(&boot, 0, ResetCause::Watchdog).safe_mode());
}

#[test]
fn resets_between_crashes_do_not_hide_a_boot_loop() {
    let mut boot = power_on();
    for crashes in 1..=CRASHES {
        boot = next(&boot, 100, ResetCause::Watchdog);
        boot = next(&boot, 100, ResetCause::Pin);
        assert_eq!(boot.safe_mode(), crashes == CRASHES);
    }
}

#[test]
fn safe_mode_outlasts_other_resets_until_the_minute_is_over() {
    let mut boot = power_on();
    for _ in 0..CRASHES {
        boot = next(&boot, 0, ResetCause::Watchdog);
    }
    boot = next(&boot, WINDOW_TICKS, ResetCause::Pin);
    assert!(boot.safe_mode());
    boot = next(&boot, 1, ResetCause::Software);
    assert!(!boot.safe_mode());
}

#[test]
fn three_crashes_before_the_first_tick_are_a_start_that_fails() {
    let mut boot = next(&power_on(), 500, ResetCause::Pin);
    for _ in 0..3 {
        assert!(!boot.fails_to_start());
        boot = next(&boot, 0, ResetCause::Watchdog);
    }
    assert!(boot.fails_to_start());
    assert!(!next(&boot, 1, ResetCause::Software).fails_to_start(), "it has started");
}

#[test]
fn crashes_after_the_first_tick_are_no_start_that_fails() {
    let mut boot = power_on();
    for _ in 0..3 {
        boot = next(&boot, 2, ResetCause::Watchdog);
    }
    assert!(boot.safe_mode() && !boot.fails_to_start());
}

#[test]
fn power_on_ends_safe_mode() {
    let mut boot = power_on();
    for _ in 0..CRASHES {
        boot = next(&boot, 0, ResetCause::Watchdog);
    }
    assert!(!next(&boot, 0, ResetCause::PowerOn).safe_mode());
}

#[test]
fn uptime_is_counted_across_resets() {
    let boot = next(&next(&power_on(), 500, ResetCause::Pin), 300, ResetCause::Watchdog);
    assert_eq!(boot.uptime(20), 820);
}

#[test]
fn a_boot_loop_is_detected_while_the_uptime_wraps() {
    let mut boot = next(&power_on(), u32::MAX - 50, ResetCause::Watchdog);
    boot = next(&boot, 100, ResetCause::Watchdog);
    boot = next(&boot, 100, ResetCause::Watchdog);
    assert!(boot.safe_mode());
}

proptest! {
    #[test]
    fn random_words_restart_the_count(words in prop::array::uniform7(any::<u32>())) {
        let boot = BootCounter::start(words, ResetCause::Pin, false);
        prop_assert_eq!((boot.number(), boot.crashes(), boot.safe_mode()), (1, 0, false));
    }

    #[test]
    fn a_single_damaged_word_starts_the_count_anew(word in 0..UPTIME_WORD, damage in 1..=u32::MAX) {
        let mut words = after(&next(&power_on(), 100, ResetCause::Watchdog), 100);
        words[word] ^= damage;
        prop_assert_eq!(BootCounter::start(words, ResetCause::Pin, false).number(), 1);
    }
}
