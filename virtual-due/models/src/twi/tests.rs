use super::Twi;
use crate::model::{Peripheral, Signal};
use crate::test_support::{Bench, OnBus};

const CR: u32 = 0x00;
const MMR: u32 = 0x04;
const SMR: u32 = 0x08;
const IADR: u32 = 0x0C;
const CWGR: u32 = 0x10;
const SR: u32 = 0x20;
const IER: u32 = 0x24;
const RHR: u32 = 0x30;
const THR: u32 = 0x34;

const START: u32 = 1 << 0;
const STOP: u32 = 1 << 1;
const MSEN: u32 = 1 << 2;
const MSDIS: u32 = 1 << 3;
const SVEN: u32 = 1 << 4;
const SVDIS: u32 = 1 << 5;
const QUICK: u32 = 1 << 6;
const SWRST: u32 = 1 << 7;

const TXCOMP: u32 = 1 << 0;
const RXRDY: u32 = 1 << 1;
const TXRDY: u32 = 1 << 2;
const OVRE: u32 = 1 << 6;
const NACK: u32 = 1 << 8;
const ARBLST: u32 = 1 << 9;
const ENDTX: u32 = 1 << 13;
const MASTER: u32 = TXCOMP | RXRDY | TXRDY | OVRE | NACK | ARBLST;

const DEVICE: u32 = 0x28 << 16;
const NOBODY: u32 = 0x29 << 16;
const MREAD: u32 = 1 << 12;

/// 400 kHz: (106 + 96 + 8) master clocks.
const BIT: u64 = 210;
const ADDRESS: u64 = 10 * BIT;
const BYTE: u64 = 9 * BIT;

/// TWI1 with its pins, as a master at 400 kHz.
fn master(mode: u32) -> Bench<Twi> {
    let mut bench = Bench::new(Twi::new(1));
    bench.with(|twi, context| twi.signal(Signal::Pins { port: 1, a: 3 << 12, b: 0 }, context));
    for (offset, value) in [(CWGR, (96 << 8) + 106), (CR, MSEN), (MMR, mode)] {
        bench.write(offset, value);
    }
    bench
}

fn status(bench: &mut Bench<Twi>) -> u32 {
    bench.read(SR) & MASTER
}

#[test]
fn status_after_reset_is_the_datasheets() {
    assert_eq!(Bench::new(Twi::new(0)).read(SR), 0xF009);
}

#[test]
fn byte_written_begins_a_frame_and_is_taken_when_the_address_is_acknowledged() {
    let mut bench = master(DEVICE);
    assert_eq!(status(&mut bench), TXCOMP | TXRDY);
    bench.write(THR, 0x11);
    assert_eq!(status(&mut bench), 0);
    bench.run(ADDRESS - 1);
    assert_eq!(status(&mut bench), 0);
    bench.run(1);
    assert_eq!(status(&mut bench), TXRDY);
    bench.write(THR, 0x22);
    assert_eq!(status(&mut bench), 0);
    bench.run(BYTE);
    assert_eq!(status(&mut bench), TXRDY);
    bench.write(CR, STOP);
    bench.run(BYTE + BIT - 1);
    assert_eq!(status(&mut bench), TXRDY);
    bench.run(1);
    assert_eq!(status(&mut bench), TXCOMP | TXRDY);
    assert_eq!(
        bench.world.device.seen,
        [OnBus::Start(0x28, false), OnBus::Write(0x11), OnBus::Write(0x22), OnBus::Stop]
    );
}

#[test]
fn clock_is_held_after_the_last_byte_until_there_is_more_or_a_stop() {
    let mut bench = master(DEVICE);
    bench.write(THR, 1);
    bench.run(1_000_000);
    assert_eq!(status(&mut bench), TXRDY);
    bench.write(THR, 2);
    assert_eq!(status(&mut bench), TXRDY, "the shift register takes it at once");
    bench.run(BYTE);
    bench.write(CR, STOP);
    bench.run(BIT);
    assert_eq!(status(&mut bench), TXCOMP | TXRDY);
    assert_eq!(bench.world.device.seen.len(), 4);
}

#[test]
fn refused_address_sets_nack_with_txcomp_and_txrdy_until_status_is_read() {
    let mut bench = master(NOBODY);
    bench.write(THR, 1);
    bench.run(ADDRESS);
    assert_eq!(status(&mut bench), NACK | TXCOMP | TXRDY);
    assert_eq!(status(&mut bench), TXCOMP | TXRDY);
    assert_eq!(bench.world.device.seen, [OnBus::Start(0x29, false), OnBus::Stop]);
}

#[test]
fn refused_byte_ends_the_frame_and_drops_the_one_that_waits() {
    let mut bench = master(DEVICE);
    bench.world.device.refuses_data = true;
    bench.write(THR, 1);
    bench.run(ADDRESS);
    bench.write(THR, 2);
    bench.run(BYTE);
    assert_eq!(status(&mut bench), NACK | TXCOMP | TXRDY);
    bench.run(1_000_000);
    assert_eq!(bench.world.device.seen.last(), Some(&OnBus::Stop));
    assert!(!bench.world.device.seen.contains(&OnBus::Write(2)));
}

