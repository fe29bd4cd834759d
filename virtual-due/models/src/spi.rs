//! SPI0 and SPI1 (datasheet chapter 32) with nothing on their wires: data are sent at once and lost, and the pull-up of MISO
//! reads as ones.

use crate::model::{Context, Peripheral};

const CR: u32 = 0x00;
const RDR: u32 = 0x08;
const TDR: u32 = 0x0C;
const SR: u32 = 0x10;

const SPIEN: u32 = 1 << 0;
const SPIDIS: u32 = 1 << 1;
const SWRST: u32 = 1 << 7;

const RDRF: u32 = 1 << 0;
const TDRE: u32 = 1 << 1;
const TXEMPTY: u32 = 1 << 9;
const SPIENS: u32 = 1 << 16;

/// SPI0 or SPI1.
#[derive(Debug)]
pub struct Spi {
    name: &'static str,
    enabled: bool,
    received: bool,
}

impl Spi {
    /// State after the chip's reset.
    pub fn new(name: &'static str) -> Self {
        Self { name, enabled: false, received: false }
    }

    fn control(&mut self, value: u32) {
        if value & SWRST != 0 {
            self.reset();
        }
        if value & SPIDIS != 0 {
            self.enabled = false;
        } else if value & SPIEN != 0 {
            self.enabled = true;
        }
    }

    fn status(&self) -> u32 {
        let bits = [(RDRF, self.received), (TDRE | TXEMPTY | SPIENS, self.enabled)];
        bits.iter().filter(|(_, set)| *set).fold(0, |status, (bit, _)| status | bit)
    }
}

impl Peripheral for Spi {
    fn read(&mut self, offset: u32, _context: &mut Context) -> u32 {
        match offset {
            SR => self.status(),
            RDR => {
                self.received = false;
                0xFF
            }
            _ => 0,
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR => self.control(value),
            TDR => {
                context.report.warn_once(format!("{} is not modelled: nothing is on its wires", self.name));
                self.received = self.enabled;
            }
            _ => {}
        }
    }

    fn reset(&mut self) {
        *self = Self::new(self.name);
    }
}

#[cfg(test)]
mod tests {
    use super::{CR, RDR, RDRF, SPIEN, SR, Spi, TDR, TDRE, TXEMPTY};
    use crate::test_support::Bench;

    #[test]
    fn a_transfer_ends_and_gives_ones_once() {
        let mut bench = Bench::new(Spi::new("SPI0"));
        assert_eq!(bench.read(SR), 0, "it is off after reset");
        bench.write(CR, SPIEN);
        assert_eq!(bench.read(SR) & (RDRF | TDRE | TXEMPTY), TDRE | TXEMPTY);
        bench.write(TDR, 0x55);
        assert_eq!(bench.read(SR) & (RDRF | TDRE | TXEMPTY), RDRF | TDRE | TXEMPTY);
        assert_eq!(bench.read(RDR), 0xFF);
        assert_eq!(bench.read(SR) & RDRF, 0);
        assert_eq!(bench.report.take().len(), 1);
    }
}
