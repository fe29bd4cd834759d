use super::Adc;
use crate::model::{Peripheral, Signal};
use crate::test_support::Bench;

const CR: u32 = 0x00;
const MR: u32 = 0x04;
const SEQR1: u32 = 0x08;
const CHER: u32 = 0x10;
const CHDR: u32 = 0x14;
const CHSR: u32 = 0x18;
const LCDR: u32 = 0x20;
const IER: u32 = 0x24;
const ISR: u32 = 0x30;
const OVER: u32 = 0x3C;
const EMR: u32 = 0x40;
const CWR: u32 = 0x44;
const CDR0: u32 = 0x50;
const ACR: u32 = 0x94;
const WPMR: u32 = 0xE4;
const WPSR: u32 = 0xE8;

const START: u32 = 2;
const DRDY: u32 = 1 << 24;
const GOVRE: u32 = 1 << 25;
const COMPE: u32 = 1 << 26;
const EOC: u32 = 0xFFFF;

/// PRESCAL 2: 14 MHz, six cycles an ADC clock, 20 of which are a conversion.
const PRESCAL_2: u32 = 2 << 8;
const CONVERSION: u64 = 20 * 6;

fn adc(mode: u32, channels: u32) -> Bench<Adc> {
    let mut bench = Bench::new(Adc::new());
    bench.write(MR, PRESCAL_2 | mode);
    bench.write(CHER, channels);
    bench
}

fn converted(bench: &Bench<Adc>) -> Vec<u8> {
    bench.world.conversions.iter().map(|(channel, _)| *channel).collect()
}

#[test]
fn conversions_come_in_channel_order() {
    let mut bench = adc(0, 1 << 13 | 1 << 7 | 1 << 0);
    bench.write(CR, START);
    bench.run(3 * CONVERSION - 1);
    assert_eq!(converted(&bench), [0, 7]);
    bench.run(1);
    assert_eq!(converted(&bench), [0, 7, 13]);
    for channel in [0, 7, 13] {
        assert_eq!(bench.read(CDR0 + 4 * channel), 100 * channel);
    }
    bench.run(1_000_000);
    assert_eq!(converted(&bench).len(), 3, "one trigger is one sequence");
}

#[test]
fn polling_drdy_reads_the_channel_that_was_just_enabled() {
    let mut bench = adc(0, 1 << 7);
    for channel in [7, 6, 5] {
        bench.write(CHER, 1 << channel);
        bench.write(CHDR, !(1 << channel) & 0xFFFF);
        bench.write(CR, START);
        bench.run_until(1000, |bench| bench.read(ISR) & DRDY != 0);
        assert_eq!(bench.read(LCDR), 100 * channel);
        assert_eq!(bench.read(ISR) & DRDY, 0);
    }
    assert_eq!(bench.read(CHSR), 1 << 5);
}

#[test]
fn end_of_conversion_is_cleared_by_its_own_data_register() {
    let mut bench = adc(0, 0b11);
    bench.write(CR, START);
    bench.run(1000);
    assert_eq!(bench.read(ISR) & EOC, 0b11);
    bench.read(LCDR);
    assert_eq!(bench.read(ISR) & (EOC | DRDY), 0b11);
    bench.read(CDR0);
    assert_eq!(bench.read(ISR) & EOC, 0b10);
}

#[test]
fn overruns_are_told_until_their_register_is_read() {
    let mut bench = adc(0, 0b1);
    for _ in 0..2 {
        bench.write(CR, START);
        bench.run(1000);
    }
    assert_eq!(bench.read(ISR) & (DRDY | GOVRE), DRDY | GOVRE);
    assert_eq!(bench.read(ISR) & (DRDY | GOVRE), DRDY);
    assert_eq!(bench.read(OVER), 1);
    assert_eq!(bench.read(OVER), 0);
}

#[test]
fn timer_edge_triggers_only_where_it_is_selected() {
    let mut bench = adc(1 | 2 << 1, 0b1);
    for (signal, conversions) in [(Signal::Tioa(0), 0), (Signal::PwmEvent(1), 0), (Signal::Tioa(1), 1)] {
        bench.with(|adc, context| adc.signal(signal, context));
        bench.run(1000);
        assert_eq!(converted(&bench).len(), conversions, "{signal:?}");
    }
}

