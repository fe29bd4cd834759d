//! UOTGHS: the native USB port, with no cable in it. Its registers store, its clock becomes usable, and no host ever
//! appears, so that programs that set it up continue (datasheet 39).

use crate::model::{Context, Peripheral};

const CTRL: u32 = 0x800;
const SR: u32 = 0x804;
const SCR: u32 = 0x808;
const SFR: u32 = 0x80C;
const FRZCLK: u32 = 1 << 14;
const USBE: u32 = 1 << 15;
const CLKUSABLE: u32 = 1 << 14;
/// Reset values of UOTGHS_DEVCTRL (DETACH) and UOTGHS_CTRL.
const DEVCTRL_RESET: u32 = 0x100;
const CTRL_RESET: u32 = 0x0300_4000;

/// UOTGHS_DEVIMR is set and cleared through DEVIER and DEVIDR.
const DEVIMR: u32 = 0x10;
const DEVIDR: u32 = 0x14;
const DEVIER: u32 = 0x18;

/// The port.
pub struct Uotghs {
    words: Vec<u32>,
}

impl Uotghs {
    /// State after a reset.
    pub fn new() -> Self {
        let mut words = vec![0; 0x830 / 4];
        words[0] = DEVCTRL_RESET;
        words[CTRL as usize / 4] = CTRL_RESET;
        Self { words }
    }

    fn word(&mut self, offset: u32) -> Option<&mut u32> {
        self.words.get_mut(offset as usize / 4)
    }
}

impl Peripheral for Uotghs {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            SR => {
                let control = self.words[CTRL as usize / 4];
                if control & (USBE | FRZCLK) == USBE { CLKUSABLE } else { 0 }
            }
            SCR | SFR => 0,
            _ => {
                if let Some(word) = self.word(offset) {
                    *word
                } else {
                    context.report.unmodelled("UOTGHS", offset);
                    0
                }
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            SR | SCR | SFR | DEVIMR => {}
            DEVIER => self.words[DEVIMR as usize / 4] |= value,
            DEVIDR => self.words[DEVIMR as usize / 4] &= !value,
            _ => match self.word(offset) {
                Some(word) => *word = value,
                None => context.report.unmodelled("UOTGHS", offset),
            },
        }
    }

    fn reset(&mut self) {
        *self = Self::new();
    }
}
