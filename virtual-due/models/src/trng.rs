//! TRNG: the random number generator (datasheet 42). Its numbers are the same in every run, so that runs can be repeated.

use crate::model::{Context, Cycles, Peripheral};

const CR: u32 = 0x00;
const IER: u32 = 0x10;
const IDR: u32 = 0x14;
const IMR: u32 = 0x18;
const ISR: u32 = 0x1C;
const ODATA: u32 = 0x50;
const KEY: u32 = 0x0052_4E47;
/// A number takes 84 periods of the master clock (datasheet 42.2).
const PERIOD: u64 = 84;

/// The generator.
#[derive(Debug)]
pub struct Trng {
    state: u64,
    mask: bool,
    ready: bool,
    next: Option<Cycles>,
}

impl Trng {
    /// Off.
    pub fn new() -> Self {
        Self { state: 0x9E37_79B9_7F4A_7C15, mask: false, ready: false, next: None }
    }

    /// A step of Marsaglia's xorshift.
    fn step(&mut self) {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 7;
        self.state ^= self.state << 17;
    }
}

impl Peripheral for Trng {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            IMR => self.mask.into(),
            ISR => std::mem::take(&mut self.ready).into(),
            ODATA => (self.state >> 32) as u32,
            CR | IER | IDR => 0,
            _ => {
                context.report.unmodelled("TRNG", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR if value >> 8 == KEY => {
                self.next = (value & 1 != 0).then(|| context.now + context.master_cycles(PERIOD));
            }
            CR => {}
            IER => self.mask |= value & 1 != 0,
            IDR => self.mask &= value & 1 == 0,
            _ => context.report.unmodelled("TRNG", offset),
        }
    }

    fn advance(&mut self, context: &mut Context) {
        while let Some(next) = self.next.filter(|next| *next <= context.now) {
            self.step();
            self.ready = true;
            let period = context.master_cycles(PERIOD).max(1);
            // Numbers that are not read need not be generated.
            let skipped = (context.now - next) / period;
            self.next = Some(next + (skipped + 1) * period);
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        self.next.filter(|_| self.mask && !self.ready)
    }

    fn interrupt(&self) -> bool {
        self.mask && self.ready
    }

    fn reset(&mut self) {
        *self = Self::new();
    }
}
