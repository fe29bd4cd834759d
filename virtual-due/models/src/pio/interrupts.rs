//! Interrupts on edges and levels of pins (datasheet 31.5.10).

const IER: u32 = 0x40;
const IDR: u32 = 0x44;
const IMR: u32 = 0x48;
const AIMER: u32 = 0xB0;
const AIMDR: u32 = 0xB4;
const AIMMR: u32 = 0xB8;
const ESR: u32 = 0xC0;
const LSR: u32 = 0xC4;
const ELSR: u32 = 0xC8;
const FELLSR: u32 = 0xD0;
const REHLSR: u32 = 0xD4;
const FRLHSR: u32 = 0xD8;
const LOCKSR: u32 = 0xE0;

/// A controller's interrupt registers, a bit a line.
#[derive(Debug, Default)]
pub struct Interrupts {
    mask: u32,
    status: u32,
    /// AIMMR: edge or level as selected by ELSR and FRLHSR; else any edge.
    additional: u32,
    /// ELSR: level rather than edge.
    level: u32,
    /// FRLHSR: rising edge or high level rather than falling or low.
    rising_or_high: u32,
}

impl Interrupts {
    /// Updates the status for pins that changed from `before` to `now`.
    pub fn update(&mut self, before: u32, now: u32) {
        let changed = before ^ now;
        let polarity = !(now ^ self.rising_or_high);
        let edges = changed & polarity & !self.level;
        let levels = polarity & self.level;
        self.status |= changed & !self.additional | (edges | levels) & self.additional;
    }

    /// True if an interrupt is enabled, so that pins have to be sampled.
    pub fn enabled(&self) -> bool {
        self.mask != 0
    }

    /// True if the interrupt line is raised.
    pub fn raised(&self) -> bool {
        self.status & self.mask != 0
    }

    /// ISR, which reading clears.
    pub fn take_status(&mut self) -> u32 {
        std::mem::take(&mut self.status)
    }

    /// A register of this part; `None`: it is of another, or write-only.
    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            IMR => self.mask,
            AIMMR => self.additional,
            ELSR => self.level,
            FRLHSR => self.rising_or_high,
            AIMER | AIMDR | ESR | LSR | FELLSR | REHLSR | LOCKSR => 0,
            _ => return None,
        })
    }

    /// Writes a register of this part; false if it is of another.
    pub fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            IER => self.mask |= value,
            IDR => self.mask &= !value,
            AIMER => self.additional |= value,
            AIMDR => self.additional &= !value,
            ESR => self.level &= !value,
            LSR => self.level |= value,
            FELLSR => self.rising_or_high &= !value,
            REHLSR => self.rising_or_high |= value,
            IMR | AIMMR | ELSR | FRLHSR | LOCKSR => {}
            _ => return false,
        }
        true
    }
}
