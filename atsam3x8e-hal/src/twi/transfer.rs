//! State machine of one transfer: the next action for a status of the peripheral. It accesses no register.
//!
//! It has its own copy of the bytes, so that the interrupt handler has no dangling pointer after a future was dropped.

use super::error::Error;

/// Bytes of one write or one read.
pub const MAX_TRANSFER: usize = 32;

/// Status and interrupt bits (datasheet chapter 33, TWI_SR).
const TXCOMP: u32 = 1 << 0;
const RXRDY: u32 = 1 << 1;
const TXRDY: u32 = 1 << 2;
const OVRE: u32 = 1 << 6;
const NACK: u32 = 1 << 8;
const ARBLST: u32 = 1 << 9;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Bytes are to be moved.
    Moving,
    /// STOP is under way.
    Stopping,
    Finished(Result<(), Error>),
}

/// Action of the interrupt handler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    None,
    /// Read RHR and pass it to [`Transfer::receive`]; if `stop`, order STOP before.
    Read {
        stop: bool,
    },
    /// Write THR.
    Write(u8),
    /// Order STOP.
    Stop,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Transfer {
    address: u8,
    internal_address: u32,
    internal_address_size: u8,
    read: bool,
    buffer: [u8; MAX_TRANSFER],
    length: usize,
    /// Bytes written to THR or read from RHR.
    moved: usize,
    state: State,
}

impl Transfer {
    /// No transfer: interrupts are ignored.
    pub(super) const IDLE: Self = Self {
        address: 0,
        internal_address: 0,
        internal_address_size: 0,
        read: false,
        buffer: [0; MAX_TRANSFER],
        length: 0,
        moved: 0,
        state: State::Finished(Err(Error::Timeout)),
    };

    pub(super) fn write(address: u8, bytes: &[u8]) -> Result<Self, Error> {
        let mut transfer = Self::new(address, bytes.len())?;
        transfer.buffer.iter_mut().zip(bytes).for_each(|(to, byte)| *to = *byte);
        Ok(transfer)
    }

    /// A read, after the bytes of `register` (at most 3) and a repeated start if there are any.
    pub(super) fn read(address: u8, register: &[u8], length: usize) -> Result<Self, Error> {
        let transfer = Self::new(address, length)?;
        Ok(Self {
            read: true,
            // The most significant byte is sent first (datasheet chapter 33, internal address).
            internal_address: register.iter().fold(0, |value, &byte| value << 8 | u32::from(byte)),
            internal_address_size: register.len() as u8,
            ..transfer
        })
    }

    fn new(address: u8, length: usize) -> Result<Self, Error> {
        match length {
            0 => Err(Error::Unsupported),
            1..=MAX_TRANSFER => Ok(Self { address: address & 0x7F, length, state: State::Moving, ..Self::IDLE }),
            _ => Err(Error::TooLong),
        }
    }

    pub(super) fn address(&self) -> u8 {
        self.address
    }

    pub(super) fn internal_address(&self) -> u32 {
        self.internal_address
    }

    pub(super) fn internal_address_size(&self) -> u32 {
        self.internal_address_size.into()
    }

    pub(super) fn is_read(&self) -> bool {
        self.read
    }

    pub(super) fn length(&self) -> usize {
        self.length
    }

    pub(super) fn is_finished(&self) -> bool {
        matches!(self.state, State::Finished(_))
    }

    /// Result; `None`: the transfer has not ended.
    pub(super) fn result(&self) -> Option<Result<(), Error>> {
        match self.state {
            State::Finished(result) => Some(result),
            State::Moving | State::Stopping => None,
        }
    }

    pub(super) fn received(&self) -> &[u8] {
        self.buffer.get(..self.moved).unwrap_or(&[])
    }

    /// The byte that starts a write.
    pub(super) fn first_byte(&mut self) -> Action {
        self.moved = 1;
        self.buffer.first().map_or(Action::None, |&byte| Action::Write(byte))
    }

    /// Interrupts that the present state waits for.
    pub(super) fn interrupts(&self) -> u32 {
        const ERRORS: u32 = NACK | ARBLST;
        match self.state {
            State::Moving if self.read => RXRDY | OVRE | ERRORS,
            State::Moving => TXRDY | ERRORS,
            State::Stopping => TXCOMP | ERRORS,
            State::Finished(_) => 0,
        }
    }

    /// Decides from one snapshot of the status.
    ///
    /// Errors come first: a NACK sets TXRDY and TXCOMP too (datasheet chapter 33, TWI_SR), and nothing may be written after it.
    pub(super) fn next(&mut self, status: u32) -> Action {
        if self.is_finished() {
            return Action::None;
        }
        if status & ARBLST != 0 {
            return self.finish(Err(Error::ArbitrationLost));
        }
        if status & NACK != 0 {
            let error = self.nack();
            return self.finish(Err(error));
        }
        if status & OVRE != 0 && self.read {
            return self.finish(Err(Error::Overrun));
        }
        match self.state {
            State::Moving if self.read && status & RXRDY != 0 => Action::Read { stop: self.moved + 2 == self.length },
            State::Moving if !self.read && status & TXRDY != 0 => match self.buffer.get(self.moved) {
                Some(&byte) if self.moved < self.length => {
                    self.moved += 1;
                    Action::Write(byte)
                }
                _ => {
                    // The clock is held low until the STOP is ordered (datasheet chapter 33, master transmitter mode).
                    self.moved += 1;
                    self.state = State::Stopping;
                    Action::Stop
                }
            },
            State::Stopping if status & TXCOMP != 0 => self.finish(Ok(())),
            _ => Action::None,
        }
    }

