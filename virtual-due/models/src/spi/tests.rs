use super::{
    CR, CSAAT, CSR0, IER, LLB, MR, MSTR, OVRES, PS, RDR, RDRF, SPIDIS, SPIEN, SR, Spi, TDR, TDRE, TXEMPTY, WDRBT, WPMR,
};
use crate::model::Peripheral;
use crate::test_support::Bench;

/// 84 MHz / 21 = 4 MHz: 8 bits take 168 cycles, and half a bit before them 10.
const SCBR: u32 = 21 << 8;
const BYTE: u64 = 168;
const LEAD: u64 = 10;

/// SPI0 as a master with this mode and CSR0, enabled.
fn master(mode: u32, chip_select: u32) -> Bench<Spi> {
    let mut bench = Bench::new(Spi::new("SPI0"));
    // PCS = 1110: NPCS0.
    for (offset, value) in [(MR, MSTR | 0xE_0000 | mode), (CSR0, chip_select | SCBR), (CR, SPIEN)] {
        bench.write(offset, value);
    }
    bench
}

fn status(bench: &mut Bench<Spi>) -> u32 {
    bench.read(SR) & (RDRF | TDRE | OVRES | TXEMPTY)
}

#[test]
fn nothing_is_ready_before_it_is_enabled() {
    let mut bench = Bench::new(Spi::new("SPI0"));
    assert_eq!(bench.read(SR), 0);
    bench.write(CR, SPIEN);
    assert_eq!(status(&mut bench), TDRE | TXEMPTY);
    bench.write(CR, SPIDIS);
    assert_eq!(bench.read(SR), 0);
}

#[test]
fn registers_read_as_written() {
    let mut bench = master(LLB, CSAAT);
    assert_eq!((bench.read(MR), bench.read(CSR0)), (MSTR | 0xE_0000 | LLB, CSAAT | SCBR));
}

#[test]
fn transfer_takes_the_time_of_its_bits() {
    let mut bench = master(LLB, 0);
    bench.write(TDR, 0x5A);
    assert_eq!(status(&mut bench), TDRE, "the shift register took it at once");
    bench.run(LEAD + BYTE - 1);
    assert_eq!(status(&mut bench), TDRE);
    bench.run(1);
    assert_eq!(status(&mut bench), RDRF | TDRE | TXEMPTY);
    assert_eq!(bench.read(RDR), 0xE_005A);
    assert_eq!(status(&mut bench), TDRE | TXEMPTY);
}

#[test]
fn without_loop_back_ones_are_received_and_the_wires_are_reported() {
    let mut bench = master(0, 0);
    bench.write(TDR, 0x5A);
    bench.run(LEAD + BYTE);
    assert_eq!(bench.read(RDR) & 0xFFFF, 0xFF);
    assert_eq!(bench.reports(), ["SPI0: nothing is on its wires: it receives ones"]);
}

#[test]
fn next_datum_follows_without_a_gap_and_an_unread_one_is_overrun() {
    let mut bench = master(LLB, 0);
    bench.write(TDR, 1);
    bench.write(TDR, 2);
    assert_eq!(status(&mut bench), 0);
    bench.run(LEAD + BYTE);
    assert_eq!(status(&mut bench), RDRF | TDRE);
    bench.run(BYTE);
    assert_eq!(status(&mut bench), RDRF | TDRE | OVRES | TXEMPTY);
    assert_eq!(status(&mut bench), RDRF | TDRE | TXEMPTY, "reading clears the overrun");
    assert_eq!(bench.read(RDR) & 0xFFFF, 2);
}

#[test]
fn wdrbt_waits_for_the_reader() {
    let mut bench = master(LLB | WDRBT, 0);
    bench.write(TDR, 1);
    bench.write(TDR, 2);
    bench.run(10 * BYTE);
    assert_eq!((status(&mut bench), bench.read(RDR) & 0xFFFF), (RDRF, 1));
    bench.run(LEAD + BYTE);
    assert_eq!(bench.read(RDR) & 0xFFFF, 2);
}

#[test]
fn delays_and_width_of_the_chip_select_count() {
    // 16 bits, DLYBS = 100, DLYBCT = 2.
    let mut bench = master(LLB, 8 << 4 | 100 << 16 | 2 << 24);
    bench.write(TDR, 0xBEEF);
    bench.write(TDR, 0xCAFE);
    bench.run(100 + 2 * BYTE);
    assert_eq!(bench.read(RDR) & 0xFFFF, 0xBEEF);
    bench.run(64 + 2 * BYTE - 1);
    assert_eq!(status(&mut bench) & RDRF, 0);
    bench.run(1);
    assert_eq!(bench.read(RDR) & 0xFFFF, 0xCAFE);
}

#[test]
fn variable_peripheral_selects_its_own_settings() {
    let mut bench = master(LLB | PS, 0);
    // CSR1 at half the speed; PCS = 1101.
    bench.write(CSR0 + 4, 42 << 8);
    bench.write(TDR, 0xD_0077);
    bench.run(21 + 2 * BYTE - 1);
    assert_eq!(status(&mut bench) & RDRF, 0);
    bench.run(1);
    assert_eq!(bench.read(RDR), 0xD_0077);
}

#[test]
fn interrupt_is_raised_at_the_end_of_a_transfer() {
    let mut bench = master(LLB, 0);
    bench.write(IER, RDRF);
    bench.write(TDR, 1);
    assert_eq!(bench.model.next_event(), Some(LEAD + BYTE));
    bench.run(LEAD + BYTE - 1);
    assert!(!bench.model.interrupt());
    bench.run(1);
    assert!(bench.model.interrupt());
    bench.read(RDR);
    assert!(!bench.model.interrupt());
}

#[test]
fn slave_mode_is_reported() {
    let mut bench = Bench::new(Spi::new("SPI1"));
    bench.write(CR, SPIEN);
    bench.write(TDR, 1);
    assert_eq!(bench.reports(), ["SPI1: slave mode is not modelled"]);
}

#[test]
fn write_protection_keeps_mode_and_chip_selects() {
    let mut bench = master(LLB, 0);
    bench.write(WPMR, 0x5350_4901);
    bench.write(CSR0, 0);
    bench.write(MR, 0);
    assert_eq!((bench.read(MR), bench.read(CSR0)), (MSTR | 0xE_0000 | LLB, SCBR));
}
