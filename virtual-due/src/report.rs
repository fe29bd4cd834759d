//! Reports: warnings of the models, with the time and the place in the program.

use crate::elf::Elf;
use sam3x_models::Warning;
use sam3x_models::model::{CYCLES_PER_SECOND, Cycles};
use std::fmt;

/// A report about the firmware. It is shown as one line: time, address, function, text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    /// Board time.
    pub at: Cycles,
    /// Address of the instruction that caused it; `None`: it came with time, without an instruction.
    pub pc: Option<u32>,
    /// Name of the function at that address, where the ELF has its symbol.
    pub function: Option<String>,
    /// The text.
    pub text: String,
}

impl Report {
    pub(crate) fn new(warning: Warning, elf: &Elf) -> Self {
        let Warning { at, pc, text } = warning;
        Self { at, pc, function: pc.and_then(|pc| elf.function(pc)), text }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "{:.6} s", self.at as f64 / CYCLES_PER_SECOND as f64)?;
        if let Some(pc) = self.pc {
            write!(formatter, ", pc {pc:#010x}")?;
        }
        if let Some(function) = &self.function {
            write!(formatter, " in {function}")?;
        }
        write!(formatter, ": {}", self.text)
    }
}
