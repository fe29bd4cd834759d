//! Fields of the ADC's registers (datasheet 43.7).

use crate::model::Signal;

pub const DRDY: u32 = 1 << 24;
pub const GOVRE: u32 = 1 << 25;
pub const COMPE: u32 = 1 << 26;
pub const ENDRX: u32 = 1 << 27;
pub const RXBUFF: u32 = 1 << 28;

/// EMR.TAG.
pub const TAG: u32 = 1 << 24;

/// ADC_MR.
#[derive(Debug, Clone, Copy)]
pub struct Mode(pub u32);

impl Mode {
    /// The hardware trigger that TRGEN and TRGSEL select. Nothing drives the ADTRG pin.
    pub fn trigger(self) -> Option<Signal> {
        let selected = (self.0 >> 1) as u8 & 7;
        match selected {
            _ if self.0 & 1 == 0 => None,
            1..=3 => Some(Signal::Tioa(selected - 1)),
            4 | 5 => Some(Signal::PwmEvent(selected - 4)),
            _ => None,
        }
    }

    pub fn low_resolution(self) -> bool {
        self.0 & (1 << 4) != 0
    }

    /// The cell is off between sequences: SLEEP without FWUP.
    pub fn sleeps(self) -> bool {
        self.0 & (3 << 5) == 1 << 5
    }

    pub fn free_running(self) -> bool {
        self.0 & (1 << 7) != 0
    }

    pub fn user_sequence(self) -> bool {
        self.0 & (1 << 31) != 0
    }

    /// Master clock periods in a period of the ADC clock: (PRESCAL + 1) · 2.
    pub fn clock_divisor(self) -> u64 {
        (u64::from((self.0 >> 8) & 0xFF) + 1) * 2
    }

    /// ADC clocks that the cell takes to start.
    pub fn startup_clocks(self) -> u64 {
        const CLOCKS: [u64; 16] = [0, 8, 16, 24, 64, 80, 96, 112, 512, 576, 640, 704, 768, 832, 896, 960];
        CLOCKS[((self.0 >> 16) & 15) as usize]
    }

    /// ADC clocks before the sample is held: TRACKTIM + 1.
    pub fn tracking_clocks(self) -> u64 {
        u64::from((self.0 >> 24) & 15) + 1
    }

    /// ADC clocks from one conversion's start to the next one's: tracking, 12 bits, and a transfer of TRANSFER · 2 + 3; the
    /// cell itself takes no fewer than 20 (datasheet 45.7: 1 MS/s at 20 MHz).
    pub fn conversion_clocks(self) -> u64 {
        let transfer = u64::from((self.0 >> 28) & 3) * 2 + 3;
        (self.tracking_clocks() + 12 + transfer).max(20)
    }
}

/// EMR and CWR as the comparator sees them.
#[derive(Debug, Clone, Copy)]
pub struct CompareMode {
    pub extended: u32,
    pub window: u32,
}
