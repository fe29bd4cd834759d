//! The common part of UART and USART: a shift register and a holding register each way, the first nine registers, and the
//! PDC (datasheet 34.5 and 35.7.3).

use crate::model::{Context, Cycles, Reception};
use crate::pdc::{Pdc, Width};

pub const CR: u32 = 0x00;
pub const MR: u32 = 0x04;
const IER: u32 = 0x08;
const IDR: u32 = 0x0C;
const IMR: u32 = 0x10;
const SR: u32 = 0x14;
const RHR: u32 = 0x18;
const THR: u32 = 0x1C;
pub const BRGR: u32 = 0x20;

const RSTRX: u32 = 1 << 2;
const RSTTX: u32 = 1 << 3;
const RXEN: u32 = 1 << 4;
const RXDIS: u32 = 1 << 5;
const TXEN: u32 = 1 << 6;
const TXDIS: u32 = 1 << 7;
const RSTSTA: u32 = 1 << 8;

const RXRDY: u32 = 1 << 0;
const TXRDY: u32 = 1 << 1;
const ENDRX: u32 = 1 << 3;
const ENDTX: u32 = 1 << 4;
const OVRE: u32 = 1 << 5;
const FRAME: u32 = 1 << 6;
const PARE: u32 = 1 << 7;
const TXEMPTY: u32 = 1 << 9;
const TXBUFE: u32 = 1 << 11;
const RXBUFF: u32 = 1 << 12;

/// Present set-up of the port.
#[derive(Debug, Clone, Copy)]
pub struct Format {
    /// Time from a start bit to the end of the last stop bit; zero: there is no baud rate.
    pub byte_time: Cycles,
    /// Idle time of the line after each byte sent.
    pub guard_time: Cycles,
    /// The character's bits.
    pub mask: u8,
    /// Connection of receiver and transmitter to the pins.
    pub mode: ChannelMode,
}

/// MR.CHMODE, bits 15:14 (datasheet 34.5.6).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChannelMode {
    /// Receiver and transmitter have a pin each.
    Normal,
    /// Received bytes are also sent; the transmitter is disconnected.
    AutomaticEcho,
    /// The receiver receives the transmitter's bytes; both pins are disconnected.
    LocalLoopback,
    /// Arriving bytes are sent and nothing else; receiver and transmitter are disconnected.
    RemoteLoopback,
}

impl ChannelMode {
    /// From MR.
    pub fn of(mode_register: u32) -> Self {
        match (mode_register >> 14) & 3 {
            0 => Self::Normal,
            1 => Self::AutomaticEcho,
            2 => Self::LocalLoopback,
            _ => Self::RemoteLoopback,
        }
    }
}

/// A serial port.
#[derive(Debug, Clone)]
pub struct Serial {
    port: usize,
    pdc: Pdc,
    interrupt_mask: u32,
    receiver_on: bool,
    transmitter_on: bool,
    /// THR, while it waits for the shift register.
    holding: Option<u8>,
    /// The byte that is being sent, and the end of its last stop bit.
    shifting: Option<(u8, Cycles)>,
    /// Until then the line is idle.
    line_free: Cycles,
    /// Time from one byte of the PDC's to the next, where only the line observes that the bytes leave.
    unseen_pace: Option<Cycles>,
    received: u8,
    /// RXRDY and the error bits.
    latched: u32,
    next_reception: Option<Cycles>,
    last_reception: Option<Cycles>,
}

impl Serial {
    /// The port that [`crate::model::World`] calls `port`, after the chip's reset.
    pub fn new(port: usize) -> Self {
        Self {
            port,
            pdc: Pdc::new(),
            interrupt_mask: 0,
            receiver_on: false,
            transmitter_on: false,
            holding: None,
            shifting: None,
            line_free: 0,
            unseen_pace: None,
            received: 0,
            latched: 0,
            next_reception: None,
            last_reception: None,
        }
    }

    /// The port's number in [`crate::model::World`].
    pub fn port(&self) -> usize {
        self.port
    }

    /// True if the register at `offset` is read and written here.
    pub fn owns(offset: u32) -> bool {
        matches!(offset, CR | IER | IDR | IMR | SR | RHR | THR) || Pdc::owns(offset)
    }

    /// Reads a register; `more_status` are the bits of SR that only the USART has.
    pub fn read(&mut self, offset: u32, more_status: u32) -> u32 {
        match offset {
            IMR => self.interrupt_mask,
            SR => self.status() | more_status,
            RHR => {
                self.latched &= !RXRDY;
                self.received.into()
            }
            _ => self.pdc.read(offset),
        }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32, format: Format, context: &mut Context) {
        match offset {
            CR => self.control(value),
            IER => self.interrupt_mask |= value,
            IDR => self.interrupt_mask &= !value,
            THR if self.transmitter_on => self.holding = Some(value as u8 & format.mask),
            _ if Pdc::owns(offset) => self.pdc.write(offset, value),
            _ => {}
        }
        self.serve(format, context);
    }

