//! The master (datasheet 33.8): a frame is a chain of steps, each of a byte or a condition on the wires.
//!
//! After the last byte of a write the clock is held low until THR is written again or STOP is requested. A read continues byte
//! by byte until STOP is requested, whether or not RHR is read in time.

use super::status::{ARBLST, NACK, OVRE, RXRDY, TXCOMP, TXRDY};
use crate::model::{Context, Cycles};

const MREAD: u32 = 1 << 12;

/// A step on the wires.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    /// A start condition and the address.
    Address { address: u8, read: bool },
    /// A byte of the internal address; this many come after it.
    InternalAddress { address: u32, after: u32 },
    /// A byte to the device.
    Write(u8),
    /// A byte from the device.
    Read,
    /// The clock is held low: nothing to send, and no STOP requested.
    Hold,
    /// A stop condition.
    Stop,
}

/// A frame under way.
#[derive(Debug, Clone, Copy)]
struct Frame {
    step: Step,
    /// The step's clocks run; before that a device may stretch the clock.
    clocking: bool,
    /// Instant at which the clocks begin, or end.
    at: Cycles,
    /// It has the device's internal address still to send.
    internal: bool,
    quick: bool,
}

/// The state that the firmware requested after the byte under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NextState {
    Continue,
    Stop,
    Start,
    /// A frame, and the end of that one after its first byte.
    StartAndStop,
}

/// The master of one TWI.
#[derive(Debug, Clone)]
pub struct Master {
    index: usize,
    /// Both pins belong to the TWI.
    pub connected: bool,
    /// MMR.
    pub mode: u32,
    /// IADR.
    pub internal_address: u32,
    /// CWGR.
    pub waveform: u32,
    enabled: bool,
    status: u32,
    received: u8,
    holding: Option<u8>,
    frame: Option<Frame>,
    next_state: NextState,
}

impl Master {
    /// State after the chip's reset.
    pub fn new(index: usize) -> Self {
        Self {
            index,
            connected: false,
            mode: 0,
            internal_address: 0,
            waveform: 0,
            enabled: false,
            status: TXCOMP,
            received: 0,
            holding: None,
            frame: None,
            next_state: NextState::Continue,
        }
    }

    /// The master's bits of SR.
    pub fn status(&self) -> u32 {
        self.status
    }

    /// NACK and ARBLST are cleared by reading SR; OVRE is while TXCOMP is set (datasheet 33.11.6).
    pub fn status_was_read(&mut self) {
        self.status &= !(NACK | ARBLST);
        if self.status & TXCOMP != 0 {
            self.status &= !OVRE;
        }
    }

    /// MSEN sets TXRDY.
    pub fn enable(&mut self) {
        self.enabled = true;
        if self.holding.is_none() {
            self.status |= TXRDY;
        }
    }

    /// MSDIS: what is under way is completed.
    pub fn disable(&mut self, context: &mut Context) {
        self.enabled = false;
        self.stop(context);
    }

    /// RHR, if it holds a byte that was not read.
    pub fn received(&self) -> Option<u8> {
        (self.status & RXRDY != 0).then_some(self.received)
    }

    /// RHR, also if it was read already; RXRDY is cleared.
    pub fn take_received(&mut self) -> u8 {
        self.status &= !RXRDY;
        self.received
    }

    /// True if THR is free, and its next byte is for a device.
    pub fn wants_byte(&self) -> bool {
        self.enabled && self.status & TXRDY != 0 && !self.reads()
    }

    fn reads(&self) -> bool {
        self.mode & MREAD != 0
    }

    /// A byte to THR begins a frame where none is under way (datasheet 33.8.4), also after a NACK.
    pub fn write(&mut self, byte: u8, context: &mut Context) {
        if !self.enabled || self.reads() {
            return;
        }
        self.holding = Some(byte);
        self.status &= !TXRDY;
        match self.frame {
            None => self.begin_frame(false, context),
            Some(Frame { step: Step::Hold, .. }) => self.next_to_device(context.now, context),
            Some(_) => {}
        }
    }

