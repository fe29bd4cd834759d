use super::Tc;
use super::tests::{A_PULSE, CCR, CMR, CPCS, CV, EEVT_XC0, ETRGS, IER, RA, RC, SR, START, UP_RC, WAVE};
use crate::model::{Peripheral, Signal};
use crate::test_support::Bench;

const BMR: u32 = 0xC4;
const XC0: u32 = 5;
const XC1: u32 = 6;
const XC2: u32 = 7;
const CLKI: u32 = 1 << 3;
const CHANNEL: u32 = 0x40;

/// Channel 2 divides MCK/2 by 42: its TIOA rises every microsecond, first after half of one.
const MICROSECOND: u64 = 84;

fn write(bench: &mut Bench<Tc>, channel: u32, registers: &[(u32, u32)]) {
    for (offset, value) in registers {
        bench.write(CHANNEL * channel + offset, *value);
    }
}

/// Channel 0 counts microseconds, with compare values, at time 0.
fn microseconds(mode: u32, rc: u32) -> Bench<Tc> {
    let mut bench = Bench::new(Tc::new(1));
    bench.write(BMR, 3);
    write(&mut bench, 0, &[(CMR, WAVE | EEVT_XC0 | XC0 | mode), (RC, rc), (CCR, START)]);
    write(&mut bench, 2, &[(CMR, WAVE | UP_RC | A_PULSE), (RA, 21), (RC, 42), (CCR, START)]);
    bench
}

#[test]
fn channel_counts_the_rises_of_the_tioa_that_clocks_it() {
    let mut bench = microseconds(0, 0);
    bench.run(MICROSECOND / 2 - 1);
    assert_eq!(bench.read(CV), 0);
    bench.run(1);
    assert_eq!(bench.read(CV), 1);
    bench.run(1_000_000 * MICROSECOND);
    assert_eq!(bench.read(CV), 1_000_001);
    assert!(bench.reports().is_empty());
}

#[test]
fn channel_with_clki_counts_the_falls() {
    let mut bench = microseconds(CLKI, 0);
    bench.run(MICROSECOND - 1);
    assert_eq!(bench.read(CV), 0);
    bench.run(1);
    assert_eq!(bench.read(CV), 1);
}

#[test]
fn compare_of_a_chained_channel_interrupts_at_its_edge() {
    let mut bench = microseconds(0, 1000);
    bench.write(IER, CPCS);
    let edge = 999 * MICROSECOND + MICROSECOND / 2;
    bench.run(edge - 1);
    assert_eq!(bench.model.interrupts(), 0);
    bench.run(1);
    assert_eq!(bench.model.interrupts(), 1);
    assert_eq!(bench.read(SR) & CPCS, CPCS);
}

#[test]
fn compare_of_a_chained_channel_costs_one_event() {
    let mut bench = microseconds(0, 1_000_000);
    bench.write(IER, CPCS);
    assert_eq!(bench.model.next_event(), Some(999_999 * MICROSECOND + MICROSECOND / 2));
}

#[test]
fn three_channels_in_a_row_divide_one_by_the_other() {
    let mut bench = Bench::new(Tc::new(0));
    // TC0_BMR: XC1 = TIOA0, XC2 = TIOA1. Channel 0 rises every 10 ticks of MCK/2, channel 1 with every 10th of them.
    bench.write(BMR, 2 << 2 | 3 << 4);
    write(&mut bench, 0, &[(CMR, WAVE | UP_RC | A_PULSE), (RA, 5), (RC, 10), (CCR, START)]);
    write(&mut bench, 1, &[(CMR, WAVE | UP_RC | A_PULSE | XC1), (RA, 5), (RC, 10), (CCR, START)]);
    write(&mut bench, 2, &[(CMR, WAVE | UP_RC | XC2), (RC, 3), (IER, CPCS), (CCR, START)]);
    // The fifth rise of TIOA0 is at tick 45; the third of TIOA1 comes 20 rises later.
    bench.run(2 * 245 - 1);
    assert_eq!((bench.read(2 * CHANNEL + CV), bench.model.interrupts()), (2, 0));
    bench.run(1);
    assert_eq!((bench.read(2 * CHANNEL + CV), bench.model.interrupts()), (0, 4));
    let rises = [45, 145, 245].map(|tick| (2 * tick, Signal::Tioa(1)));
    let signalled: Vec<_> = bench.signals.iter().filter(|(_, signal)| *signal == Signal::Tioa(1)).copied().collect();
    assert_eq!(signalled, rises);
}

#[test]
fn software_trigger_of_the_source_is_an_edge_of_the_chained_clock() {
    let mut bench = Bench::new(Tc::new(1));
    bench.write(BMR, 2 << 2);
    write(&mut bench, 1, &[(CMR, WAVE | XC1), (CCR, START)]);
    write(&mut bench, 0, &[(CMR, WAVE | EEVT_XC0 | 3 << 22), (CCR, START)]);
    assert_eq!(bench.read(CHANNEL + CV), 1);
    write(&mut bench, 0, &[(CCR, START)]);
    assert_eq!(bench.read(CHANNEL + CV), 1, "TIOA fell");
    write(&mut bench, 0, &[(CCR, START)]);
    assert_eq!(bench.read(CHANNEL + CV), 2);
}

#[test]
fn tioa_of_another_channel_is_an_external_event() {
    let mut bench = microseconds(0, 0);
    // Channel 0 counts MCK/2 from each rise of TIOA2.
    write(&mut bench, 0, &[(CMR, WAVE | EEVT_XC0 | 1 << 8 | 1 << 12), (IER, ETRGS)]);
    bench.run(MICROSECOND / 2 - 1);
    assert_eq!(bench.model.interrupts(), 0);
    bench.run(1);
    assert_eq!(bench.model.interrupts(), 1);
    bench.run(10);
    assert_eq!((bench.read(CV), bench.read(SR) & ETRGS), (5, ETRGS));
}

#[test]
fn channels_that_clock_each_other_stand_still() {
    let mut bench = Bench::new(Tc::new(1));
    bench.write(BMR, 2 | 2 << 2);
    for (channel, clock) in [(0, XC0), (1, XC1)] {
        write(&mut bench, channel, &[(CMR, WAVE | UP_RC | clock), (RC, 4), (IER, CPCS), (CCR, START)]);
    }
    bench.run(1_000_000);
    assert_eq!((bench.model.next_event(), bench.read(CV), bench.read(CHANNEL + CV)), (None, 0, 0));
}

#[test]
fn clock_from_a_pin_that_nothing_drives_is_reported() {
    let mut bench = Bench::new(Tc::new(1));
    write(&mut bench, 0, &[(CMR, WAVE | XC0)]);
    assert_eq!(bench.reports(), Vec::<String>::new());
    write(&mut bench, 0, &[(CCR, START)]);
    let report = "TC1: channel 0 stands still: its clock is the pin TCLK3, which nothing drives";
    assert_eq!(bench.reports(), [report]);
}
