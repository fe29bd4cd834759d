//! RSTC: the reset controller (datasheet 12).

use crate::model::{Cause, Context, Peripheral, Signal};

const CR: u32 = 0x00;
const SR: u32 = 0x04;
const MR: u32 = 0x08;
const KEY: u32 = 0xA5;
const PROCRST: u32 = 1;
const PERRST: u32 = 1 << 2;
const URSTS: u32 = 1;
const NRSTL: u32 = 1 << 16;
const URSTEN: u32 = 1;
const URSTIEN: u32 = 1 << 4;

/// The reset controller. Its registers are backed up: resets do not change RSTC_MR (datasheet 12.4.2.2).
pub struct Rstc {
    cause: Cause,
    user_reset: bool,
    mode: u32,
}

impl Rstc {
    /// State after power-on.
    pub fn new() -> Self {
        Self { cause: Cause::General, user_reset: false, mode: URSTEN }
    }
}

impl Peripheral for Rstc {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            SR => {
                let user_reset = if std::mem::take(&mut self.user_reset) { URSTS } else { 0 };
                user_reset | (self.cause as u32) << 8 | NRSTL
            }
            MR => self.mode,
            CR => 0,
            _ => {
                context.report.unmodelled("RSTC", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        if value >> 24 != KEY {
            return;
        }
        match offset {
            // Processor and peripherals can only be reset together, except for debugging (datasheet 12.4.4.4).
            CR if value & (PROCRST | PERRST) != 0 => context.signals.push(Signal::Reset(Cause::Software)),
            CR => {}
            MR => self.mode = value & 0x0000_0F11,
            _ => context.report.unmodelled("RSTC", offset),
        }
    }

    fn signal(&mut self, signal: Signal, _context: &mut Context) {
        if let Signal::Reset(cause) = signal {
            self.cause = cause;
            self.user_reset |= cause == Cause::User;
        }
    }

    fn interrupt(&self) -> bool {
        self.user_reset && self.mode & (URSTIEN | URSTEN) == URSTIEN
    }

    fn reset(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::{CR, Rstc, SR};
    use crate::model::{Cause, Signal};
    use crate::test_support::Bench;

    #[test]
    fn the_cause_of_the_last_reset_is_kept_and_urst_is_read_once() {
        let mut bench = Bench::new(Rstc::new());
        assert_eq!(bench.read(SR), 0x0001_0000);
        bench.signal(Signal::Reset(Cause::User));
        assert_eq!(bench.read(SR), 0x0001_0401);
        assert_eq!(bench.read(SR), 0x0001_0400);
    }

    #[test]
    fn a_reset_needs_the_key() {
        let mut bench = Bench::new(Rstc::new());
        bench.write(CR, 0x0000_0005);
        assert!(bench.signals.is_empty());
        bench.write(CR, 0xA500_0005);
        assert_eq!(bench.signalled(), [Signal::Reset(Cause::Software)]);
    }
}
