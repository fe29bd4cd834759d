//! The PWM's own write protection: six groups of registers, by software or for good (datasheet 38.6.6.4).

const KEY: u32 = 0x50_574D;

/// WPCR and WPSR.
#[derive(Debug, Clone, Default)]
pub struct Protection {
    software: u32,
    hardware: u32,
    violation: Option<u32>,
}

impl Protection {
    /// Writes WPCR: WPCMD 0 ends and 1 begins protection by software, 2 begins protection until a reset.
    pub fn command(&mut self, value: u32) {
        if value >> 8 != KEY {
            return;
        }
        let groups = (value >> 2) & 0x3F;
        match value & 3 {
            0 => self.software &= !groups,
            1 => self.software |= groups,
            2 => self.hardware |= groups,
            _ => {}
        }
    }

    /// WPSR; reading clears the violation.
    pub fn take_status(&mut self) -> u32 {
        let violation = self.violation.take().map_or(0, |offset| offset << 16 | 1 << 7);
        self.software | self.hardware << 8 | violation
    }

    /// True if the register at `offset` may be written; else records the violation.
    pub fn permits(&mut self, offset: u32) -> bool {
        let Some(group) = group(offset) else { return true };
        let refused = (self.software | self.hardware) & (1 << group) != 0;
        if refused {
            self.violation = Some(offset);
        }
        !refused
    }
}

/// The group of a register, if it has one.
fn group(offset: u32) -> Option<u32> {
    match offset {
        0x00 => Some(0),
        0x08 => Some(1),
        0x20 | 0xB0 => Some(2),
        0x5C | 0x68 | 0x6C | 0x70 => Some(5),
        0x200..0x300 => match offset % 0x20 {
            0x00 => Some(2),
            0x0C | 0x10 => Some(3),
            0x18 | 0x1C => Some(4),
            _ => None,
        },
        _ => None,
    }
}
