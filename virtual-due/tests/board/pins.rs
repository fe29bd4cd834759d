//! Pins as they are observed from outside: recorded, and wired to each other.

use crate::program::{MILLISECOND, SPIN, WFI, board, firmware};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use virtual_due::model::Pin;
use virtual_due::{Machine, WiredRig, arduino_pins};

/// PMC_PCER1 = TC6; PC25 (D5) to peripheral B; TC2 channel 0: MCK/2, up to RC = 40, TIOA set at RA = 10 and cleared at RC; start;
/// wfi; b .
const SQUARE_WAVE_ON_D5: [u16; 26] = [
    0x4808, 0x2102, 0x6001, 0x4808, 0x0609, 0x6041, 0x6701, 0x4807, 0x4907, 0x6041, 0x210A, 0x6141, 0x2128, 0x61C1,
    0x2105, 0x6001, WFI, SPIN, 0x0700, 0x400E, 0x1200, 0x400E, 0x8000, 0x4008, 0xC000, 0x0009,
];
/// 40 ticks of 2 MHz, of which the last 30 are high, in cycles of 84 MHz.
const PERIOD: u64 = 1680;
const HIGH: u64 = 1260;

const PMC_PCER0: u32 = 0x400E_0610;
const PIOB_IER: u32 = 0x400E_1040;
const PIOB_PDSR: u32 = 0x400E_103C;
const PIOB_ISR: u32 = 0x400E_104C;
/// D2 is PB25.
const D2: u32 = 1 << 25;

fn named(name: &str) -> Pin {
    arduino_pins::named(name).expect("a pin of the Due")
}

#[test]
fn output_of_a_peripheral_is_recorded_edge_by_edge() {
    let mut board = board(&SQUARE_WAVE_ON_D5, 0);
    board.record_pins();
    board.run_until(MILLISECOND);
    let edges = board.take_pin_changes();
    let edges: Vec<_> =
        edges.iter().filter(|change| change.pin == named("D5")).skip_while(|edge| edge.level != Some(true)).collect();
    assert!(edges.len() > 90, "{} edges in a millisecond", edges.len());
    for edge in edges.windows(2) {
        let (length, was_high) = (edge[1].at - edge[0].at, edge[0].level == Some(true));
        assert_eq!(length, if was_high { HIGH } else { PERIOD - HIGH });
    }
}

#[test]
fn recording_leaves_the_run_as_it_is() {
    let (mut recorded, mut plain) = (board(&SQUARE_WAVE_ON_D5, 0), board(&SQUARE_WAVE_ON_D5, 0));
    recorded.record_pins();
    for board in [&mut recorded, &mut plain] {
        board.run_until(10 * MILLISECOND);
    }
    assert_eq!(
        (recorded.instructions(), recorded.now(), recorded.pc()),
        (plain.instructions(), plain.now(), plain.pc())
    );
}

/// The square wave on D5, wired to D2, with the clock of D2's controller on.
fn wired() -> Machine<WiredRig> {
    let mut board = board(&SQUARE_WAVE_ON_D5, 0);
    board.connect(named("D5"), named("D2"));
    board.run_until(MILLISECOND);
    assert!(board.poke_peripheral(PMC_PCER0, 1 << 12));
    board
}

#[test]
fn input_shows_the_output_that_is_wired_to_it() {
    let mut board = wired();
    let mut high = 0;
    for _ in 0..1000 {
        board.run_for(PERIOD / 8 + 1);
        high += u32::from(board.peek_peripheral(PIOB_PDSR).expect("PIOB") & D2 != 0);
    }
    // High for three quarters of the time.
    assert!((700..800).contains(&high), "{high} of 1000");
}

#[test]
fn each_edge_on_a_wire_interrupts_at_once() {
    let mut board = wired();
    board.poke_peripheral(PIOB_IER, D2);
    board.peek_peripheral(PIOB_ISR);
    board.run_for(PERIOD);
    assert_eq!(board.peek_peripheral(PIOB_ISR).map(|status| status & D2), Some(D2));
    assert_eq!(board.peek_peripheral(PIOB_ISR).map(|status| status & D2), Some(0));
}

#[test]
fn pins_file_is_a_vcd_with_arduino_names() {
    let place = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (elf, vcd) = (place.join("square.elf"), place.join("pins.vcd"));
    std::fs::write(&elf, firmware(&SQUARE_WAVE_ON_D5, 0)).expect("a place for the file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-due"));
    command.args(["run", "--seconds", "0.01", "--wire", "D5=D2", "--pins"]).arg(&vcd).arg(&elf).stdin(Stdio::null());
    assert!(command.status().expect("the command").success());
    let file = std::fs::File::open(vcd).expect("the file");
    let mut parser = vcd::Parser::new(std::io::BufReader::new(file));
    let header = parser.parse_header().expect("a header");
    assert_eq!(header.timescale, Some((1, vcd::TimescaleUnit::NS)));
    let code = |name: &str| header.find_var(&["due", name]).expect("a pin of the Due").code;
    let (output, input) = (code("D5"), code("D2"));
    let (mut time, mut rises) = (0, [Vec::new(), Vec::new()]);
    for command in parser {
        match command.expect("a command of the format") {
            vcd::Command::Timestamp(then) => time = then,
            vcd::Command::ChangeScalar(pin, vcd::Value::V1) if pin == output => rises[0].push(time),
            vcd::Command::ChangeScalar(pin, vcd::Value::V1) if pin == input => rises[1].push(time),
            _ => {}
        }
    }
    assert_eq!(time, 10_000_000, "the end of the run");
    assert!(rises[0].len() > 490, "{} rises in 10 ms", rises[0].len());
    assert!(rises[0].windows(2).all(|pair| pair[1] - pair[0] == 20_000), "a rise every 20 µs");
    assert_eq!(rises[0], rises[1], "the wire");
}
