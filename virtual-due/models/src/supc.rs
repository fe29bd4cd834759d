//! SUPC: the part of the supply controller that selects the slow clock (datasheet 17).

use crate::model::{CYCLES_PER_SECOND, Context, Cycles, Peripheral, Signal};

const CR: u32 = 0x00;
const SMMR: u32 = 0x04;
const MR: u32 = 0x08;
const WUMR: u32 = 0x0C;
const WUIR: u32 = 0x10;
const SR: u32 = 0x14;
const KEY: u32 = 0xA5;
const VROFF: u32 = 1 << 2;
const XTALSEL: u32 = 1 << 3;
const OSCSEL: u32 = 1 << 7;
const MR_RESET: u32 = 0x0000_5A00;
/// The crystal takes about 0.7 s to start.
const CRYSTAL: Cycles = 7 * CYCLES_PER_SECOND / 10;

/// The supply controller. Only power-on resets its registers.
pub struct Supc {
    monitor: u32,
    mode: u32,
    wake_up: [u32; 2],
    /// Instant from which the crystal oscillator is the slow clock.
    crystal: Option<Cycles>,
}

impl Supc {
    /// State after power-on.
    pub fn new() -> Self {
        Self { monitor: 0, mode: MR_RESET, wake_up: [0; 2], crystal: None }
    }
}

impl Peripheral for Supc {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            SMMR => self.monitor,
            MR => self.mode,
            WUMR => self.wake_up[0],
            WUIR => self.wake_up[1],
            SR => {
                if self.crystal.is_some_and(|then| then <= context.now) {
                    OSCSEL
                } else {
                    0
                }
            }
            CR => 0,
            _ => {
                context.warnings.unmodelled("SUPC", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR if value >> 24 == KEY => {
                if value & XTALSEL != 0 && self.crystal.is_none() {
                    self.crystal = Some(context.now + CRYSTAL);
                    context.signals.push(Signal::SlowCrystal(context.now + CRYSTAL));
                }
                if value & VROFF != 0 {
                    context.warnings.warn_once("SUPC_CR.VROFF: backup mode is not modelled".to_owned());
                }
            }
            MR if value >> 24 == KEY => self.mode = value & 0x0012_7000 | 0x0A00,
            CR | MR => {}
            SMMR => self.monitor = value & 0x370F,
            WUMR => self.wake_up[0] = value,
            WUIR => self.wake_up[1] = value,
            _ => context.warnings.unmodelled("SUPC", offset),
        }
    }

    /// The crystal survives the reset of the PMC, which shows it.
    fn signal(&mut self, signal: Signal, context: &mut Context) {
        if let (Signal::Reset(_), Some(then)) = (signal, self.crystal) {
            context.signals.push(Signal::SlowCrystal(then));
        }
    }

    fn reset(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::{CR, CRYSTAL, OSCSEL, SR, Supc};
    use crate::model::{Cause, Signal};
    use crate::test_support::Bench;

    #[test]
    fn crystal_is_the_slow_clock_after_its_start_and_stays_it_over_resets() {
        let mut bench = Bench::new(Supc::new());
        bench.write(CR, 0xA500_0008);
        bench.run(CRYSTAL - 1);
        assert_eq!(bench.read(SR) & OSCSEL, 0);
        bench.run(1);
        assert_eq!(bench.read(SR) & OSCSEL, OSCSEL);
        bench.signal(Signal::Reset(Cause::User));
        assert_eq!(bench.read(SR) & OSCSEL, OSCSEL);
        assert_eq!(bench.signalled(), [Signal::SlowCrystal(CRYSTAL); 2]);
    }

    #[test]
    fn crystal_is_not_selected_without_the_key() {
        let mut bench = Bench::new(Supc::new());
        bench.write(CR, 0x0000_0008);
        assert_eq!(bench.signalled(), []);
    }
}
