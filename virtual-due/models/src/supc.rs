//! SUPC: the part of the supply controller that selects the slow clock (datasheet 17).

use crate::model::{CYCLES_PER_SECOND, Context, Cycles, Peripheral};

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
                context.report.unmodelled("SUPC", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR if value >> 24 == KEY => {
                if value & XTALSEL != 0 && self.crystal.is_none() {
                    self.crystal = Some(context.now + CRYSTAL);
                }
                if value & VROFF != 0 {
                    context.report.warn_once("SUPC_CR.VROFF: backup mode is not modelled".to_owned());
                }
            }
            MR if value >> 24 == KEY => self.mode = value & 0x0012_7000 | 0x0A00,
            CR | MR => {}
            SMMR => self.monitor = value & 0x370F,
            WUMR => self.wake_up[0] = value,
            WUIR => self.wake_up[1] = value,
            _ => context.report.unmodelled("SUPC", offset),
        }
    }

    fn reset(&mut self) {}
}
