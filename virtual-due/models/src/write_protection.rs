//! The write protection that several peripherals share: WPMR with a key, WPSR with the offset of the refused register.

const WPEN: u32 = 1;

/// WPMR and WPSR.
#[derive(Debug, Clone)]
pub struct WriteProtection {
    key: u32,
    enabled: bool,
    violation: Option<u32>,
}

impl WriteProtection {
    /// Off; `key` is three ASCII characters, written to WPMR's upper 24 bits.
    pub fn new(key: [u8; 3]) -> Self {
        Self { key: u32::from_be_bytes([0, key[0], key[1], key[2]]), enabled: false, violation: None }
    }

    /// WPMR: the key reads as zero.
    pub fn mode(&self) -> u32 {
        self.enabled.into()
    }

    /// Writes WPMR; without the key nothing changes.
    pub fn set_mode(&mut self, value: u32) {
        if value >> 8 == self.key {
            self.enabled = value & WPEN != 0;
        }
    }

    /// WPSR: WPVS and, in WPVSRC, the offset of the register that was refused last. Reading clears it.
    pub fn take_status(&mut self) -> u32 {
        self.violation.take().map_or(0, |offset| (offset << 8) | 1)
    }

    /// True if a protected register may be written; else records the violation.
    pub fn permits(&mut self, offset: u32) -> bool {
        if self.enabled {
            self.violation = Some(offset);
        }
        !self.enabled
    }
}

#[cfg(test)]
mod tests {
    use super::WriteProtection;

    #[test]
    fn key_switches_protection_and_a_violation_is_read_once() {
        let mut protection = WriteProtection::new(*b"ADC");
        protection.set_mode(0x1234_5601);
        assert!(protection.permits(4));
        protection.set_mode(0x4144_4301);
        assert_eq!(protection.mode(), 1);
        assert!(!protection.permits(0x10));
        assert_eq!(protection.take_status(), 0x1001);
        assert_eq!(protection.take_status(), 0);
        protection.set_mode(0x4144_4300);
        assert!(protection.permits(4));
    }
}
