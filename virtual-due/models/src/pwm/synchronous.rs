//! Synchronous channels: they share channel 0's counter, and their registers are updated together (datasheet 38.6.2.6).

use super::channel::{CHANNELS, Channel};
use crate::model::Memory;
use crate::pdc::{Pdc, Width};

pub const WRDY: u32 = 1 << 0;
pub const ENDTX: u32 = 1 << 1;
pub const TXBUFE: u32 = 1 << 2;
pub const UNRE: u32 = 1 << 3;

/// SCM, SCUC, SCUP and SCUPUPD.
#[derive(Debug, Clone, Default)]
pub struct Synchronous {
    /// SCM.
    pub mode: u32,
    /// SCUC.UPDULOCK.
    pub unlocked: bool,
    pub update_period: u32,
    pub next_update_period: Option<u32>,
    periods: u32,
}

impl Synchronous {
    /// SYNCx: a bit each.
    pub fn channels(&self) -> u32 {
        self.mode & 0xFF
    }

    pub fn includes(&self, index: usize) -> bool {
        self.channels() & (1 << index) != 0
    }

    /// SCUP.
    pub fn update_period_register(&self) -> u32 {
        self.update_period | self.periods << 4
    }

    fn update_mode(&self) -> u32 {
        (self.mode >> 16) & 3
    }

    /// True if the end of a period may change anything.
    pub fn acts(&self) -> bool {
        self.unlocked || self.update_mode() != 0
    }

    /// A period of channel 0 has ended; bits of ISR2. In mode 0 everything waits for UPDULOCK; in modes 1 and 2 duties are
    /// updated once in UPR + 1 periods, and in mode 2 the PDC has written them.
    pub fn end_period(&mut self, channels: &mut [Channel; CHANNELS], pdc: &mut Pdc, memory: &mut dyn Memory) -> u32 {
        let members = self.channels();
        let of_group = || (0..CHANNELS).filter(move |index| members & (1 << index) != 0);
        let automatic = self.update_mode() != 0;
        let due = automatic && self.periods >= self.update_period;
        for index in of_group() {
            if self.unlocked {
                channels[index].update_period();
            }
            if due || (self.unlocked && !automatic) {
                channels[index].update_duty();
            }
        }
        self.unlocked = false;
        if !automatic {
            return 0;
        }
        self.periods = if due { 0 } else { self.periods + 1 };
        if !due {
            return 0;
        }
        self.update_period = self.next_update_period.take().unwrap_or(self.update_period);
        if self.update_mode() == 1 {
            return WRDY;
        }
        let mut status = WRDY;
        for index in of_group() {
            match pdc.transmit(Width::HalfWord, memory) {
                Some(duty) => channels[index].next_duty = Some(duty),
                None => status |= UNRE,
            }
        }
        status
    }
}
