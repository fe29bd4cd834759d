//! Faults of the whole board, injected by name: those of the rig, and those of the chip.

use rig_twin::{Fault, FaultError, TimedFault};

use crate::machine::Machine;
use crate::rig::WiredRig;

/// Registers of the core that enable and disable interrupts 0 to 31; those of the next 32 follow (ARMv7-M, B3.4.4).
const NVIC_ISER0: u32 = 0xE000_E100;
const NVIC_ICER0: u32 = 0xE000_E180;

/// `push {r0-r7}` and a branch back to it.
const ENDLESS_PUSH: [u8; 4] = [0xFF, 0xB4, 0xFD, 0xE7];

/// Time in which a CPU that sleeps is woken by the tick of any firmware, cycles: 20 ms.
const WAKES: u64 = 1_680_000;
/// Time in which [`ENDLESS_PUSH`] fills all of the RAM many times over, cycles: 1 ms.
const FILLS_THE_STACK: u64 = 84_000;

impl Machine<WiredRig> {
    /// Begins a fault now.
    ///
    /// # Errors
    /// [`FaultError`] if the arm does not have the sensor, or the chip the place.
    pub fn inject(&mut self, fault: Fault) -> Result<(), FaultError> {
        self.check(fault)?;
        match fault {
            Fault::FlashFlip(address) => {
                for byte in self.peek(address, 1).into_iter().flatten() {
                    self.poke(address, &[byte ^ 1]);
                }
            }
            Fault::PowerCut => self.cut_power(),
            Fault::IrqMasked(line) => self.mask(line, NVIC_ICER0),
            Fault::StackOverflow => self.overflow_stack(),
            _ => {
                let now = self.now();
                let rig = self.world_mut();
                rig.advance_to(now);
                rig.inject(fault)?;
            }
        }
        Ok(())
    }

    /// Ends a fault now.
    pub fn clear(&mut self, fault: Fault) {
        if let Fault::IrqMasked(line) = fault {
            self.mask(line, NVIC_ISER0);
        }
        let now = self.now();
        let rig = self.world_mut();
        rig.advance_to(now);
        rig.clear(fault);
    }

    /// Checks that the board can have a fault.
    ///
    /// # Errors
    /// [`FaultError`].
    pub fn check(&self, fault: Fault) -> Result<(), FaultError> {
        match fault {
            Fault::FlashFlip(address) if self.peek(address, 1).is_none() => {
                Err(FaultError::NotOnChip(fault.to_string()))
            }
            _ => self.world().check(fault),
        }
    }

    /// Writes an interrupt's bit to one of the sets of registers.
    fn mask(&mut self, line: u8, first: u32) {
        // The core has these registers.
        let _ = self.poke_core(first + 4 * u32::from(line / 32), 1 << (line % 32));
    }

    /// Cuts the supply for an instant.
    fn cut_power(&mut self) {
        let now = self.now();
        let rig = self.world_mut();
        rig.advance_to(now);
        rig.cut_power();
        self.power_on();
    }

    /// Has the code that runs, as soon as the CPU is awake, push until its stack overflows; the code is whole again 1 ms later.
    fn overflow_stack(&mut self) {
        self.run_to(self.pc(), self.now() + WAKES);
        let pc = self.pc();
        let Some(code) = self.peek(pc, ENDLESS_PUSH.len()) else { return };
        self.poke(pc, &ENDLESS_PUSH);
        self.run_for(FILLS_THE_STACK);
        self.poke(pc, &code);
    }
}

/// Faults that a board gets at their times.
#[derive(Debug, Clone, Default)]
pub struct FaultSchedule {
    /// Those that have not begun, and those that have not ended.
    waiting: Vec<TimedFault>,
    present: Vec<TimedFault>,
}

impl FaultSchedule {
    /// A schedule of these faults.
    pub fn new(faults: Vec<TimedFault>) -> Self {
        Self { waiting: faults, present: Vec::new() }
    }

    /// Begins and ends what is due; call it in steps of board time, such as 2 ms.
    ///
    /// # Errors
    /// [`FaultError`] of the first fault that the board cannot have; [`Machine::check`] finds it before.
    pub fn apply(&mut self, machine: &mut Machine<WiredRig>) -> Result<(), FaultError> {
        let now_s = machine.seconds();
        for timed in self.present.extract_if(.., |timed| timed.has_ended(now_s)) {
            machine.clear(timed.fault);
        }
        for timed in self.waiting.extract_if(.., |timed| timed.has_begun(now_s)) {
            machine.inject(timed.fault)?;
            if timed.end_s.is_finite() {
                self.present.push(timed);
            }
        }
        Ok(())
    }
}
