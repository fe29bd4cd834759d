//! What the board has to tell of a run that is not part of the run.

use std::collections::BTreeSet;

/// Things that a firmware did which the emulated board cannot answer for, each once.
#[derive(Debug, Default)]
pub struct Report {
    unmodelled: BTreeSet<(&'static str, u32)>,
    said: BTreeSet<String>,
    lines: Vec<String>,
}

impl Report {
    /// A register that the model `peripheral` does not have was touched.
    pub fn unmodelled(&mut self, peripheral: &'static str, offset: u32) {
        if self.unmodelled.insert((peripheral, offset)) {
            self.lines.push(format!("{peripheral}: register at offset {offset:#x} is not modelled"));
        }
    }

    /// Reports a text, once however often it happens.
    pub fn once(&mut self, text: String) {
        if self.said.insert(text.clone()) {
            self.lines.push(text);
        }
    }

    /// Takes what was reported since last asked.
    pub fn take(&mut self) -> Vec<String> {
        std::mem::take(&mut self.lines)
    }
}
