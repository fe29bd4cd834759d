use super::Tc;
use crate::model::{Peripheral, Pin, Side, Signal};
use crate::test_support::Bench;

pub const CCR: u32 = 0x00;
pub const CMR: u32 = 0x04;
pub const CV: u32 = 0x10;
pub const RA: u32 = 0x14;
const RB: u32 = 0x18;
pub const RC: u32 = 0x1C;
pub const SR: u32 = 0x20;
pub const IER: u32 = 0x24;
const BCR: u32 = 0xC0;
const WPMR: u32 = 0xE4;

pub const START: u32 = 0b101;
const CLKDIS: u32 = 0b10;
const COVFS: u32 = 1 << 0;
const LOVRS: u32 = 1 << 1;
const CPAS: u32 = 1 << 2;
const CPBS: u32 = 1 << 3;
pub const CPCS: u32 = 1 << 4;
const LDRAS: u32 = 1 << 5;
const LDRBS: u32 = 1 << 6;
pub const ETRGS: u32 = 1 << 7;
const CLKSTA: u32 = 1 << 16;
const MTIOA: u32 = 1 << 17;
const MTIOB: u32 = 1 << 18;

pub const WAVE: u32 = 1 << 15;
pub const UP_RC: u32 = 2 << 13;
const UP_DOWN_RC: u32 = 3 << 13;
/// TIOA: set by RA, cleared by RC.
pub const A_PULSE: u32 = 1 << 16 | 2 << 18;
pub const EEVT_XC0: u32 = 1 << 10;

/// Channel 0 of TC0 with these registers, started at time 0.
fn started(mode: u32, ra: u32, rb: u32, rc: u32) -> Bench<Tc> {
    let mut bench = Bench::new(Tc::new(0));
    for (offset, value) in [(CMR, mode), (RA, ra), (RB, rb), (RC, rc), (CCR, START)] {
        bench.write(offset, value);
    }
    bench
}

#[test]
fn each_clock_divides_the_master_clock_or_is_the_slow_clock() {
    for (selection, cycles_per_1000_ticks) in [(0, 2000), (1, 8000), (2, 32_000), (3, 128_000), (4, 2_563_477)] {
        let mut bench = started(WAVE | selection, 0, 0, 0);
        bench.run(cycles_per_1000_ticks - 1);
        assert_eq!(bench.read(CV), 999, "TIMER_CLOCK{}", selection + 1);
        bench.run(1);
        assert_eq!(bench.read(CV), 1000, "TIMER_CLOCK{}", selection + 1);
    }
}

#[test]
fn rc_ends_a_period_of_rc_ticks_and_reading_status_clears_it() {
    let mut bench = started(WAVE | UP_RC, 0, 0, 100);
    bench.run(199);
    assert_eq!((bench.read(CV), bench.read(SR) & CPCS), (99, 0));
    bench.run(1);
    assert_eq!((bench.read(CV), bench.read(SR) & CPCS), (0, CPCS));
    assert_eq!(bench.read(SR) & CPCS, 0);
    bench.run(200 * 1000);
    assert_eq!((bench.read(CV), bench.read(SR) & CPCS), (0, CPCS));
}

#[test]
fn rising_edges_of_tioa_come_at_exact_times() {
    let mut bench = started(WAVE | UP_RC | A_PULSE, 25, 0, 100);
    bench.run(1000);
    assert_eq!(bench.signals, [50, 250, 450, 650, 850].map(|at| (at, Signal::Tioa(0))));
    assert_eq!(bench.read(SR) & MTIOA, 0);
    bench.run(50);
    assert_eq!(bench.read(SR) & MTIOA, MTIOA);
}

#[test]
fn edges_stop_the_run_one_by_one() {
    let mut bench = started(WAVE | UP_RC | A_PULSE, 25, 0, 100);
    assert_eq!(bench.model.next_event(), Some(50));
    bench.run(50);
    assert_eq!(bench.model.next_event(), Some(200));
}

