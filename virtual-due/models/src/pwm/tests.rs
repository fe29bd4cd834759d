use super::Pwm;
use crate::model::{Peripheral, Pin, Side, Signal};
use crate::test_support::Bench;

const CLK: u32 = 0x00;
const ENA: u32 = 0x04;
const DIS: u32 = 0x08;
const SR: u32 = 0x0C;
const IER1: u32 = 0x10;
const ISR1: u32 = 0x1C;
const SCM: u32 = 0x20;
const SCUC: u32 = 0x28;
const SCUP: u32 = 0x2C;
const ISR2: u32 = 0x40;
const OOV: u32 = 0x44;
const OSS: u32 = 0x4C;
const OSC: u32 = 0x50;
const OSSUPD: u32 = 0x54;
const WPCR: u32 = 0xE4;
const WPSR: u32 = 0xE8;

const CLKA: u32 = 11;
const CALG: u32 = 1 << 8;
const CPOL: u32 = 1 << 9;
const DTE: u32 = 1 << 16;

fn cmr(channel: u32) -> u32 {
    0x200 + 0x20 * channel
}

fn cdty(channel: u32) -> u32 {
    cmr(channel) + 0x04
}

fn cdtyupd(channel: u32) -> u32 {
    cmr(channel) + 0x08
}

fn cprd(channel: u32) -> u32 {
    cmr(channel) + 0x0C
}

fn cprdupd(channel: u32) -> u32 {
    cmr(channel) + 0x10
}

/// A controller with all PWML pins, before any report to the world.
fn pwm() -> Bench<Pwm> {
    let mut bench = Bench::new(Pwm::new());
    let lines = [2, 4, 6, 8, 21, 22, 23, 24].iter().fold(0, |lines, line| lines | 1 << line);
    bench.with(|pwm, context| pwm.signal(Signal::Pins { port: 2, a: 0, b: lines }, context));
    bench.world.duties.clear();
    bench
}

/// A running channel with a duty of 25 of 100 clocks.
fn running(channel: u32, mode: u32) -> Bench<Pwm> {
    let mut bench = pwm();
    for (offset, value) in [(cmr(channel), mode), (cprd(channel), 100), (cdty(channel), 25), (ENA, 1 << channel)] {
        bench.write(offset, value);
    }
    bench
}

fn last(bench: &Bench<Pwm>) -> (u8, Option<(u32, u32)>, u64) {
    *bench.world.duties.last().expect("a duty was reported")
}

#[test]
fn low_side_is_high_for_the_duty_at_default_polarity() {
    assert_eq!(last(&running(7, 0)), (7, Some((25, 100)), 0));
}

#[test]
fn other_polarity_other_alignment_and_dead_time_change_what_is_high() {
    assert_eq!(last(&running(7, CPOL)).1, Some((75, 100)));
    assert_eq!(last(&running(7, CALG)).1, Some((50, 200)));
    let mut bench = running(7, DTE);
    bench.write(cmr(7) + 0x18, 5 << 16 | 9);
    assert_eq!(last(&bench).1, Some((20, 100)));
}

/// PWMC_ConfigureChannel with CLKA, then period, duty and enable: what the Arduino core's analogWrite does, 1 kHz, 8 bits.
#[test]
fn full_duty_of_an_analog_write_is_always_high() {
    let mut bench = pwm();
    for (offset, value) in [(CLK, (1 << 8) + 164), (cmr(6), CLKA), (cprd(6), 255), (cdty(6), 255), (ENA, 1 << 6)] {
        bench.write(offset, value);
    }
    assert_eq!(last(&bench).1, Some((255, 255)));
    bench.write(cdtyupd(6), 0);
    bench.run(328 * 255);
    assert_eq!(last(&bench), (6, Some((0, 255)), 328 * 255));
}

#[test]
fn update_waits_for_the_end_of_the_period() {
    let mut bench = running(5, 0);
    bench.run(130);
    bench.write(cdtyupd(5), 60);
    bench.write(cprdupd(5), 80);
    assert_eq!((bench.read(cdty(5)), bench.read(cprd(5))), (25, 100));
    bench.run(69);
    assert_eq!(last(&bench).1, Some((25, 100)));
    bench.run(1);
    assert_eq!(last(&bench), (5, Some((60, 80)), 200));
    assert_eq!((bench.read(cdty(5)), bench.read(cprd(5))), (60, 80));
}

#[test]
fn disabled_channel_finishes_its_period_and_rests_at_the_complement_of_its_polarity() {
    for (polarity, level) in [(0, 1), (CPOL, 0)] {
        let mut bench = running(4, polarity);
        bench.run(30);
        bench.write(DIS, 1 << 4);
        assert_eq!(bench.read(SR), 1 << 4);
        bench.run(70);
        assert_eq!(bench.read(SR), 0);
        assert_eq!(last(&bench), (4, Some((level, 1)), 100));
    }
}

#[test]
fn every_channel_drives_its_own_line() {
    for (channel, line) in [2, 4, 6, 8, 21, 22, 23, 24].into_iter().enumerate() {
        let mut bench = running(channel as u32, 0);
        assert_eq!(last(&bench), (channel as u8, Some((25, 100)), 0), "channel {channel}");
        let others = [2, 4, 6, 8, 21, 22, 23, 24].iter().filter(|other| **other != line);
        let others = others.fold(0, |lines, other| lines | 1 << other);
        bench.with(|pwm, context| pwm.signal(Signal::Pins { port: 2, a: 0, b: others }, context));
        assert_eq!(last(&bench), (channel as u8, None, 0), "channel {channel}, line {line}");
    }
}

