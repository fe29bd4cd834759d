//! The PDC: the DMA channels that a serial peripheral, the ADC or the PWM controller carries at offset 0x100 of its registers.
//!
//! The peripheral requests a transfer of each datum ([`Pdc::receive`], [`Pdc::transmit`]) and shows the PDC's four flags in
//! its own status register (datasheet 26.4).

use crate::model::Memory;

const RPR: u32 = 0x100;
const RCR: u32 = 0x104;
const TPR: u32 = 0x108;
const TCR: u32 = 0x10C;
const RNPR: u32 = 0x110;
const RNCR: u32 = 0x114;
const TNPR: u32 = 0x118;
const TNCR: u32 = 0x11C;
const PTCR: u32 = 0x120;
const PTSR: u32 = 0x124;

const RXTEN: u32 = 1 << 0;
const RXTDIS: u32 = 1 << 1;
const TXTEN: u32 = 1 << 8;
const TXTDIS: u32 = 1 << 9;

/// Size of one datum. Which one a peripheral uses is fixed by the chip or by the peripheral's mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// 8 bits.
    Byte,
    /// 16 bits.
    HalfWord,
    /// 32 bits.
    Word,
}

impl Width {
    fn bytes(self) -> usize {
        match self {
            Self::Byte => 1,
            Self::HalfWord => 2,
            Self::Word => 4,
        }
    }
}

/// One direction.
#[derive(Debug, Clone)]
struct Channel {
    pointer: u32,
    counter: u16,
    next_pointer: u32,
    next_counter: u16,
    enabled: bool,
    /// ENDRX or ENDTX: the counter has reached zero since a counter was last written.
    ended: bool,
}

impl Channel {
    /// Both counters are zero after a reset, and the flags are set: TWI_SR's reset value is 0xF009 (datasheet 33.11.6).
    fn new() -> Self {
        Self { pointer: 0, counter: 0, next_pointer: 0, next_counter: 0, enabled: false, ended: true }
    }

    /// Takes the address of the next datum; `None` if the channel is off or has nothing left.
    fn take(&mut self, width: Width) -> Option<u32> {
        if !self.enabled {
            return None;
        }
        self.load_next();
        self.counter = self.counter.checked_sub(1)?;
        let address = self.pointer;
        self.pointer = self.pointer.wrapping_add(width.bytes() as u32);
        if self.counter == 0 {
            self.ended = true;
            self.load_next();
        }
        Some(address)
    }

    /// At zero the next pair is taken over and itself becomes zero (datasheet 26.4.3).
    fn load_next(&mut self) {
        if self.counter == 0 && self.next_counter != 0 {
            self.pointer = self.next_pointer;
            self.counter = self.next_counter;
            self.next_pointer = 0;
            self.next_counter = 0;
        }
    }

    fn set_counter(&mut self, value: u32) {
        self.counter = value as u16;
        self.ended = self.counter == 0 && (self.ended || self.next_counter == 0);
    }

    fn set_next_counter(&mut self, value: u32) {
        self.next_counter = value as u16;
        self.ended &= self.next_counter == 0;
    }

    fn exhausted(&self) -> bool {
        self.counter == 0 && self.next_counter == 0
    }
}

/// The receive and the transmit channel of one peripheral.
#[derive(Debug, Clone)]
pub struct Pdc {
    receive: Channel,
    transmit: Channel,
}

impl Default for Pdc {
    fn default() -> Self {
        Self::new()
    }
}

impl Pdc {
    /// State after the chip's reset.
    pub fn new() -> Self {
        Self { receive: Channel::new(), transmit: Channel::new() }
    }

    /// True if the register at this offset of the peripheral belongs to the PDC.
    pub fn owns(offset: u32) -> bool {
        (RPR..=PTSR).contains(&offset)
    }

    /// The register at this offset of the peripheral.
    pub fn read(&self, offset: u32) -> u32 {
        match offset {
            RPR => self.receive.pointer,
            RCR => self.receive.counter.into(),
            TPR => self.transmit.pointer,
            TCR => self.transmit.counter.into(),
            RNPR => self.receive.next_pointer,
            RNCR => self.receive.next_counter.into(),
            TNPR => self.transmit.next_pointer,
            TNCR => self.transmit.next_counter.into(),
            PTSR => (if self.receive.enabled { RXTEN } else { 0 }) | (if self.transmit.enabled { TXTEN } else { 0 }),
            _ => 0,
        }
    }

    /// Writes the register at this offset of the peripheral, which then serves the channels if it is ready for them.
    pub fn write(&mut self, offset: u32, value: u32) {
        match offset {
            RPR => self.receive.pointer = value,
            RCR => self.receive.set_counter(value),
            TPR => self.transmit.pointer = value,
            TCR => self.transmit.set_counter(value),
            RNPR => self.receive.next_pointer = value,
            RNCR => self.receive.set_next_counter(value),
            TNPR => self.transmit.next_pointer = value,
            TNCR => self.transmit.set_next_counter(value),
            PTCR => self.control(value),
            _ => {}
        }
    }

    /// Disabling wins over enabling in the same write (datasheet 26.5.9).
    fn control(&mut self, value: u32) {
        if value & RXTDIS != 0 {
            self.receive.enabled = false;
        } else if value & RXTEN != 0 {
            self.receive.enabled = true;
        }
        if value & TXTDIS != 0 {
            self.transmit.enabled = false;
        } else if value & TXTEN != 0 {
            self.transmit.enabled = true;
        }
    }