#[test]
fn interrupt_of_one_channel_is_not_that_of_another() {
    let mut bench = Bench::new(Tc::new(1));
    for (offset, value) in [(0x40 + CMR, WAVE | UP_RC), (0x40 + RC, 10), (0x40 + IER, CPCS), (0x40 + CCR, START)] {
        bench.write(offset, value);
    }
    bench.run(20);
    assert_eq!(bench.model.interrupts(), 0b010);
    bench.read(0x40 + SR);
    assert_eq!(bench.model.interrupts(), 0);
}

#[test]
fn up_down_meets_registers_both_ways() {
    let mut bench = started(WAVE | UP_DOWN_RC | 3 << 16, 30, 0, 100);
    bench.run(2 * 130);
    assert_eq!(bench.read(CV), 70);
    bench.run(2 * 70);
    assert_eq!(bench.read(CV), 0);
    assert_eq!(bench.signals, [(60, Signal::Tioa(0))], "set on the way up, cleared on the way down");
    bench.run(2 * 100);
    assert_eq!(bench.read(CV), 100);
    assert_eq!(bench.signals[1..], [(460, Signal::Tioa(0))]);
}

#[test]
fn counter_that_was_on_its_way_down_goes_up_in_another_mode() {
    let mut bench = started(WAVE | UP_DOWN_RC, 0, 0, 100);
    bench.run(2 * 150);
    bench.write(CMR, WAVE);
    bench.run(2 * 10);
    assert_eq!(bench.read(CV), 60);
}

#[test]
fn up_down_without_a_top_still_counts() {
    let mut bench = started(WAVE | UP_DOWN_RC, 0, 0, 0);
    bench.run(2 * ((1 << 32) + 5));
    assert_eq!(bench.read(CV), 5);
}

#[test]
fn tiob_follows_rb_and_rc_unless_it_is_the_external_event() {
    for (event, high, compared) in [(EEVT_XC0, MTIOB, CPBS), (0, 0, 0)] {
        let mut bench = started(WAVE | UP_RC | 1 << 24 | 2 << 26 | event, 0, 10, 100);
        bench.run(21);
        assert_eq!(bench.read(SR) & (MTIOB | CPBS), high | compared);
        bench.run(180);
        assert_eq!(bench.read(SR) & MTIOB, 0);
    }
}

#[test]
fn clock_stops_or_is_disabled_at_rc() {
    for (bit, enabled) in [(6, CLKSTA), (7, 0)] {
        let mut bench = started(WAVE | UP_RC | 1 << bit, 0, 0, 100);
        bench.run(1000);
        assert_eq!(bench.read(CV), 0);
        assert_eq!(bench.read(SR) & (CPCS | CLKSTA), CPCS | enabled);
        bench.run(1000);
        assert_eq!(bench.read(SR) & CPCS, 0, "there is only one period");
    }
}

#[test]
fn disabled_clock_keeps_its_value_until_a_trigger() {
    let mut bench = started(WAVE, 0, 0, 0);
    bench.run(20);
    bench.write(CCR, CLKDIS | 1);
    bench.run(1000);
    assert_eq!((bench.read(CV), bench.read(SR) & CLKSTA), (10, 0));
    bench.write(CCR, START);
    bench.run(6);
    assert_eq!((bench.read(CV), bench.read(SR) & CLKSTA), (3, CLKSTA));
}

#[test]
fn enabled_clock_waits_for_a_trigger_and_sync_triggers_all() {
    let mut bench = Bench::new(Tc::new(0));
    for channel in 0..3 {
        bench.write(0x40 * channel + CMR, WAVE);
        bench.write(0x40 * channel + CCR, 1);
    }
    bench.run(100);
    assert_eq!(bench.read(CV), 0);
    bench.write(BCR, 1);
    bench.run(100);
    for channel in 0..3 {
        assert_eq!(bench.read(0x40 * channel + CV), 50);
    }
}

#[test]
fn counter_overflows_at_32_bits() {
    let mut bench = started(WAVE, 7, 0, 0);
    bench.run(2 * 0xFFFF_FFFF);
    assert_eq!((bench.read(CV), bench.read(SR) & (COVFS | CPAS)), (0xFFFF_FFFF, CPAS));
    bench.run(2);
    assert_eq!((bench.read(CV), bench.read(SR) & COVFS), (0, COVFS));
}

