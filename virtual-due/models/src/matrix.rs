//! MATRIX: the bus matrix. Arbitration has no effect here, so that its registers only store (datasheet 21).

use crate::model::{Context, Peripheral};
use crate::write_protection::WriteProtection;

const SYSIO: u32 = 0x114;
const WPMR: u32 = 0x1E4;
const WPSR: u32 = 0x1E8;

/// Registers MATRIX_MCFG, SCFG, PRAS, MRCR and CCFG_SYSIO.
pub struct Matrix {
    words: [u32; 0x118 / 4],
    protection: WriteProtection,
}

impl Matrix {
    /// State after a reset.
    pub fn new() -> Self {
        Self { words: [0; 0x118 / 4], protection: WriteProtection::new(*b"MAT") }
    }
}

impl Peripheral for Matrix {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            0..=SYSIO => self.words[offset as usize / 4],
            WPMR => self.protection.mode(),
            WPSR => self.protection.take_status(),
            _ => {
                context.report.unmodelled("MATRIX", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            0..=SYSIO => {
                if self.protection.permits(offset) {
                    self.words[offset as usize / 4] = value;
                }
            }
            WPMR => self.protection.set_mode(value),
            _ => context.report.unmodelled("MATRIX", offset),
        }
    }

    fn reset(&mut self) {
        *self = Self::new();
    }
}