#[test]
fn pin_that_belongs_to_another_is_not_driven() {
    let mut bench = running(7, 0);
    bench.with(|pwm, context| pwm.signal(Signal::Pins { port: 2, a: 0, b: 0 }, context));
    assert!(bench.world.duties.contains(&(7, None, 0)));
}

#[test]
fn counter_event_interrupts_until_status_is_read() {
    let mut bench = running(1, 0);
    bench.write(IER1, 1 << 1);
    bench.run(99);
    assert!(!bench.model.interrupt());
    bench.run(1);
    assert!(bench.model.interrupt());
    assert_eq!(bench.read(ISR1), 1 << 1);
    assert!(!bench.model.interrupt());
    assert_eq!(bench.model.next_event(), Some(200));
}

/// Channels 0, 4 and 7 synchronous, running.
fn synchronous(mode: u32) -> Bench<Pwm> {
    let mut bench = pwm();
    bench.write(SCM, mode << 16 | 0b1001_0001);
    bench.write(cprd(0), 100);
    for channel in [0, 4, 7] {
        bench.write(cdty(channel), 10);
    }
    bench.write(ENA, 1);
    bench
}

#[test]
fn synchronous_channels_share_a_period_and_are_updated_together_when_unlocked() {
    let mut bench = synchronous(0);
    assert_eq!(bench.read(SR), 0b1001_0001);
    for channel in [0, 4, 7] {
        bench.write(cdtyupd(channel), 20 + channel);
    }
    bench.run(250);
    bench.world.duties.clear();
    bench.write(SCUC, 1);
    bench.run(100);
    let expected = [(0, Some((20, 100)), 300), (4, Some((24, 100)), 300), (7, Some((27, 100)), 300)];
    assert_eq!(bench.world.duties, expected);
    assert_eq!(bench.read(SCUC), 0);
}

#[test]
fn automatic_update_comes_once_in_the_update_period() {
    let mut bench = synchronous(1);
    bench.write(SCUP, 2);
    bench.write(cdtyupd(4), 30);
    bench.run(299);
    assert_eq!((bench.read(cdty(4)), bench.read(ISR2) & 1), (10, 0));
    bench.run(1);
    assert_eq!((bench.read(cdty(4)), bench.read(ISR2) & 1), (30, 1));
    assert_eq!(bench.read(ISR2) & 1, 0);
}

#[test]
fn override_acts_at_once_or_at_the_end_of_the_period() {
    let mut bench = running(7, 0);
    bench.write(OOV, 0);
    bench.write(OSS, 1 << 23);
    assert_eq!(last(&bench), (7, Some((0, 1)), 0));
    bench.write(OSC, 1 << 23);
    assert_eq!(last(&bench).1, Some((25, 100)));
    bench.run(10);
    bench.write(OSSUPD, 1 << 23);
    bench.run(90);
    assert_eq!(last(&bench), (7, Some((0, 1)), 100));
}

#[test]
fn clock_a_is_divided_twice() {
    let mut bench = pwm();
    for (offset, value) in [(CLK, (3 << 8) + 21), (cmr(0), CLKA), (cprd(0), 10), (ENA, 1)] {
        bench.write(offset, value);
    }
    bench.run(8 * 21 * 7);
    assert_eq!(bench.read(cmr(0) + 0x14), 7);
    bench.run(8 * 21 * 3 - 1);
    assert_eq!(bench.read(ISR1), 0);
    bench.run(1);
    assert_eq!(bench.read(ISR1), 1);
}

#[test]
fn protected_group_refuses_writes() {
    let mut bench = running(7, 0);
    bench.write(WPCR, 0x5057_4D00 | 1 << 5 | 1);
    bench.write(cprdupd(7), 50);
    bench.run(200);
    assert_eq!(bench.read(cprd(7)), 100);
    assert_eq!(bench.read(WPSR), (0x2F0 << 16) | 1 << 7 | 1 << 3);
}

#[test]
fn level_of_a_low_side_follows_the_period() {
    let low_side = Pin { port: 2, line: 24 };
    for (mode, levels) in [(0, [true, true, false, false]), (CPOL, [false, false, true, true])] {
        let bench = running(7, mode);
        let seen = [0, 24, 25, 99].map(|clock| bench.model.output(low_side, Side::B, clock));
        assert_eq!(seen, levels.map(Some), "{mode:#x}");
    }
    assert_eq!(running(7, 0).model.output(low_side, Side::A, 0), None);
}

#[test]
fn each_change_of_a_low_side_in_a_period_is_an_edge() {
    let low_side = Pin { port: 2, line: 24 };
    for (mode, period, changes) in [(0, 100, vec![25]), (CPOL, 100, vec![25]), (CALG, 200, vec![25, 176])] {
        let model = running(7, mode).model;
        let level = |at: u64| model.output(low_side, Side::B, at);
        let edge = |now: &u64| model.next_output_edge(low_side, Side::B, *now);
        let edges = std::iter::successors(edge(&0), edge).take_while(|at| *at < period);
        let seen: Vec<u64> = edges.filter(|at| level(*at) != level(at - 1)).collect();
        assert_eq!(seen, changes, "{mode:#x}");
        assert_eq!((1..period).filter(|at| level(*at) != level(at - 1)).collect::<Vec<_>>(), changes, "{mode:#x}");
    }
}
