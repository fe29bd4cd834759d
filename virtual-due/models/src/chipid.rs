//! CHIPID: the chip's identifier (datasheet 29).

use crate::model::{Context, Peripheral};

/// SAM3X8E revision A, 512 KiB of flash, 96 KiB of SRAM (datasheet 29.2).
const CIDR: u32 = 0x285E_0A60;

/// The identifier's registers.
pub struct ChipId;

impl Peripheral for ChipId {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            0 => CIDR,
            4 => 0,
            _ => {
                context.report.unmodelled("CHIPID", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, _value: u32, context: &mut Context) {
        context.report.warn_once(format!("CHIPID: write to a read-only register at offset {offset:#x}"));
    }

    fn reset(&mut self) {}
}
