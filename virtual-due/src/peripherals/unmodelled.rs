//! A peripheral that the chip has and this board does not: it reads as zero and ignores writes.

use crate::model::{Context, Peripheral};

/// One of those, by its name.
pub struct Unmodelled(pub &'static str);

impl Peripheral for Unmodelled {
    fn read(&mut self, _offset: u32, context: &mut Context) -> u32 {
        context.report.once(format!("{} is not modelled: it reads as 0 and ignores writes", self.0));
        0
    }

    fn write(&mut self, offset: u32, _value: u32, context: &mut Context) {
        self.read(offset, context);
    }

    fn reset(&mut self) {}
}