#[test]
fn register_written_behind_the_counter_is_met_in_the_next_period() {
    let mut bench = started(WAVE | UP_RC, 50, 0, 100);
    bench.run(120);
    bench.read(SR);
    bench.write(RA, 20);
    bench.run(70);
    assert_eq!(bench.read(SR) & CPAS, 0);
    bench.run(50);
    assert_eq!(bench.read(SR) & CPAS, CPAS);
}

#[test]
fn software_trigger_sets_outputs() {
    let mut bench = started(WAVE | 1 << 22 | 1 << 30 | EEVT_XC0, 0, 0, 0);
    assert_eq!(bench.read(SR) & (MTIOA | MTIOB), MTIOA | MTIOB);
    bench.write(CMR, WAVE | 2 << 22 | 2 << 30 | EEVT_XC0);
    bench.write(CCR, 4);
    assert_eq!(bench.read(SR) & (MTIOA | MTIOB), 0);
}

#[test]
fn capture_loads_ra_and_rb_and_flags_lost_values() {
    // RA on rising, RB on falling edges.
    let mut bench = started(1 << 16 | 2 << 18, 0, 0, 0);
    let edge = |bench: &mut Bench<Tc>, at: u64, level: bool| {
        bench.run(at - bench.now);
        bench.world.levels.insert(Pin { port: 1, line: 25 }, level);
        bench.run(0);
    };
    edge(&mut bench, 100, true);
    edge(&mut bench, 260, false);
    assert_eq!(bench.read(SR) & (LDRAS | LDRBS | LOVRS), LDRAS | LDRBS);
    assert_eq!((bench.read(RA), bench.read(RB)), (50, 130));
    edge(&mut bench, 300, true);
    edge(&mut bench, 400, false);
    edge(&mut bench, 500, true);
    assert_eq!(bench.read(SR) & (LDRAS | LDRBS | LOVRS | ETRGS), LDRAS | LDRBS | LOVRS);
}

#[test]
fn external_event_on_tiob_triggers_and_sets_tioa() {
    let mut bench = started(WAVE | 1 << 8 | 1 << 12 | 1 << 20, 0, 0, 0);
    bench.run(100);
    bench.world.levels.insert(Pin { port: 1, line: 27 }, true);
    bench.run(0);
    assert_eq!(bench.signals, [(100, Signal::Tioa(0))]);
    bench.run(10);
    assert_eq!((bench.read(CV), bench.read(SR) & (ETRGS | MTIOA)), (5, ETRGS | MTIOA));
}

#[test]
fn compare_in_capture_mode_may_restart_the_counter() {
    let mut bench = started(1 << 14, 0, 0, 100);
    bench.run(2 * 130);
    assert_eq!((bench.read(CV), bench.read(SR) & CPCS), (30, CPCS));
}

#[test]
fn slower_master_clock_slows_the_counter_from_then_on() {
    let mut bench = started(WAVE, 0, 0, 0);
    bench.run(200);
    bench.master_clock_hz = 12_000_000;
    bench.with(|tc, context| tc.signal(Signal::MasterClock(12_000_000), context));
    bench.run(140);
    assert_eq!(bench.read(CV), 110);
}

#[test]
fn write_protection_keeps_the_registers() {
    let mut bench = started(WAVE, 1, 2, 3);
    bench.write(WPMR, 0x5449_4D01);
    bench.write(RC, 9);
    assert_eq!(bench.read(RC), 3);
}

#[test]
fn tioa_is_an_output_in_waveform_mode() {
    let tioa = Pin { port: 1, line: 25 };
    let mut bench = started(WAVE | UP_RC | A_PULSE, 25, 0, 100);
    assert_eq!(bench.model.output(tioa, Side::B, 0), Some(false));
    bench.run(50);
    assert_eq!(bench.model.output(tioa, Side::B, 50), Some(true));
    assert_eq!(bench.model.output(tioa, Side::A, 50), None);
    bench.write(CMR, 0);
    assert_eq!(bench.model.output(tioa, Side::B, 50), None);
}
