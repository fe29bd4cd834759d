//! GPBR: eight words that keep their value over every reset except power-on (datasheet 18).

use crate::model::{Cause, Context, Peripheral, Signal};

/// The general purpose backup registers.
#[derive(Debug, Default)]
pub struct Gpbr {
    words: [u32; 8],
}

impl Gpbr {
    /// State after power-on: zeros.
    pub fn new() -> Self {
        Self::default()
    }
}

impl Peripheral for Gpbr {
    fn read(&mut self, offset: u32, _context: &mut Context) -> u32 {
        self.words.get(offset as usize / 4).copied().unwrap_or(0)
    }

    fn write(&mut self, offset: u32, value: u32, _context: &mut Context) {
        if let Some(word) = self.words.get_mut(offset as usize / 4) {
            *word = value;
        }
    }

    fn reset(&mut self) {}

    /// Power-on clears the words.
    fn signal(&mut self, signal: Signal, _context: &mut Context) {
        if signal == Signal::Reset(Cause::General) {
            self.words = [0; 8];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Gpbr;
    use crate::model::Peripheral;
    use crate::test_support::Bench;

    #[test]
    fn words_survive_a_reset() {
        let mut bench = Bench::new(Gpbr::new());
        bench.write(0x1C, 42);
        bench.model.reset();
        assert_eq!(bench.read(0x1C), 42);
    }
}
