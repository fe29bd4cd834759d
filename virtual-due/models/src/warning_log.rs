//! Warnings about the firmware's use of the emulated board.

use std::collections::BTreeSet;

/// A warning, and when and where the firmware caused it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// Board time, cycles of 84 MHz since power-on.
    pub at: u64,
    /// Address of the instruction whose access caused it; `None`: no access did.
    pub pc: Option<u32>,
    /// The text, without a full stop.
    pub text: String,
}

/// Warnings about actions of the firmware that the emulated board does not model faithfully, each once.
#[derive(Debug, Default)]
pub struct WarningLog {
    /// Time of the warnings that follow, cycles of 84 MHz since power-on.
    pub now: u64,
    /// Address of the instruction that accesses the chip now.
    pub pc: Option<u32>,
    unmodelled: BTreeSet<(&'static str, u32)>,
    warned: BTreeSet<String>,
    warnings: Vec<Warning>,
}

impl WarningLog {
    /// Reports an access to a register that the model of `peripheral` does not have.
    pub fn unmodelled(&mut self, peripheral: &'static str, offset: u32) {
        if self.unmodelled.insert((peripheral, offset)) {
            self.push(format!("{peripheral}: register at offset {offset:#x} is not modelled"));
        }
    }

    /// Reports a text, the first time that it occurs.
    pub fn warn_once(&mut self, text: String) {
        if self.warned.insert(text.clone()) {
            self.push(text);
        }
    }

    /// Takes the warnings since the last call.
    pub fn take(&mut self) -> Vec<Warning> {
        std::mem::take(&mut self.warnings)
    }

    fn push(&mut self, text: String) {
        self.warnings.push(Warning { at: self.now, pc: self.pc, text });
    }
}
