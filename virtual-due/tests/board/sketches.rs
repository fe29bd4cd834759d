//! Programs that poll and write registers as the Arduino core does.

use crate::program::{MILLISECOND, board};
use rig_twin::Scenario;
use virtual_due::WiredRig;
use virtual_due::model::World;

/// The first word of RAM.
fn result(board: &virtual_due::Machine<WiredRig>) -> u32 {
    let word = board.peek(0x2007_0000, 4).expect("RAM");
    u32::from_le_bytes(word.try_into().expect("four bytes"))
}

#[test]
fn analog_read_gives_the_counts_of_the_arms_sensor() {
    // PMC_PCER1 = ADC; ADC_CHER = channel 7; ADC_CR = START; until ADC_ISR.DRDY; RAM = ADC_LCDR; wfi; b .
    let mut board = board(
        &[
            0x4807, 0x2120, 0x6001, 0x4807, 0x2180, 0x6101, 0x2102, 0x6001, 0x6B01, 0x01C9, 0xD5FC, 0x6A07, 0x4803,
            0x6007, 0xBF30, 0xE7FE, 0x0700, 0x400E, 0x0000, 0x400C, 0x0000, 0x2007,
        ],
        0,
    );
    board.run_until(MILLISECOND);
    assert!(board.sleeps());
    let counts = WiredRig::new(Scenario::FreeSwing, 1).adc_counts(7, MILLISECOND);
    assert_eq!(result(&board), u32::from(counts));
}

#[test]
fn analog_write_of_255_on_pin_6_gives_the_first_regulator_full_pressure() {
    // PMC_PCER1 = PWM; PWM_CLK = MCK / 2 / 164; PC24 to peripheral B; channel 7: clock A, CPRD = CDTY = 255; PWM_ENA; wfi; b .
    let mut board = board(
        &[
            0x480B, 0x2110, 0x6001, 0x480B, 0xF240, 0x11A4, 0x6001, 0x4A0A, 0xF04F, 0x7180, 0x6711, 0x6051, 0xF500,
            0x7238, 0x210B, 0x6011, 0x21FF, 0x60D1, 0x6051, 0x2180, 0x6041, 0xBF30, 0xE7FE, 0x0000, 0x0700, 0x400E,
            0x4000, 0x4009, 0x1200, 0x400E,
        ],
        0,
    );
    board.run_until(MILLISECOND);
    assert!(board.sleeps());
    let kilopascals = board.world().set_points_pa().iter().map(|pa| (pa / 1000.0).round() as u32).collect::<Vec<_>>();
    assert_eq!(kilopascals, [280, 0, 0, 0, 0, 0]);
    assert_eq!(board.reports(), []);
}

#[test]
fn countflag_is_seen_once_a_period_of_systick() {
    // SYST_RVR = 3999; SYST_CVR = 0; SYST_CSR = core clock, enabled; loop: until COUNTFLAG; RAM = ++r7
    let mut board = board(
        &[
            0x4807, 0xF640, 0x719F, 0x6041, 0x6081, 0x2105, 0x6001, 0x4A05, 0x2700, 0x6801, 0x03C9, 0xD5FC, 0x3701,
            0x6017, 0xE7F9, 0x0000, 0xE010, 0xE000, 0x0000, 0x2007,
        ],
        0,
    );
    // 4000 cycles of 4 MHz are a millisecond; the program needs some cycles to begin and to see the flag.
    board.run_until(100 * MILLISECOND + MILLISECOND / 2);
    assert_eq!(result(&board), 100);
}
