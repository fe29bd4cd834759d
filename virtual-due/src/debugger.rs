//! The board under a debugger: breakpoints, steps, registers.

use crate::cpu::{Cpu, Stop};
use crate::machine::Machine;
use sam3x_models::model::{Cycles, World};

impl<W: World> Machine<W> {
    /// Runs until board time `end`, or until a breakpoint's instruction is next; true if a breakpoint was reached.
    pub fn run_to_breakpoint(&mut self, end: Cycles) -> bool {
        if let Some(pc) = self.stopped_at.take().filter(|pc| *pc == self.cpu.pc() && self.breakpoints.contains(pc)) {
            self.cpu.pass_breakpoint(pc);
        }
        let stopped = self.run(end);
        self.stopped_at = stopped.then(|| self.cpu.pc());
        stopped
    }

    /// Runs one instruction, or sleeps until it can; false if board time `end` comes before.
    pub fn step(&mut self, end: Cycles) -> bool {
        let before = self.cpu.instructions();
        loop {
            self.process_pending();
            if self.cpu.instructions() > before {
                self.stopped_at = Some(self.cpu.pc());
                return true;
            }
            if self.now() >= end {
                self.chip.advance_all(self.cpu.instructions());
                return false;
            }
            // The bus grants no more instructions after an access.
            self.chip.limit = 0;
            let pc = self.cpu.pc();
            if self.breakpoints.contains(&pc) {
                self.cpu.pass_breakpoint(pc);
            }
            match self.cpu.run(1, &mut self.chip) {
                Stop::Returned | Stop::Breakpoint => {}
                Stop::Waiting => self.sleep(end),
                Stop::Lockup => {
                    self.report_lockup();
                    self.sleep(end);
                }
            }
        }
    }

    /// Sets a breakpoint, for [`run_to_breakpoint`](Self::run_to_breakpoint); false if that is not possible.
    pub fn add_breakpoint(&mut self, address: u32) -> bool {
        let address = address & !1;
        self.breakpoints.contains(&address) || self.cpu.add_breakpoint(address) && self.breakpoints.insert(address)
    }

    /// Removes a breakpoint; false if there was none.
    pub fn remove_breakpoint(&mut self, address: u32) -> bool {
        let address = address & !1;
        if self.breakpoints.remove(&address) {
            self.cpu.remove_breakpoint(address);
            return true;
        }
        false
    }

    /// Removes all breakpoints.
    pub fn remove_breakpoints(&mut self) {
        for address in std::mem::take(&mut self.breakpoints) {
            self.cpu.remove_breakpoint(address);
        }
    }

    /// A register by GDB's number: r0 to r15, xPSR, and those of [`debugger_description`](Self::debugger_description).
    pub fn register(&self, number: usize) -> Option<u32> {
        self.cpu.register(number)
    }

    /// Writes a register by GDB's number; false for an unknown number.
    pub fn set_register(&mut self, number: usize, value: u32) -> bool {
        self.cpu.set_register(number, value)
    }

    /// GDB's description of the registers.
    pub fn debugger_description(&self) -> &'static str {
        self.cpu.debugger_description()
    }

    /// Reads an aligned word of a peripheral's registers as a debugger does, with the side effects of reading; `None` where
    /// there is no register.
    pub fn peek_peripheral(&mut self, address: u32) -> Option<u32> {
        self.chip.debugger_access(address, None, self.cpu.pc(), self.cpu.instructions())
    }

    /// Writes an aligned word of a peripheral's registers as a debugger does; false where there is no register.
    pub fn poke_peripheral(&mut self, address: u32, value: u32) -> bool {
        self.chip.debugger_access(address, Some(value), self.cpu.pc(), self.cpu.instructions()).is_some()
    }
}
