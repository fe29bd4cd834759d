//! TWI0 and TWI1 (datasheet chapter 33) as masters. Slave mode is reported.

mod master;
mod status;
#[cfg(test)]
mod tests;

use crate::model::{Context, Cycles, Peripheral, Signal};
use crate::pdc::{Pdc, Width};
use master::Master;
use status::{ENDRX, ENDTX, RXBUFF, SVREAD, TXBUFE};

const CR: u32 = 0x00;
const MMR: u32 = 0x04;
const SMR: u32 = 0x08;
const IADR: u32 = 0x0C;
const CWGR: u32 = 0x10;
const SR: u32 = 0x20;
const IER: u32 = 0x24;
const IDR: u32 = 0x28;
const IMR: u32 = 0x2C;
const RHR: u32 = 0x30;
const THR: u32 = 0x34;

const START: u32 = 1 << 0;
const STOP: u32 = 1 << 1;
const MSEN: u32 = 1 << 2;
const MSDIS: u32 = 1 << 3;
const SVEN: u32 = 1 << 4;
const QUICK: u32 = 1 << 6;
const SWRST: u32 = 1 << 7;

/// Port and lines of TWD and TWCK, as peripheral A: PA17 and PA18, PB12 and PB13 (datasheet 9.3).
const PINS: [(u8, u32); 2] = [(0, 1 << 17 | 1 << 18), (1, 1 << 12 | 1 << 13)];

/// A two-wire interface.
#[derive(Debug, Clone)]
pub struct Twi {
    index: usize,
    master: Master,
    slave_mode: u32,
    interrupt_mask: u32,
    pdc: Pdc,
}

impl Twi {
    /// TWI0 or TWI1 after the chip's reset.
    pub fn new(index: usize) -> Self {
        Self { index, master: Master::new(index), slave_mode: 0, interrupt_mask: 0, pdc: Pdc::new() }
    }

    fn name(&self) -> &'static str {
        if self.index == 0 { "TWI0" } else { "TWI1" }
    }

    /// SR without clearing anything. SVREAD is high while no slave was addressed: reset value 0xF009 (datasheet 33.11.6).
    fn status(&self) -> u32 {
        let bits = [
            (ENDRX, self.pdc.end_of_receive()),
            (ENDTX, self.pdc.end_of_transmit()),
            (RXBUFF, self.pdc.receive_buffer_full()),
            (TXBUFE, self.pdc.transmit_buffer_empty()),
        ];
        bits.iter().filter(|(_, set)| *set).fold(self.master.status() | SVREAD, |status, (bit, _)| status | bit)
    }

    fn control(&mut self, value: u32, context: &mut Context) {
        if value & SWRST != 0 {
            self.software_reset();
        }
        if value & MSDIS != 0 {
            self.master.disable(context);
        } else if value & MSEN != 0 {
            self.master.enable();
        }
        // A master's start-up code may write SVEN before MSEN; a slave has an address.
        if value & SVEN != 0 && self.slave_mode != 0 {
            context.report.unmodelled(self.name(), SMR);
        }
        if value & QUICK != 0 {
            self.master.quick(context);
        }
        if value & START != 0 {
            self.master.start(context);
        }
        if value & STOP != 0 {
            self.master.stop(context);
        }
    }

    /// Resets all but the PDC, which is another macrocell, and the connection of the pins.
    fn software_reset(&mut self) {
        let connected = self.master.connected;
        *self = Self { pdc: self.pdc.clone(), ..Self::new(self.index) };
        self.master.connected = connected;
    }

    /// RXRDY and TXRDY are the PDC's requests (datasheet 33.8.8).
    fn serve_pdc(&mut self, context: &mut Context) {
        if let Some(byte) = self.master.received()
            && self.pdc.receive(byte.into(), Width::Byte, context.memory)
        {
            self.master.take_received();
        }
        while self.master.wants_byte()
            && let Some(byte) = self.pdc.transmit(Width::Byte, context.memory)
        {
            self.master.write(byte as u8, context);
        }
    }
}

impl Peripheral for Twi {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            MMR => self.master.mode,
            SMR => self.slave_mode,
            IADR => self.master.internal_address,
            CWGR => self.master.waveform,
            SR => {
                let status = self.status();
                self.master.status_was_read();
                status
            }
            IMR => self.interrupt_mask,
            RHR => self.master.take_received().into(),
            CR | IER | IDR | THR => 0,
            _ if Pdc::owns(offset) => self.pdc.read(offset),
            _ => {
                context.report.unmodelled(self.name(), offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR => self.control(value, context),
            MMR => self.master.mode = value & 0x7F_1300,
            SMR => self.slave_mode = value & 0x7F_0000,
            IADR => self.master.internal_address = value & 0xFF_FFFF,
            CWGR => self.master.waveform = value & 0x7_FFFF,
            IER => self.interrupt_mask |= value & 0xFF77,
            IDR => self.interrupt_mask &= !value,
            THR => self.master.write(value as u8, context),
            SR | IMR | RHR => {}
            _ if Pdc::owns(offset) => self.pdc.write(offset, value),
            _ => context.report.unmodelled(self.name(), offset),
        }
        self.serve_pdc(context);
    }

    fn advance(&mut self, context: &mut Context) {
        while self.master.step(context) {
            self.serve_pdc(context);
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        self.master.next_event()
    }

    fn interrupt(&self) -> bool {
        self.status() & self.interrupt_mask != 0
    }

    fn signal(&mut self, signal: Signal, _context: &mut Context) {
        if let Signal::Pins { port, a, .. } = signal
            && let Some((own, lines)) = PINS.get(self.index)
            && port == *own
        {
            self.master.connected = a & lines == *lines;
        }
    }

    fn reset(&mut self) {
        *self = Self::new(self.index);
    }
}
