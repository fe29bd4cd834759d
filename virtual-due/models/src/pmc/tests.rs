use super::{
    CYCLES_PER_SECOND, LOCKA, MCFR, MCKR, MCKRDY, MOR, MOSCSELS, MOSCXTS, OSCSELS, PCER0, PCSR0, PLLAR, Pmc, SR, WPMR,
};
use crate::model::{Peripheral, Signal};
use crate::test_support::Bench;

fn wait(bench: &mut Bench<Pmc>, bit: u32) -> u64 {
    assert_eq!(bench.read(SR) & bit, 0, "not at once");
    bench.run_until(CYCLES_PER_SECOND / 10, |bench| bench.read(SR) & bit != 0)
}

#[test]
fn the_usual_sequence_leads_to_84_mhz() {
    let mut bench = Bench::new(Pmc::new());
    bench.write(MOR, 0x0037_0809);
    // 8 · 8 slow clocks.
    assert_eq!(wait(&mut bench, MOSCXTS), 164_063);
    bench.write(MOR, 0x0137_0809);
    wait(&mut bench, MOSCSELS);
    bench.write(MCKR, 0x11);
    wait(&mut bench, MCKRDY);
    bench.write(PLLAR, 0x200D_3F01);
    assert_eq!(wait(&mut bench, LOCKA), 161_500);
    bench.write(MCKR, 0x12);
    wait(&mut bench, MCKRDY);
    assert_eq!(bench.signalled(), [12_000_000, 6_000_000, 84_000_000].map(Signal::MasterClock));
    assert!(bench.warnings.take().is_empty());
}

#[test]
fn a_master_clock_from_an_unlocked_pll_is_reported() {
    let mut bench = Bench::new(Pmc::new());
    bench.write(PLLAR, 0x200D_3F01);
    bench.write(MCKR, 0x12);
    assert_eq!(bench.warnings.take().len(), 1);
}

#[test]
fn the_main_clock_is_measured_against_the_slow_clock() {
    let mut bench = Bench::new(Pmc::new());
    bench.write(MOR, 0x0137_0809);
    assert_eq!(bench.read(MCFR), 0);
    bench.run(CYCLES_PER_SECOND / 1000);
    assert_eq!(bench.read(MCFR), 0x1_0000 + 5859);
}

#[test]
fn slow_crystal_is_shown_once_it_has_started_and_over_resets() {
    let mut bench = Bench::new(Pmc::new());
    bench.signal(Signal::SlowCrystal(1000));
    bench.run(999);
    assert_eq!(bench.read(SR) & OSCSELS, 0);
    bench.run(1);
    assert_eq!(bench.read(SR) & OSCSELS, OSCSELS);
    bench.model.reset();
    assert_eq!(bench.read(SR) & OSCSELS, 0);
    bench.signal(Signal::SlowCrystal(1000));
    assert_eq!(bench.read(SR) & OSCSELS, OSCSELS);
}

#[test]
fn peripheral_clocks_are_set_one_by_one() {
    let mut bench = Bench::new(Pmc::new());
    bench.write(PCER0, 1 << 8);
    bench.write(PCER0, 1 << 11);
    assert_eq!(bench.read(PCSR0), 0x900);
    assert_eq!(bench.signalled().last(), Some(&Signal::PeripheralClocks(0x900)));
}

#[test]
fn write_protection_keeps_clocks_as_they_are() {
    let mut bench = Bench::new(Pmc::new());
    bench.write(WPMR, 0x504D_4301);
    bench.write(PCER0, 1 << 8);
    assert_eq!(bench.read(PCSR0), 0);
}