    /// START begins a frame, or another one immediately after the one under way.
    pub fn start(&mut self, context: &mut Context) {
        match self.frame {
            _ if !self.enabled => {}
            None => self.begin_frame(false, context),
            Some(frame) => {
                self.next_state = NextState::Start;
                if frame.step == Step::Hold {
                    self.next_to_device(context.now, context);
                }
            }
        }
    }

    /// STOP ends the frame after the byte under way, and after the one in THR; after a START that still waits, the frame
    /// that this begins.
    pub fn stop(&mut self, context: &mut Context) {
        if let Some(frame) = self.frame {
            self.next_state = match self.next_state {
                NextState::Start | NextState::StartAndStop => NextState::StartAndStop,
                NextState::Continue | NextState::Stop => NextState::Stop,
            };
            if frame.step == Step::Hold {
                self.next_to_device(context.now, context);
            }
        }
    }

    /// QUICK: an address, and nothing after it.
    pub fn quick(&mut self, context: &mut Context) {
        if self.enabled && self.frame.is_none() {
            self.begin_frame(true, context);
        }
    }

    fn begin_frame(&mut self, quick: bool, context: &mut Context) {
        self.status &= !TXCOMP;
        self.next_state = NextState::Continue;
        let internal = !quick && (self.mode >> 8) & 3 != 0;
        let address = (self.mode >> 16) as u8 & 0x7F;
        let step = Step::Address { address, read: self.reads() && !internal };
        self.frame = Some(Frame { step, clocking: false, at: context.now, internal, quick });
    }

    /// Time at which the next step begins or ends. While the clock is held low only the firmware can continue.
    pub fn next_event(&self) -> Option<Cycles> {
        self.frame.filter(|frame| frame.step != Step::Hold).map(|frame| frame.at)
    }

    /// Begins or ends a step that is due; false if no step is.
    pub fn step(&mut self, context: &mut Context) -> bool {
        let Some(frame) = self.frame.filter(|frame| frame.step != Step::Hold && frame.at <= context.now) else {
            return false;
        };
        let (scl_low, sda_low) =
            if self.connected { context.world.i2c(self.index).held(frame.at) } else { (false, false) };
        if scl_low {
            // Nothing moves until the clock is released; poll again some bits later.
            self.frame = Some(Frame { at: context.now + 8 * self.bit(context).max(1), ..frame });
        } else if !frame.clocking {
            let at = frame.at + self.duration(frame.step, context);
            self.frame = Some(Frame { clocking: true, at, ..frame });
        } else if sda_low && frame.step.sends_a_one() {
            self.lose_arbitration();
        } else {
            self.complete(frame, context);
        }
        true
    }

    /// T_low + T_high: (CLDIV · 2^CKDIV + 4) + (CHDIV · 2^CKDIV + 4) master clocks (datasheet 33.11.5).
    fn bit(&self, context: &Context) -> Cycles {
        let low = u64::from(self.waveform & 0xFF);
        let high = u64::from((self.waveform >> 8) & 0xFF);
        let scale = (self.waveform >> 16) & 7;
        context.master_cycles(((low + high) << scale) + 8)
    }

    fn duration(&self, step: Step, context: &Context) -> Cycles {
        let bits = match step {
            Step::Address { .. } => 10,
            Step::Stop => 1,
            _ => 9,
        };
        bits * self.bit(context)
    }

    /// Another master has won, or a device holds the line: TXCOMP comes with ARBLST (datasheet 33.11.6).
    fn lose_arbitration(&mut self) {
        self.end_frame(ARBLST);
    }

    fn end_frame(&mut self, more: u32) {
        self.frame = None;
        self.holding = None;
        self.next_state = NextState::Continue;
        self.status |= TXCOMP | TXRDY | more;
    }

