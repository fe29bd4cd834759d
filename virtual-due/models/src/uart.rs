//! The UART (datasheet chapter 34): the programming port of an Arduino Due.

use crate::model::{Context, Cycles, Peripheral};
use crate::serial::{BRGR, ChannelMode, Format, MR, Serial};

const MR_BITS: u32 = 0xCE00;

/// The UART. Its line is always perfect: FRAME and PARE are never set.
#[derive(Debug, Clone)]
pub struct Uart {
    serial: Serial,
    mode: u32,
    divisor: u16,
}

impl Uart {
    /// State after the chip's reset; `port` is its number in [`crate::model::World`].
    pub fn new(port: usize) -> Self {
        Self { serial: Serial::new(port), mode: 0, divisor: 0 }
    }

    /// Baud rate = MCK / (16 · CD), none at CD = 0 (datasheet 34.5.1); a start bit, 8 data bits, parity, a stop bit.
    fn format(&self, context: &Context) -> Format {
        let parity_bits = u64::from((self.mode >> 9) & 7 < 4);
        Format {
            byte_time: context.master_cycles((10 + parity_bits) * 16 * u64::from(self.divisor)),
            guard_time: 0,
            mask: 0xFF,
            mode: ChannelMode::of(self.mode),
        }
    }
}

impl Peripheral for Uart {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        let value = match offset {
            MR => self.mode,
            BRGR => self.divisor.into(),
            _ if Serial::owns(offset) => self.serial.read(offset, 0),
            _ => {
                context.report.unmodelled("UART", offset);
                0
            }
        };
        self.serial.serve(self.format(context), context);
        value
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            MR => self.mode = value & MR_BITS,
            BRGR => self.divisor = value as u16,
            _ if Serial::owns(offset) => {}
            _ => context.report.unmodelled("UART", offset),
        }
        self.serial.write(offset, value, self.format(context), context);
    }

    fn advance(&mut self, context: &mut Context) {
        self.serial.advance(self.format(context), context);
    }

    fn next_event(&self) -> Option<Cycles> {
        self.serial.next_event()
    }

    fn interrupt(&self) -> bool {
        self.serial.status() & self.serial.interrupt_mask() != 0
    }

    fn reset(&mut self) {
        *self = Self::new(self.serial.port());
    }
}

#[cfg(test)]
mod tests {
    use super::Uart;
    use crate::model::Peripheral;
    use crate::test_support::Bench;

    const CR: u32 = 0x00;
    const MR: u32 = 0x04;
    const IER: u32 = 0x08;
    const IDR: u32 = 0x0C;
    const IMR: u32 = 0x10;
    const SR: u32 = 0x14;
    const RHR: u32 = 0x18;
    const THR: u32 = 0x1C;
    const BRGR: u32 = 0x20;

    const RXRDY: u32 = 1 << 0;
    const TXRDY: u32 = 1 << 1;
    const ENDTX: u32 = 1 << 4;
    const OVRE: u32 = 1 << 5;
    const TXEMPTY: u32 = 1 << 9;
    const TXBUFE: u32 = 1 << 11;

    /// 84 MHz / (16 · 21) = 250 000 Bd: 336 cycles a bit, 3360 a byte.
    const BYTE: u64 = 3360;

    /// No parity, 250 000 Bd, both ways on.
    fn port() -> Bench<Uart> {
        let mut bench = Bench::new(Uart::new(0));
        bench.write(MR, 0x800);
        bench.write(BRGR, 21);
        bench.write(CR, 0x50);
        bench
    }

    fn sent(bench: &Bench<Uart>) -> Vec<(u8, u64)> {
        bench.world.sent.iter().map(|(_, byte, at)| (*byte, *at)).collect()
    }

    #[test]
    fn nothing_is_ready_before_the_transmitter_is_enabled() {
        let mut bench = Bench::new(Uart::new(0));
        assert_eq!(bench.read(SR) & (TXRDY | TXEMPTY | RXRDY), 0);
        bench.write(CR, 1 << 6);
        assert_eq!(bench.read(SR) & (TXRDY | TXEMPTY | RXRDY), TXRDY | TXEMPTY);
    }

    #[test]
    fn bytes_leave_one_byte_time_apart() {
        let mut bench = port();
        bench.write(THR, b'a'.into());
        assert_eq!(bench.read(SR) & (TXRDY | TXEMPTY), TXRDY, "the shift register took it at once");
        bench.write(THR, b'b'.into());
        assert_eq!(bench.read(SR) & TXRDY, 0);
        bench.run(BYTE);
        assert_eq!(bench.read(SR) & (TXRDY | TXEMPTY), TXRDY);
        bench.run(BYTE - 1);
        assert_eq!(sent(&bench), [(b'a', BYTE)]);
        bench.run(1);
        assert_eq!(sent(&bench), [(b'a', BYTE), (b'b', 2 * BYTE)]);
        assert_eq!(bench.read(SR) & (TXRDY | TXEMPTY), TXRDY | TXEMPTY);
    }

