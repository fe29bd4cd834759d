use super::{ABSR, ISR, MDER, OER, PDSR, PER, POLL, PUDR, Pio, SODR};
use crate::model::{Peripheral, Pin, Signal};
use crate::test_support::Bench;

const CODR: u32 = 0x34;
const IER: u32 = 0x40;
const AIMER: u32 = 0xB0;
const LSR: u32 = 0xC4;
const FELLSR: u32 = 0xD0;
const PDR: u32 = 0x04;
const ODR: u32 = 0x14;

const PIN: Pin = Pin { port: 1, line: 5 };
const BIT: u32 = 1 << 5;

/// PIOB is identifier 12.
const CLOCK_ON: Signal = Signal::PeripheralClocks(1 << 12);
const CLOCK_OFF: Signal = Signal::PeripheralClocks(0);

/// PIOB with its clock on.
fn pio() -> Bench<Pio> {
    let mut bench = Bench::new(Pio::new(1));
    bench.signal(CLOCK_ON);
    bench
}

#[test]
fn an_output_drives_its_level_and_reads_it_back() {
    let mut bench = pio();
    bench.write(OER, BIT);
    bench.write(SODR, BIT);
    assert_eq!(bench.read(PDSR) & BIT, BIT);
    bench.write(CODR, BIT);
    assert_eq!(bench.read(PDSR) & BIT, 0);
    bench.write(ODR, BIT);
    let driven: Vec<_> = bench.world.driven.iter().map(|(pin, level, _)| (*pin, *level)).collect();
    assert_eq!(driven, [(PIN, Some(false)), (PIN, Some(true)), (PIN, Some(false)), (PIN, None)]);
}

#[test]
fn an_undriven_input_reads_its_pull_up() {
    let mut bench = pio();
    assert_eq!(bench.read(PDSR) & BIT, BIT);
    bench.write(PUDR, BIT);
    assert_eq!(bench.read(PDSR) & BIT, 0);
    bench.world.levels.insert(PIN, true);
    assert_eq!(bench.read(PDSR) & BIT, BIT);
}

#[test]
fn an_open_drain_line_is_released_when_high() {
    let mut bench = pio();
    bench.write(MDER, BIT);
    bench.write(OER, BIT);
    bench.write(SODR, BIT);
    assert_eq!(bench.read(PDSR) & BIT, BIT);
    bench.world.levels.insert(PIN, false);
    assert_eq!(bench.read(PDSR) & BIT, 0, "the outside holds it low");
    assert_eq!(bench.world.driven.last().map(|(_, level, _)| *level), Some(None));
}

#[test]
fn any_edge_interrupts_once_enabled_and_reading_clears_it() {
    let mut bench = pio();
    bench.write(IER, BIT);
    assert!(!bench.model.interrupt());
    bench.world.levels.insert(PIN, false);
    bench.run(POLL);
    assert!(bench.model.interrupt());
    assert_eq!(bench.read(ISR), BIT);
    assert!(!bench.model.interrupt());
}

#[test]
fn a_rising_edge_does_not_interrupt_where_a_falling_one_is_selected() {
    let mut bench = pio();
    bench.world.levels.insert(PIN, false);
    for register in [FELLSR, AIMER] {
        bench.write(register, BIT);
    }
    bench.read(PDSR);
    bench.read(ISR);
    bench.write(IER, BIT);
    bench.world.levels.insert(PIN, true);
    bench.run(POLL);
    assert!(!bench.model.interrupt());
    bench.world.levels.insert(PIN, false);
    bench.run(POLL);
    assert!(bench.model.interrupt());
}

#[test]
fn a_low_level_interrupts_again_and_again() {
    let mut bench = pio();
    bench.world.levels.insert(PIN, false);
    for register in [LSR, FELLSR, AIMER, IER] {
        bench.write(register, BIT);
    }
    bench.run(POLL);
    assert_eq!(bench.read(ISR), BIT);
    bench.run(POLL);
    assert_eq!(bench.read(ISR), BIT);
}

#[test]
fn the_peripheral_that_has_a_pin_is_signalled_to_the_chip() {
    let mut bench = pio();
    bench.write(PDR, BIT);
    assert_eq!(bench.signalled().last(), Some(&Signal::Pins { port: 1, a: BIT, b: 0 }));
    bench.write(ABSR, BIT);
    assert_eq!(bench.signalled().last(), Some(&Signal::Pins { port: 1, a: 0, b: BIT }));
    bench.write(PER, BIT);
    assert_eq!(bench.signalled().last(), Some(&Signal::Pins { port: 1, a: 0, b: 0 }));
}

#[test]
fn a_reset_releases_all_pins() {
    let mut bench = pio();
    bench.write(OER, BIT);
    bench.model.reset();
    bench.signal(Signal::Reset(crate::model::Cause::User));
    assert_eq!(bench.world.driven.last().map(|(pin, level, _)| (*pin, *level)), Some((PIN, None)));
}

#[test]
fn pins_are_not_followed_without_the_clock_and_that_is_reported() {
    let mut bench = pio();
    bench.world.levels.insert(PIN, false);
    bench.signal(CLOCK_OFF);
    bench.world.levels.insert(PIN, true);
    assert_eq!(bench.read(PDSR) & BIT, 0, "the level when the clock was switched off");
    let reports = bench.reports();
    assert!(matches!(&reports[..], [report] if report.starts_with("PIOB: PDSR is read while the PIO's clock is off")));
    bench.signal(CLOCK_ON);
    assert_eq!(bench.read(PDSR) & BIT, BIT);
    assert_eq!(bench.reports(), Vec::<String>::new());
}

#[test]
fn outputs_are_driven_without_the_clock() {
    let mut bench = Bench::new(Pio::new(1));
    bench.write(OER, BIT);
    bench.write(SODR, BIT);
    assert_eq!(bench.world.driven.last().map(|(pin, level, _)| (*pin, *level)), Some((PIN, Some(true))));
}

#[test]
fn no_edge_interrupts_without_the_clock() {
    let mut bench = pio();
    bench.write(IER, BIT);
    bench.signal(CLOCK_OFF);
    bench.world.levels.insert(PIN, false);
    bench.run(10 * POLL);
    assert!(!bench.model.interrupt());
    assert_eq!(bench.model.next_event(), None);
}

#[test]
fn pin_of_a_peripheral_shows_the_level_that_the_peripheral_drives() {
    let mut bench = pio();
    bench.signal(Signal::Outputs { driven: BIT, levels: 0 });
    assert_eq!(bench.read(PDSR) & BIT, BIT, "the pin is not the peripheral's");
    bench.write(PDR, BIT);
    assert_eq!(bench.read(PDSR) & BIT, 0);
    bench.signal(Signal::Outputs { driven: BIT, levels: BIT });
    assert_eq!(bench.read(PDSR) & BIT, BIT);
}
