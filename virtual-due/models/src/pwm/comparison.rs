//! A comparison unit (datasheet 38.6.3). Matches are signalled at the end of the period in which they occur.

const CEN: u32 = 1;

/// CMPV, CMPM and their updates.
#[derive(Debug, Clone, Default)]
pub struct Comparison {
    pub value: u32,
    pub mode: u32,
    pub next_value: Option<u32>,
    pub next_mode: Option<u32>,
    /// CPRCNT.
    periods: u32,
}

impl Comparison {
    pub fn runs(&self) -> bool {
        self.mode & CEN != 0 || self.next_mode.is_some() || self.next_value.is_some()
    }

    /// CMPM with its counter of periods.
    pub fn mode_register(&self) -> u32 {
        self.mode | self.periods << 12
    }

    /// A period of channel 0 has ended; bits of ISR2. The unit compares in one of CPR + 1 periods, the CTR-th.
    pub fn end_period(&mut self, unit: u32) -> u32 {
        let mut status = 0;
        if self.mode & CEN != 0 {
            if self.periods == (self.mode >> 4) & 15 {
                status |= 1 << (8 + unit);
            }
            self.periods = if self.periods >= (self.mode >> 8) & 15 { 0 } else { self.periods + 1 };
        }
        if self.next_value.is_some() || self.next_mode.is_some() {
            self.value = self.next_value.take().unwrap_or(self.value);
            self.mode = self.next_mode.take().unwrap_or(self.mode);
            status |= 1 << (16 + unit);
        }
        status
    }
}
