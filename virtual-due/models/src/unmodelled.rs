//! A peripheral that the chip has and this board does not: it ignores writes, and is always ready for the next one.

use crate::model::{Context, Peripheral};

/// One of those.
pub struct Unmodelled {
    name: &'static str,
    /// Offset of its status register, and what a program that polls it waits for.
    ready: Option<(u32, u32)>,
}

impl Unmodelled {
    /// One that reads as 0.
    pub fn new(name: &'static str) -> Self {
        Self { name, ready: None }
    }

    /// One whose status register at `offset` reads as `bits`.
    pub fn ready(name: &'static str, offset: u32, bits: u32) -> Self {
        Self { name, ready: Some((offset, bits)) }
    }
}

impl Peripheral for Unmodelled {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        context
            .report
            .once(format!("{} is not modelled: what it is given goes nowhere, and it gives nothing", self.name));
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
    fn who_waits_for_it_does_not_wait_for_ever_and_is_told_once() {
        let mut bench = Bench::new(Unmodelled::ready("DACC", 0x30, 0xF));
        bench.write(0x20, 2048);
        assert_eq!((bench.read(0x30), bench.read(0x04)), (0xF, 0));
        assert_eq!(bench.report.take().len(), 1);
    }
}
