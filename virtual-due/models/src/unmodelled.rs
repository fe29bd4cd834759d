//! A peripheral without a model: it ignores writes, and is always ready for the next one.

use crate::model::{Context, Peripheral};

/// A peripheral without a model.
pub struct Unmodelled {
    name: &'static str,
    /// Offset of its status register, and the bits that a program waits for.
    ready: Option<(u32, u32)>,
}

impl Unmodelled {
    /// A peripheral that reads as 0.
    pub fn new(name: &'static str) -> Self {
        Self { name, ready: None }
    }

    /// A peripheral whose status register at `offset` reads as `bits`.
    pub fn ready(name: &'static str, offset: u32, bits: u32) -> Self {
        Self { name, ready: Some((offset, bits)) }
    }
}

impl Peripheral for Unmodelled {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        context
            .warnings
            .warn_once(format!("{} is not modelled: writes to it have no effect, and it reads as 0", self.name));
        match self.ready {
            Some((status, bits)) if status == offset => bits,
            _ => 0,
        }
    }

    fn write(&mut self, offset: u32, _value: u32, context: &mut Context) {
        self.read(offset, context);
    }

    fn reset(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::Unmodelled;
    use crate::test_support::Bench;

    #[test]
    fn it_is_ready_at_once_and_reported_once() {
        let mut bench = Bench::new(Unmodelled::ready("SSC", 0x40, 0b11));
        bench.write(0x24, 2048);
        assert_eq!((bench.read(0x40), bench.read(0x04)), (0b11, 0));
        assert_eq!(bench.warnings.take().len(), 1);
    }
}