    /// Writes a received datum to memory; false if the channel is off or its buffers are full. A datum for an address
    /// without RAM is lost.
    pub fn receive(&mut self, datum: u32, width: Width, memory: &mut dyn Memory) -> bool {
        let Some(address) = self.receive.take(width) else { return false };
        memory.write(address, &datum.to_le_bytes()[..width.bytes()]);
        true
    }

    /// Reads the next datum to transmit; `None` if the channel is off or has nothing left. An address without memory reads
    /// as zero.
    pub fn transmit(&mut self, width: Width, memory: &mut dyn Memory) -> Option<u32> {
        let address = self.transmit.take(width)?;
        let mut bytes = [0; 4];
        memory.read(address, &mut bytes[..width.bytes()]);
        Some(u32::from_le_bytes(bytes))
    }

    /// Data left in the current transmit buffer; zero where the channel is off.
    pub fn transmit_left(&self) -> u16 {
        if self.transmit.enabled { self.transmit.counter } else { 0 }
    }

    /// ENDRX: RCR has reached zero since RCR or RNCR was last written with anything else.
    pub fn end_of_receive(&self) -> bool {
        self.receive.ended
    }

    /// RXBUFF: RCR and RNCR are zero.
    pub fn receive_buffer_full(&self) -> bool {
        self.receive.exhausted()
    }

    /// ENDTX: TCR has reached zero since TCR or TNCR was last written with anything else.
    pub fn end_of_transmit(&self) -> bool {
        self.transmit.ended
    }

    /// TXBUFE: TCR and TNCR are zero.
    pub fn transmit_buffer_empty(&self) -> bool {
        self.transmit.exhausted()
    }
}

#[cfg(test)]
mod tests {
    use super::{PTCR, PTSR, Pdc, RCR, RNCR, RNPR, RPR, RXTDIS, RXTEN, TCR, TPR, TXTEN, Width};
    use crate::test_support::Ram;

    fn receiver(memory: &mut Ram) -> Pdc {
        let mut pdc = Pdc::new();
        for (offset, value) in [(RPR, memory.base), (RCR, 2), (RNPR, memory.base + 0x10), (RNCR, 1), (PTCR, RXTEN)] {
            pdc.write(offset, value);
        }
        pdc
    }

    #[test]
    fn next_buffer_is_taken_over_when_the_first_is_full() {
        let mut memory = Ram::new();
        let mut pdc = receiver(&mut memory);
        assert!(!pdc.end_of_receive() && !pdc.receive_buffer_full());
        for datum in [0x1111, 0x2222] {
            assert!(pdc.receive(datum, Width::HalfWord, &mut memory));
        }
        assert!(pdc.end_of_receive() && !pdc.receive_buffer_full());
        assert_eq!((pdc.read(RPR), pdc.read(RCR)), (memory.base + 0x10, 1));
        assert_eq!((pdc.read(RNPR), pdc.read(RNCR)), (0, 0));
        assert!(pdc.receive(0x3333, Width::HalfWord, &mut memory));
        assert!(pdc.receive_buffer_full());
        assert!(!pdc.receive(0x4444, Width::HalfWord, &mut memory));
        assert_eq!(memory.bytes[..4], [0x11, 0x11, 0x22, 0x22]);
        assert_eq!(memory.bytes[0x10..0x14], [0x33, 0x33, 0, 0]);
    }

    #[test]
    fn end_of_receive_is_cleared_by_a_counter_that_is_not_zero() {
        let mut memory = Ram::new();
        let mut pdc = receiver(&mut memory);
        pdc.receive(1, Width::Byte, &mut memory);
        pdc.receive(2, Width::Byte, &mut memory);
        assert!(pdc.end_of_receive());
        pdc.write(RNCR, 0);
        assert!(pdc.end_of_receive());
        pdc.write(RNCR, 5);
        assert!(!pdc.end_of_receive());
    }

    #[test]
    fn transmits_from_memory_until_its_counter_is_zero() {
        let mut memory = Ram::new();
        memory.bytes[..3].copy_from_slice(b"abc");
        let mut pdc = Pdc::new();
        pdc.write(TPR, memory.base);
        pdc.write(TCR, 3);
        assert_eq!(pdc.transmit(Width::Byte, &mut memory), None, "it is not enabled yet");
        pdc.write(PTCR, TXTEN);
        let sent: Vec<u32> = std::iter::from_fn(|| pdc.transmit(Width::Byte, &mut memory)).collect();
        assert_eq!(sent, [0x61, 0x62, 0x63]);
        assert!(pdc.end_of_transmit() && pdc.transmit_buffer_empty());
        assert_eq!(pdc.read(TPR), memory.base + 3);
    }

    #[test]
    fn disabling_wins_over_enabling() {
        let mut pdc = Pdc::new();
        pdc.write(PTCR, RXTEN | TXTEN);
        assert_eq!(pdc.read(PTSR), RXTEN | TXTEN);
        pdc.write(PTCR, RXTEN | RXTDIS);
        assert_eq!(pdc.read(PTSR), TXTEN);
    }
}