    /// Takes a byte that was received.
    pub(super) fn receive(&mut self, byte: u8) {
        if let Some(to) = self.buffer.get_mut(self.moved) {
            *to = byte;
        }
        self.moved += 1;
        if self.moved >= self.length {
            self.state = State::Stopping;
        }
    }

    fn finish(&mut self, result: Result<(), Error>) -> Action {
        self.state = State::Finished(result);
        Action::None
    }

    /// Error of a NACK, by the byte that got it. While the address is on the wire, the first byte of a write is in THR.
    fn nack(&self) -> Error {
        match (self.read, self.internal_address_size) {
            (true, 0) => Error::NackAddress,
            (true, _) => Error::Nack,
            (false, _) if self.moved <= 1 => Error::NackAddress,
            (false, _) => Error::NackData,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_write_sends_its_bytes_then_stop_then_ends_with_txcomp() {
        let mut transfer = Transfer::write(0x28, &[0x3D, 0x08]).expect("two bytes fit");
        assert_eq!(transfer.first_byte(), Action::Write(0x3D));
        assert_eq!(transfer.next(0), Action::None);
        assert_eq!(transfer.next(TXRDY), Action::Write(0x08));
        assert_eq!(transfer.next(TXRDY), Action::Stop);
        assert_eq!(transfer.next(TXRDY), Action::None);
        assert!(!transfer.is_finished());
        transfer.next(TXRDY | TXCOMP);
        assert!(transfer.is_finished());
        assert_eq!(transfer.result(), Some(Ok(())));
    }

    #[test]
    fn nothing_is_written_after_a_nack_although_txrdy_comes_with_it() {
        let mut transfer = Transfer::write(0x28, &[1, 2, 3]).expect("three bytes fit");
        transfer.first_byte();
        assert_eq!(transfer.next(NACK | TXCOMP | TXRDY), Action::None);
        assert_eq!(transfer.interrupts(), 0);
        assert_eq!(transfer.result(), Some(Err(Error::NackAddress)));
    }

    #[test]
    fn a_nack_after_the_address_is_one_of_data() {
        let mut transfer = Transfer::write(0x28, &[1, 2]).expect("two bytes fit");
        transfer.first_byte();
        transfer.next(TXRDY);
        transfer.next(NACK | TXCOMP | TXRDY);
        assert_eq!(transfer.result(), Some(Err(Error::NackData)));

        // The only byte of a write: TXRDY has shown that the address was acknowledged.
        let mut transfer = Transfer::write(0x70, &[1]).expect("one byte fits");
        transfer.first_byte();
        transfer.next(TXRDY);
        transfer.next(NACK | TXCOMP | TXRDY);
        assert_eq!(transfer.result(), Some(Err(Error::NackData)));
    }

    #[test]
    fn a_read_orders_stop_with_its_next_to_last_byte() {
        let mut transfer = Transfer::read(0x28, &[0x20], 3).expect("three bytes fit");
        assert_eq!(transfer.next(RXRDY), Action::Read { stop: false });
        transfer.receive(10);
        assert_eq!(transfer.next(RXRDY), Action::Read { stop: true });
        transfer.receive(11);
        assert_eq!(transfer.next(RXRDY), Action::Read { stop: false });
        transfer.receive(12);
        assert_eq!(transfer.interrupts() & RXRDY, 0);
        transfer.next(TXCOMP);
        assert_eq!(transfer.result(), Some(Ok(())));
        assert_eq!(transfer.received(), [10, 11, 12]);
    }

    #[test]
    fn a_read_of_one_byte_orders_no_second_stop() {
        let mut transfer = Transfer::read(0x28, &[], 1).expect("one byte fits");
        assert_eq!(transfer.next(RXRDY), Action::Read { stop: false });
        transfer.receive(0xA0);
        transfer.next(TXCOMP);
        assert_eq!(transfer.result(), Some(Ok(())));
        assert_eq!(transfer.received(), [0xA0]);
    }

    #[test]
    fn the_register_s_first_byte_is_the_most_significant() {
        let transfer = Transfer::read(0x50, &[0x12, 0x34], 1).expect("one byte fits");
        assert_eq!((transfer.internal_address(), transfer.internal_address_size()), (0x1234, 2));
    }

    #[test]
    fn empty_and_overlong_transfers_are_refused() {
        assert_eq!(Transfer::write(0x28, &[]).err(), Some(Error::Unsupported));
        assert_eq!(Transfer::read(0x28, &[], 0).err(), Some(Error::Unsupported));
        assert_eq!(Transfer::read(0x28, &[], MAX_TRANSFER + 1).err(), Some(Error::TooLong));
        assert!(Transfer::write(0x28, &[0; MAX_TRANSFER]).is_ok());
    }

    #[test]
    fn an_interrupt_without_a_transfer_does_nothing() {
        let mut transfer = Transfer::IDLE;
        assert_eq!(transfer.next(TXRDY | RXRDY | TXCOMP), Action::None);
        assert_eq!(transfer.interrupts(), 0);
    }
}
