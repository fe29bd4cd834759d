//! Warnings about the firmware's use of the emulated board.

use std::collections::BTreeSet;

/// Warnings about actions of the firmware that the emulated board does not model faithfully, each once.
#[derive(Debug, Default)]
pub struct Report {
    unmodelled: BTreeSet<(&'static str, u32)>,
    warned: BTreeSet<String>,
    lines: Vec<String>,
}

impl Report {
    /// Reports an access to a register that the model of `peripheral` does not have.
    pub fn unmodelled(&mut self, peripheral: &'static str, offset: u32) {
        if self.unmodelled.insert((peripheral, offset)) {
            self.lines.push(format!("{peripheral}: register at offset {offset:#x} is not modelled"));
        }
    }

    /// Reports a text, the first time that it occurs.
    pub fn warn_once(&mut self, text: String) {
        if self.warned.insert(text.clone()) {
            self.lines.push(text);
        }
    }

    /// Takes the warnings since the last call.
    pub fn take(&mut self) -> Vec<String> {
        std::mem::take(&mut self.lines)
    }
}