    /// Resets come before enables; a disable wins over an enable in the same write (datasheet 34.6.1).
    fn control(&mut self, value: u32) {
        if value & RSTRX != 0 {
            self.receiver_on = false;
            self.latched &= !RXRDY;
        }
        if value & RSTTX != 0 {
            self.transmitter_on = false;
            self.holding = None;
            self.shifting = None;
        }
        if value & RXDIS != 0 {
            self.receiver_on = false;
        } else if value & RXEN != 0 {
            self.receiver_on = true;
        }
        // Bytes in THR and in the shift register are still sent (datasheet 34.5.3.1).
        if value & TXDIS != 0 {
            self.transmitter_on = false;
        } else if value & TXEN != 0 {
            self.transmitter_on = true;
        }
        if value & RSTSTA != 0 {
            self.latched &= RXRDY;
        }
        if !self.receiver_on {
            self.next_reception = None;
        }
    }

    /// Moves waiting bytes to PDC and shift register, and polls for the next byte that arrives.
    pub fn serve(&mut self, format: Format, context: &mut Context) {
        let unseen = format.mode == ChannelMode::Normal && self.interrupt_mask & (TXRDY | TXEMPTY) == 0;
        self.unseen_pace = unseen.then_some(format.byte_time + format.guard_time);
        self.pass_on_received(context);
        self.load(context.now, format, context);
        self.receive(format, context);
    }

    /// Sends and receives all bytes that are due.
    pub fn advance(&mut self, format: Format, context: &mut Context) {
        while let Some((byte, end)) = self.shifting
            && end <= context.now
        {
            self.shifting = None;
            self.line_free = end + format.guard_time;
            match format.mode {
                ChannelMode::Normal => context.world.transmitted(self.port, byte, end),
                ChannelMode::LocalLoopback => self.arrive(byte, end, context),
                ChannelMode::AutomaticEcho | ChannelMode::RemoteLoopback => {}
            }
            self.load(end, format, context);
        }
        self.serve(format, context);
    }

    /// Moves THR to the shift register, and the PDC's next byte to THR.
    fn load(&mut self, at: Cycles, format: Format, context: &mut Context) {
        self.fill(format, context);
        if self.shifting.is_none()
            && format.byte_time != 0
            && let Some(byte) = self.holding.take()
        {
            self.shifting = Some((byte, at.max(self.line_free) + format.byte_time));
            self.fill(format, context);
        }
    }

    fn fill(&mut self, format: Format, context: &mut Context) {
        if self.transmitter_on && self.holding.is_none() {
            self.holding = self.pdc.transmit(Width::Byte, context.memory).map(|datum| datum as u8 & format.mask);
        }
    }

    /// Receives bytes. They are lost while the receiver is off or disconnected from its pin.
    fn receive(&mut self, format: Format, context: &mut Context) {
        self.next_reception = None;
        if format.byte_time == 0 {
            return;
        }
        let repeats = matches!(format.mode, ChannelMode::AutomaticEcho | ChannelMode::RemoteLoopback);
        let hears = self.receiver_on && matches!(format.mode, ChannelMode::Normal | ChannelMode::AutomaticEcho);
        loop {
            match context.world.receive(self.port, format.byte_time, context.now) {
                Reception::Idle => return,
                Reception::At(at) => {
                    self.next_reception = (hears || repeats).then_some(at);
                    return;
                }
                Reception::Byte(byte) => {
                    if repeats {
                        context.world.transmitted(self.port, byte, context.now);
                    }
                    if hears {
                        self.arrive(byte & format.mask, context.now, context);
                    }
                }
            }
        }
    }

    fn arrive(&mut self, byte: u8, at: Cycles, context: &mut Context) {
        if !self.receiver_on {
            return;
        }
        if self.latched & RXRDY != 0 {
            self.latched |= OVRE;
        }
        self.latched |= RXRDY;
        self.received = byte;
        self.last_reception = Some(at);
        self.pass_on_received(context);
    }

    fn pass_on_received(&mut self, context: &mut Context) {
        if self.latched & RXRDY != 0 && self.pdc.receive(self.received.into(), Width::Byte, context.memory) {
            self.latched &= !RXRDY;
        }
    }

    /// Takes the time of the last reception.
    pub fn take_last_reception(&mut self) -> Option<Cycles> {
        self.last_reception.take()
    }

    /// Time at which the next byte will have been sent or received; of bytes by PDC that only the line observes, the time
    /// at which the last of the buffer is taken. [`advance`](Self::advance) sends those between at their own times.
    pub fn next_event(&self) -> Option<Cycles> {
        let sent = self.shifting.map(|(_, end)| match self.unseen_pace {
            Some(pace) if self.holding.is_some() && self.transmitter_on => {
                end + u64::from(self.pdc.transmit_left().saturating_sub(1)) * pace
            }
            _ => end,
        });
        [sent, self.next_reception].into_iter().flatten().min()
    }

    /// Interrupts that are enabled.
    pub fn interrupt_mask(&self) -> u32 {
        self.interrupt_mask
    }

    /// SR, without the bits that only the USART has. Reading it clears nothing (datasheet 34.6.6).
    pub fn status(&self) -> u32 {
        let bits = [
            (TXRDY, self.transmitter_on && self.holding.is_none()),
            (TXEMPTY, self.transmitter_on && self.holding.is_none() && self.shifting.is_none()),
            (ENDRX, self.pdc.end_of_receive()),
            (ENDTX, self.pdc.end_of_transmit()),
            (RXBUFF, self.pdc.receive_buffer_full()),
            (TXBUFE, self.pdc.transmit_buffer_empty()),
        ];
        let live = bits.iter().filter(|(_, set)| *set).fold(0, |status, (bit, _)| status | bit);
        live | self.latched & (RXRDY | OVRE | FRAME | PARE)
    }
}