#[test]
fn byte_written_after_a_nack_begins_a_new_frame() {
    let mut bench = master(NOBODY);
    bench.write(THR, 1);
    bench.run(ADDRESS);
    bench.write(THR, 2);
    bench.run(ADDRESS);
    let starts = bench.world.device.seen.iter().filter(|seen| matches!(seen, OnBus::Start(..))).count();
    assert_eq!(starts, 2);
}

#[test]
fn one_byte_is_read_with_start_and_stop_together() {
    let mut bench = master(DEVICE | MREAD);
    bench.world.device.to_read.push_back(0xA0);
    bench.write(CR, START | STOP);
    assert_eq!(status(&mut bench), TXRDY);
    bench.run(ADDRESS + BYTE);
    assert_eq!(status(&mut bench), TXRDY | RXRDY);
    bench.run(BIT);
    assert_eq!(status(&mut bench), TXRDY | RXRDY | TXCOMP);
    assert_eq!(bench.read(RHR), 0xA0);
    assert_eq!(status(&mut bench), TXRDY | TXCOMP);
}

#[test]
fn stop_may_be_written_while_the_address_is_on_the_wire() {
    let mut bench = master(DEVICE | MREAD);
    bench.write(CR, START);
    bench.run(ADDRESS / 2);
    bench.write(CR, STOP);
    bench.run(1_000_000);
    assert_eq!(bench.world.device.seen, [OnBus::Start(0x28, true), OnBus::Read, OnBus::Stop]);
}

#[test]
fn stop_after_the_next_to_last_byte_reads_one_more() {
    let mut bench = master(DEVICE | MREAD);
    bench.world.device.to_read.extend([1, 2, 3]);
    bench.write(CR, START);
    let mut bytes = Vec::new();
    for index in 0..3 {
        bench.run_until(10_000, |bench| bench.read(SR) & RXRDY != 0);
        bytes.push(bench.read(RHR));
        if index == 1 {
            bench.write(CR, STOP);
        }
    }
    bench.run(BIT);
    assert_eq!(bytes, [1, 2, 3]);
    assert_eq!(status(&mut bench), TXRDY | TXCOMP);
}

#[test]
fn read_without_a_stop_continues_and_overruns() {
    let mut bench = master(DEVICE | MREAD);
    bench.write(CR, START);
    bench.run(ADDRESS + 5 * BYTE);
    assert_eq!(status(&mut bench), TXRDY | RXRDY | OVRE);
    assert_eq!(bench.world.device.seen.iter().filter(|seen| **seen == OnBus::Read).count(), 5);
}

#[test]
fn internal_address_is_written_before_a_repeated_start() {
    let mut bench = master(DEVICE | MREAD | 2 << 8);
    bench.write(IADR, 0x1234);
    bench.write(CR, START | STOP);
    bench.run(1_000_000);
    assert_eq!(
        bench.world.device.seen,
        [
            OnBus::Start(0x28, false),
            OnBus::Write(0x12),
            OnBus::Write(0x34),
            OnBus::Start(0x28, true),
            OnBus::Read,
            OnBus::Stop
        ]
    );
}

#[test]
fn internal_address_comes_before_written_data() {
    let mut bench = master(DEVICE | 1 << 8);
    bench.write(IADR, 0x3D);
    bench.write(THR, 8);
    bench.write(CR, STOP);
    bench.run(1_000_000);
    assert_eq!(bench.world.device.seen, [OnBus::Start(0x28, false), OnBus::Write(0x3D), OnBus::Write(8), OnBus::Stop]);
}

#[test]
fn quick_command_is_an_address_alone() {
    let mut bench = master(DEVICE);
    bench.write(CR, QUICK);
    bench.run(ADDRESS + BIT);
    assert_eq!(bench.world.device.seen, [OnBus::Start(0x28, false), OnBus::Stop]);
    assert_eq!(status(&mut bench), TXCOMP | TXRDY);
}

#[test]
fn device_that_stretches_the_clock_delays_the_next_byte() {
    let mut bench = master(DEVICE | MREAD);
    bench.world.device.stretch = 1000;
    bench.write(CR, START | STOP);
    bench.run(ADDRESS + 1000 + BYTE - 1);
    assert_eq!(status(&mut bench) & RXRDY, 0);
    bench.run(1);
    assert_eq!(status(&mut bench) & RXRDY, RXRDY);
}

#[test]
fn nothing_moves_while_the_clock_is_held_low() {
    let mut bench = master(DEVICE);
    bench.world.device.scl_low = true;
    bench.write(THR, 1);
    bench.run(10_000_000);
    assert_eq!(status(&mut bench), 0);
    assert!(bench.world.device.seen.is_empty());
    bench.world.device.scl_low = false;
    bench.run(ADDRESS + 10 * BIT);
    assert_eq!(status(&mut bench), TXRDY);
}