    #[test]
    fn pdc_sends_a_buffer_without_a_gap() {
        let mut bench = port();
        bench.memory.bytes[..5].copy_from_slice(b"hello");
        for (offset, value) in [(0x108, bench.memory.base), (0x10C, 5), (0x120, 1 << 8)] {
            bench.write(offset, value);
        }
        assert_eq!(bench.read(0x10C), 3, "one byte is in the shift register and one in THR");
        assert_eq!(bench.read(SR) & ENDTX, 0);
        bench.run(3 * BYTE);
        assert_eq!(bench.read(SR) & (ENDTX | TXBUFE | TXEMPTY), ENDTX | TXBUFE);
        bench.run(2 * BYTE);
        assert_eq!(sent(&bench).last(), Some(&(b'o', 5 * BYTE)));
        assert_ne!(bench.read(SR) & TXEMPTY, 0);
    }

    /// A hundred bytes by PDC.
    fn sending(interrupts: u32) -> Bench<Uart> {
        let mut bench = port();
        for (offset, value) in [(IER, interrupts), (0x108, bench.memory.base), (0x10C, 100), (0x120, 1 << 8)] {
            bench.write(offset, value);
        }
        bench
    }

    #[test]
    fn bytes_by_pdc_are_no_events_but_leave_at_their_own_times() {
        let mut bench = sending(ENDTX);
        // THR takes the last byte as the shift register takes the one before.
        assert_eq!(bench.model.next_event(), Some(98 * BYTE));
        bench.now = 50 * BYTE;
        assert_eq!(bench.read(0x10C), 48);
        assert_eq!(sent(&bench), (1..=50).map(|count| (0, count * BYTE)).collect::<Vec<_>>());
        bench.run(48 * BYTE - 1);
        assert!(!bench.model.interrupt());
        bench.run(1);
        assert!(bench.model.interrupt());
    }

    #[test]
    fn bytes_by_pdc_are_events_where_their_interrupt_is_enabled() {
        assert_eq!(sending(TXEMPTY).model.next_event(), Some(BYTE));
        assert_eq!(sending(TXRDY).model.next_event(), Some(BYTE));
    }

    #[test]
    fn unread_byte_is_overrun_and_reported_until_status_is_reset() {
        let mut bench = port();
        bench.world.arriving.extend([(BYTE, b'x'), (2 * BYTE, b'y')]);
        bench.run(BYTE - 1);
        assert_eq!(bench.read(SR) & RXRDY, 0);
        bench.run(1);
        assert_eq!(bench.read(SR) & (RXRDY | OVRE), RXRDY);
        bench.run(BYTE);
        assert_eq!(bench.read(SR) & (RXRDY | OVRE), RXRDY | OVRE);
        assert_eq!(bench.read(RHR), b'y'.into());
        assert_eq!(bench.read(SR) & (RXRDY | OVRE), OVRE);
        bench.write(CR, 1 << 8);
        assert_eq!(bench.read(SR) & (RXRDY | OVRE), 0);
    }

    #[test]
    fn what_arrives_while_the_receiver_is_off_is_lost() {
        let mut bench = port();
        bench.write(CR, 1 << 5);
        bench.world.arriving.extend([(BYTE, b'x'), (3 * BYTE, b'y')]);
        bench.run(2 * BYTE);
        bench.write(CR, 1 << 4);
        assert_eq!(bench.read(SR) & RXRDY, 0);
        bench.run(BYTE);
        assert_eq!(bench.read(SR) & (RXRDY | OVRE), RXRDY);
        assert_eq!(bench.read(RHR), b'y'.into());
    }

    #[test]
    fn pdc_receives_into_memory_and_the_interrupt_follows_its_mask() {
        let mut bench = port();
        bench.world.arriving.extend([(BYTE, 1), (2 * BYTE, 2)]);
        for (offset, value) in [(0x100, bench.memory.base), (0x104, 2), (0x120, 1), (IER, 1 << 3)] {
            bench.write(offset, value);
        }
        bench.run(2 * BYTE - 1);
        assert!(!bench.model.interrupt());
        bench.run(1);
        assert!(bench.model.interrupt());
        assert_eq!(bench.memory.bytes[..2], [1, 2]);
        assert_eq!(bench.read(SR) & (RXRDY | OVRE), 0);
        assert_eq!(bench.read(IMR), 1 << 3);
        bench.write(IDR, 1 << 3);
        assert!(!bench.model.interrupt());
    }

    #[test]
    fn local_loopback_receives_what_it_sends_and_keeps_it_off_the_pin() {
        let mut bench = port();
        bench.write(MR, 0x8800);
        bench.write(THR, 0x5A);
        bench.run(BYTE);
        assert_eq!(bench.read(RHR), 0x5A);
        assert!(bench.world.sent.is_empty());
    }

    #[test]
    fn automatic_echo_sends_what_arrives() {
        let mut bench = port();
        bench.write(MR, 0x4800);
        bench.world.arriving.push_back((BYTE, 7));
        bench.run(BYTE);
        assert_eq!((bench.read(RHR), sent(&bench)), (7, vec![(7, BYTE)]));
    }

    #[test]
    fn disabled_transmitter_still_sends_what_it_has() {
        let mut bench = port();
        bench.write(THR, 1);
        bench.write(THR, 2);
        bench.write(CR, 1 << 7);
        assert_eq!(bench.read(SR) & (TXRDY | TXEMPTY), 0);
        bench.run(2 * BYTE);
        assert_eq!(sent(&bench).len(), 2);
    }
}