#[test]
fn pdc_takes_tagged_results_without_an_overrun() {
    let mut bench = adc(0, 0x3CFF);
    bench.world.counts = 9;
    bench.write(EMR, 1 << 24);
    for (offset, value) in [(0x100, bench.memory.base), (0x104, 12), (0x120, 1), (IER, 1 << 28)] {
        bench.write(offset, value);
    }
    bench.write(CR, START);
    bench.run(12 * CONVERSION - 1);
    assert!(!bench.model.interrupt());
    bench.run(1);
    assert!(bench.model.interrupt());
    let words: Vec<u16> = bench.memory.bytes[..24].chunks(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
    let expected: Vec<u16> = [0, 1, 2, 3, 4, 5, 6, 7, 10, 11, 12, 13].map(|c| c << 12 | (100 * c + 9)).to_vec();
    assert_eq!(words, expected);
    assert_eq!(bench.read(ISR) & (DRDY | GOVRE), 0);
}

#[test]
fn free_running_converts_again_and_again() {
    let mut bench = adc(1 << 7, 0b11);
    bench.run(10 * CONVERSION);
    assert_eq!(converted(&bench), [0, 1, 0, 1, 0, 1, 0, 1, 0, 1]);
    bench.write(MR, PRESCAL_2);
    bench.run(10 * CONVERSION);
    assert_eq!(converted(&bench).len(), 12);
}

#[test]
fn channel_disabled_in_the_middle_is_left_out() {
    let mut bench = adc(0, 0b1011);
    bench.write(CR, START);
    bench.run(CONVERSION);
    bench.write(CHDR, 0b1000);
    bench.write(CHER, 0b0100);
    bench.run(1000);
    assert_eq!(converted(&bench), [0, 1, 2]);
}

#[test]
fn startup_time_comes_before_the_first_conversion_and_after_sleep() {
    let mut bench = adc(4 << 16 | 1 << 5, 1);
    for _ in 0..2 {
        bench.write(CR, START);
        bench.run(64 * 6 + CONVERSION - 1);
        assert_eq!(bench.read(ISR) & DRDY, 0);
        bench.run(1);
        assert_eq!(bench.read(ISR) & DRDY, DRDY);
        bench.read(LCDR);
    }
}

#[test]
fn longer_tracking_takes_longer() {
    let mut bench = adc(15 << 24 | 1 << 28, 1);
    bench.write(CR, START);
    bench.run((16 + 12 + 5) * 6 - 1);
    assert_eq!(bench.read(ISR) & DRDY, 0);
    bench.run(1);
    assert_eq!(bench.read(ISR) & DRDY, DRDY);
}

#[test]
fn low_resolution_drops_two_bits() {
    let mut bench = adc(1 << 4, 1 << 4);
    bench.world.counts = 3;
    bench.write(CR, START);
    bench.run(1000);
    assert_eq!(bench.read(LCDR), 403 >> 2);
}

#[test]
fn user_sequence_converts_its_fields_in_order() {
    let mut bench = adc(1 << 31, 0b111);
    bench.write(SEQR1, 0x0275);
    bench.write(CR, START);
    bench.run(1000);
    assert_eq!(converted(&bench), [5, 7, 2]);
}

#[test]
fn result_outside_the_window_raises_compe_until_status_is_read() {
    let mut bench = adc(0, 0b110);
    bench.write(CWR, (150 << 16) + 50);
    bench.write(EMR, 3 | 1 << 9);
    bench.write(CR, START);
    bench.run(CONVERSION);
    assert_eq!(bench.read(ISR) & COMPE, 0, "channel 1 is inside");
    bench.run(CONVERSION);
    assert_eq!(bench.read(ISR) & COMPE, COMPE);
    assert_eq!(bench.read(ISR) & COMPE, 0);
}

#[test]
fn write_protection_refuses_and_says_what() {
    let mut bench = adc(0, 1);
    bench.write(WPMR, 0x4144_4301);
    bench.write(CHER, 0xFF);
    assert_eq!((bench.read(CHSR), bench.read(WPSR)), (1, 0x1001));
}

#[test]
fn software_reset_leaves_only_the_pdc() {
    let mut bench = adc(0, 1);
    bench.write(0x104, 5);
    bench.write(IER, DRDY);
    bench.write(CR, 1);
    assert_eq!((bench.read(MR), bench.read(CHSR), bench.read(0x2C), bench.read(0x104)), (0, 0, 0, 5));
}

#[test]
fn channel_15_is_the_chips_temperature_once_its_sensor_is_on() {
    let mut bench = Bench::new(Adc::new());
    bench.write(CHER, 1 << 15);
    bench.write(ACR, 1 << 4);
    bench.write(CR, START);
    bench.run(100_000);
    // 0.8 V of 3.3 V.
    assert_eq!(bench.read(LCDR), 993);
    bench.write(ACR, 0);
    bench.write(CR, START);
    bench.run(100_000);
    assert_eq!(bench.read(LCDR), 0);
    assert_eq!(bench.reports().len(), 1);
    assert_eq!(bench.world.conversions, []);
}