    fn complete(&mut self, frame: Frame, context: &mut Context) {
        let at = frame.at;
        let wires = context.world.i2c(self.index);
        let acknowledged = self.connected
            && match frame.step {
                Step::Address { address, read } => wires.start(address, read, at),
                Step::InternalAddress { address, after } => wires.write((address >> (8 * after)) as u8, at),
                Step::Write(byte) => wires.write(byte, at),
                Step::Read | Step::Hold | Step::Stop => true,
            };
        match frame.step {
            Step::Stop => {
                if self.connected {
                    wires.stop(at);
                }
                self.end_frame(0);
            }
            Step::Read => {
                let byte = if self.connected { wires.read(at) } else { 0xFF };
                self.receive(byte);
                self.next_from_device(at, context);
            }
            _ if !acknowledged => {
                // The stop condition is sent at once, and NACK, TXCOMP and TXRDY come together (datasheet 33.11.6).
                if self.connected {
                    wires.stop(at);
                }
                self.end_frame(NACK);
            }
            Step::Address { .. } if frame.quick => self.begin_step(Step::Stop, at, context),
            Step::Address { read: false, .. } if frame.internal => {
                let after = ((self.mode >> 8) & 3).saturating_sub(1);
                self.begin_step(Step::InternalAddress { address: self.internal_address, after }, at, context);
            }
            Step::InternalAddress { address, after: after @ 1.. } => {
                self.begin_step(Step::InternalAddress { address, after: after - 1 }, at, context);
            }
            Step::InternalAddress { .. } if self.reads() => {
                let address = (self.mode >> 16) as u8 & 0x7F;
                self.begin_step(Step::Address { address, read: true }, at, context);
            }
            Step::Address { read: true, .. } => self.begin_step(Step::Read, at, context),
            _ => self.next_to_device(at, context),
        }
    }

    fn receive(&mut self, byte: u8) {
        if self.status & RXRDY != 0 {
            self.status |= OVRE;
        }
        self.received = byte;
        self.status |= RXRDY;
    }

    /// The next byte of a read, unless STOP was requested meanwhile: then this one was not acknowledged.
    fn next_from_device(&mut self, at: Cycles, context: &mut Context) {
        self.after_byte(Step::Read, at, context);
    }

    /// The next byte of a write is taken from THR, which is then ready for another.
    fn next_to_device(&mut self, at: Cycles, context: &mut Context) {
        if let Some(byte) = self.holding.take() {
            self.status |= TXRDY;
            self.begin_step(Step::Write(byte), at, context);
            return;
        }
        self.after_byte(Step::Hold, at, context);
    }

    /// Begins the requested step, or else `step`.
    fn after_byte(&mut self, step: Step, at: Cycles, context: &mut Context) {
        match self.next_state {
            NextState::Continue => self.begin_step(step, at, context),
            NextState::Stop => self.begin_step(Step::Stop, at, context),
            NextState::Start => self.begin_frame(false, context),
            NextState::StartAndStop => {
                self.begin_frame(false, context);
                self.next_state = NextState::Stop;
            }
        }
    }

    /// Begins the step when devices release the clock.
    fn begin_step(&mut self, step: Step, at: Cycles, context: &mut Context) {
        let stretch = if self.connected { context.world.i2c(self.index).stretch(at) } else { 0 };
        if let Some(frame) = &mut self.frame {
            *frame = Frame { step, clocking: false, at: at + stretch, ..*frame };
        }
    }
}

impl Step {
    /// True if the master lets SDA rise in this step, which fails if a device holds SDA low.
    fn sends_a_one(self) -> bool {
        match self {
            Self::Address { address, read } => address != 0 || read,
            Self::InternalAddress { address, after } => (address >> (8 * after)) as u8 != 0,
            Self::Write(byte) => byte != 0,
            Self::Read | Self::Hold | Self::Stop => false,
        }
    }
}