#[test]
fn data_line_held_low_loses_arbitration() {
    let mut bench = master(DEVICE);
    bench.world.device.sda_low = true;
    bench.write(THR, 1);
    bench.run(ADDRESS);
    assert_eq!(status(&mut bench), ARBLST | TXCOMP | TXRDY);
    assert_eq!(status(&mut bench), TXCOMP | TXRDY);
    assert!(bench.world.device.seen.is_empty());
}

#[test]
fn pdc_writes_a_frame_and_reads_one() {
    let mut bench = master(DEVICE);
    bench.memory.bytes[..3].copy_from_slice(&[7, 8, 9]);
    for (offset, value) in [(0x108, bench.memory.base), (0x10C, 3), (IER, ENDTX), (0x120, 1 << 8)] {
        bench.write(offset, value);
    }
    assert!(!bench.model.interrupt());
    bench.run(ADDRESS + BYTE);
    assert!(bench.model.interrupt(), "the last byte is in THR");
    bench.write(CR, STOP);
    bench.run(2 * BYTE + BIT);
    assert_eq!(bench.world.device.seen[1..], [OnBus::Write(7), OnBus::Write(8), OnBus::Write(9), OnBus::Stop]);

    bench.world.device.to_read.extend([4, 5]);
    bench.write(MMR, DEVICE | MREAD);
    for (offset, value) in [(0x100, bench.memory.base), (0x104, 2), (0x120, 1 | 1 << 9), (CR, START)] {
        bench.write(offset, value);
    }
    bench.run(ADDRESS + BYTE);
    bench.write(CR, STOP);
    bench.run(BYTE + BIT);
    assert_eq!(bench.memory.bytes[..3], [4, 5, 9]);
    assert_eq!(status(&mut bench), TXCOMP | TXRDY);
}

#[test]
fn without_its_pins_nothing_reaches_the_wires() {
    let mut bench = master(DEVICE);
    bench.with(|twi, context| twi.signal(Signal::Pins { port: 1, a: 1 << 12, b: 0 }, context));
    bench.write(THR, 1);
    bench.run(ADDRESS);
    assert_eq!(status(&mut bench), NACK | TXCOMP | TXRDY);
    assert!(bench.world.device.seen.is_empty());
}

#[test]
fn software_reset_ends_a_frame_that_hangs() {
    let mut bench = master(DEVICE);
    bench.world.device.scl_low = true;
    bench.write(THR, 1);
    bench.run(BYTE);
    bench.write(CR, SWRST);
    assert_eq!((status(&mut bench), bench.read(CWGR), bench.model.next_event()), (TXCOMP, 0, None));
}

#[test]
fn start_up_through_slave_mode_leaves_a_master_and_is_not_reported() {
    let mut bench = master(DEVICE);
    for command in [SVEN, SWRST, SVDIS | MSDIS, MSEN] {
        bench.write(CR, command);
    }
    for (offset, value) in [(CWGR, (96 << 8) + 106), (MMR, DEVICE), (THR, 0x11)] {
        bench.write(offset, value);
    }
    bench.run(ADDRESS);
    assert_eq!(status(&mut bench), TXRDY);
    assert!(bench.report.take().is_empty());
}

#[test]
fn slave_with_an_address_is_reported() {
    let mut bench = master(DEVICE);
    bench.write(SMR, 0x10 << 16);
    bench.write(CR, SVEN);
    assert_eq!(bench.report.take().len(), 1);
}

#[test]
fn stop_that_is_requested_during_the_last_byte_ends_the_read_after_it() {
    let mut bench = master(DEVICE | MREAD);
    bench.world.device.to_read.extend([1, 2, 3]);
    bench.write(CR, START);
    let mut read = Vec::new();
    for byte in 0..3 {
        if byte == 2 {
            bench.write(CR, STOP);
        }
        bench.run_until(ADDRESS + 2 * BYTE, |bench| status(bench) & RXRDY != 0);
        read.push(bench.read(RHR));
    }
    bench.run_until(2 * BIT, |bench| status(bench) & TXCOMP != 0);
    assert_eq!(read, [1, 2, 3]);
    assert_eq!(bench.world.device.seen, [OnBus::Start(0x28, true), OnBus::Read, OnBus::Read, OnBus::Read, OnBus::Stop]);
}

#[test]
fn one_byte_is_read_after_a_write_without_a_stop_between() {
    let mut bench = master(DEVICE);
    bench.world.device.to_read.push_back(0xA0);
    bench.write(THR, 0x00);
    bench.run(ADDRESS);
    bench.write(MMR, DEVICE | MREAD);
    bench.write(CR, START | STOP);
    bench.run(BYTE + ADDRESS + BYTE + BIT);
    assert_eq!(status(&mut bench) & (TXCOMP | RXRDY), TXCOMP | RXRDY);
    assert_eq!(bench.read(RHR), 0xA0);
    let read = [OnBus::Start(0x28, true), OnBus::Read, OnBus::Stop];
    assert_eq!(bench.world.device.seen, [&[OnBus::Start(0x28, false), OnBus::Write(0)], &read[..]].concat());
}
