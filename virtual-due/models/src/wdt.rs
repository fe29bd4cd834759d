//! WDT: the watchdog (datasheet 16). It runs from reset on and expires after 16 s.

use crate::model::{Cause, Context, Cycles, Peripheral, Signal};
use crate::ticks::Ticks;

const CR: u32 = 0x00;
const MR: u32 = 0x04;
const SR: u32 = 0x08;
const KEY: u32 = 0xA5;
const MR_RESET: u32 = 0x3FFF_2FFF;
const WDFIEN: u32 = 1 << 12;
const WDRSTEN: u32 = 1 << 13;
const WDDIS: u32 = 1 << 15;
const WDUNF: u32 = 1;
const WDERR: u32 = 2;
/// It counts slow clock / 128 (datasheet 16.3).
const DIVIDER: u32 = 128;
const SLOW_CLOCK_HZ: u32 = 32_768;

/// The watchdog. WDIDLEHLT and WDDBGHLT are stored and stop nothing: sleep is WFI with all clocks running, and there is
/// no debugger.
pub struct Wdt {
    mode: u32,
    mode_written: bool,
    status: u32,
    ticks: Ticks,
}

impl Wdt {
    /// State after a reset, counting from time 0 until the signal of a reset.
    pub fn new() -> Self {
        let ticks = Ticks { origin: 0, hz: SLOW_CLOCK_HZ, divisor: DIVIDER };
        Self { mode: MR_RESET, mode_written: false, status: 0, ticks }
    }

    fn value(&self) -> u64 {
        u64::from(self.mode & 0xFFF)
    }

    fn delta(&self) -> u64 {
        u64::from(self.mode >> 16 & 0xFFF)
    }

    fn runs(&self) -> bool {
        self.mode & WDDIS == 0
    }

    fn expire(&mut self, flag: u32, context: &mut Context) {
        self.status |= flag;
        if self.mode & WDRSTEN != 0 {
            context.signals.push(Signal::Reset(Cause::Watchdog));
        }
    }

    /// Instant at which the down-counter passes zero.
    fn end(&self) -> Option<Cycles> {
        self.ticks.time(self.value() + 1).filter(|_| self.runs())
    }
}

impl Peripheral for Wdt {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            MR => self.mode,
            SR => std::mem::take(&mut self.status),
            CR => 0,
            _ => {
                context.report.unmodelled("WDT", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR if value >> 24 == KEY && value & 1 != 0 && self.runs() => {
                let left = self.value().saturating_sub(self.ticks.at(context.now));
                // A restart above WDD is an error (datasheet 16.4).
                if left > self.delta() {
                    self.expire(WDERR, context);
                }
                self.ticks.origin = context.now;
            }
            CR => {}
            // Once per reset (datasheet 16.4).
            MR if !self.mode_written => {
                self.mode = value & 0x3FFF_FFFF;
                self.mode_written = true;
                self.ticks.origin = context.now;
            }
            MR => context.report.warn_once("WDT_MR written again: it can be written once per reset".to_owned()),
            _ => context.report.unmodelled("WDT", offset),
        }
    }

    fn advance(&mut self, context: &mut Context) {
        while let Some(end) = self.end().filter(|end| *end <= context.now) {
            self.ticks.origin = end;
            self.expire(WDUNF, context);
        }
    }

    fn signal(&mut self, signal: Signal, context: &mut Context) {
        if let Signal::Reset(_) = signal {
            self.ticks.origin = context.now;
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        self.end()
    }

    fn interrupt(&self) -> bool {
        self.status != 0 && self.mode & WDFIEN != 0
    }

    fn reset(&mut self) {
        *self = Self::new();
    }
}

#[cfg(test)]
mod tests {
    use super::{CR, MR, SR, Wdt};
    use crate::model::{CYCLES_PER_SECOND, Cause, Signal};
    use crate::test_support::Bench;

    #[test]
    fn it_expires_16_seconds_after_reset() {
        let mut bench = Bench::new(Wdt::new());
        bench.run(16 * CYCLES_PER_SECOND - 1);
        assert!(bench.signals.is_empty());
        bench.run(1);
        assert_eq!(bench.signalled(), [Signal::Reset(Cause::Watchdog)]);
    }

    #[test]
    fn restarted_in_time_it_does_not_expire() {
        let mut bench = Bench::new(Wdt::new());
        bench.write(MR, 0x0FFF_2000 + 25);
        for _ in 0..100 {
            bench.run(CYCLES_PER_SECOND / 20);
            bench.write(CR, 0xA500_0001);
        }
        assert!(bench.signals.is_empty());
        bench.run(CYCLES_PER_SECOND / 5);
        assert_eq!(bench.signalled().first(), Some(&Signal::Reset(Cause::Watchdog)));
    }

    #[test]
    fn its_mode_can_be_written_once() {
        let mut bench = Bench::new(Wdt::new());
        bench.write(MR, 0x8000);
        bench.write(MR, 0x3FFF_2FFF);
        assert_eq!(bench.read(MR), 0x8000);
        bench.run(40 * CYCLES_PER_SECOND);
        assert!(bench.signals.is_empty());
    }

    #[test]
    fn underflow_without_reset_raises_the_interrupt() {
        use crate::model::Peripheral;
        let mut bench = Bench::new(Wdt::new());
        bench.write(MR, 0x0FFF_1000 + 255);
        bench.run(CYCLES_PER_SECOND + 1000);
        assert!(bench.model.interrupt() && bench.signals.is_empty());
        assert_eq!(bench.read(SR), 1);
        assert!(!bench.model.interrupt());
    }
}
