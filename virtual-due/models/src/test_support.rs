//! Test doubles for the models: memory, flash, and a world that records the calls that it receives.

use crate::flash::FlashBank;
use crate::model::{CYCLES_PER_SECOND, Context, Cycles, I2c, Memory, Peripheral, Pin, Reception, Signal, World};
use crate::warning_log::WarningLog;
use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};

/// 1 KiB of RAM.
pub struct Ram {
    pub base: u32,
    pub bytes: [u8; 1024],
}

impl Ram {
    pub fn new() -> Self {
        Self { base: 0x2007_0000, bytes: [0; 1024] }
    }

    /// Range of `bytes` that an access covers.
    fn range(&self, address: u32, length: usize) -> Option<std::ops::Range<usize>> {
        let start = address.checked_sub(self.base)? as usize;
        let end = start.checked_add(length)?;
        (end <= self.bytes.len()).then_some(start..end)
    }
}

impl Memory for Ram {
    fn read(&self, address: u32, bytes: &mut [u8]) -> bool {
        let Some(range) = self.range(address, bytes.len()) else { return false };
        bytes.copy_from_slice(&self.bytes[range]);
        true
    }

    fn write(&mut self, address: u32, bytes: &[u8]) -> bool {
        let Some(range) = self.range(address, bytes.len()) else { return false };
        self.bytes[range].copy_from_slice(bytes);
        true
    }
}

/// A bank of flash.
pub struct FlashBytes(RefCell<Vec<u8>>);

impl FlashBytes {
    pub fn erased(length: usize) -> Self {
        Self(RefCell::new(vec![0xFF; length]))
    }
}

impl FlashBank for FlashBytes {
    fn read(&self, offset: usize, to: &mut [u8]) -> bool {
        to.copy_from_slice(&self.0.borrow()[offset..][..to.len()]);
        true
    }

    fn write(&self, offset: usize, from: &[u8]) -> bool {
        self.0.borrow_mut()[offset..][..from.len()].copy_from_slice(from);
        true
    }

    fn fill(&self, byte: u8) {
        self.0.borrow_mut().fill(byte);
    }
}

/// A PWM channel, its duty, and the time of the report.
pub type Duty = (u8, Option<(u32, u32)>, Cycles);

/// A world with one I²C device, whose bytes and acknowledgements the test sets.
#[derive(Default)]
pub struct Pins {
    /// Added to 100 times the channel, which identifies the channel of a result.
    pub counts: u16,
    pub conversions: Vec<(u8, Cycles)>,
    pub device: Device,
    pub duties: Vec<Duty>,
    pub sent: Vec<(usize, u8, Cycles)>,
    /// Bytes on their way to any port, each with the time at which it is complete.
    pub arriving: VecDeque<(Cycles, u8)>,
    /// Levels at which the chip drove its pins.
    pub driven: Vec<(Pin, Option<bool>, Cycles)>,
    /// Levels at which the outside drives pins.
    pub levels: BTreeMap<Pin, bool>,
}

impl World for Pins {
    fn adc_counts(&mut self, channel: u8, now: Cycles) -> u16 {
        self.conversions.push((channel, now));
        self.counts + 100 * u16::from(channel)
    }

    fn i2c(&mut self, _twi: usize) -> &mut dyn I2c {
        &mut self.device
    }

    fn pwm(&mut self, channel: u8, duty: Option<(u32, u32)>, now: Cycles) {
        self.duties.push((channel, duty, now));
    }

    fn drive(&mut self, pin: Pin, level: Option<bool>, now: Cycles) {
        self.driven.push((pin, level, now));
    }

    fn level(&mut self, pin: Pin, _now: Cycles) -> Option<bool> {
        self.levels.get(&pin).copied()
    }

    fn transmitted(&mut self, port: usize, byte: u8, now: Cycles) {
        self.sent.push((port, byte, now));
    }

    fn receive(&mut self, _port: usize, _byte_time: Cycles, now: Cycles) -> Reception {
        match self.arriving.front().copied() {
            None => Reception::Idle,
            Some((at, _)) if at > now => Reception::At(at),
            Some((_, byte)) => {
                self.arriving.pop_front();
                Reception::Byte(byte)
            }
        }
    }
}

/// An event on the I²C wires.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnBus {
    Start(u8, bool),
    Write(u8),
    Read,
    Stop,
}

/// An I²C device at 0x28 that acknowledges, unless the test sets it not to.
#[derive(Default)]
pub struct Device {
    pub seen: Vec<OnBus>,
    pub refuses_data: bool,
    pub to_read: VecDeque<u8>,
    pub stretch: Cycles,
    pub scl_low: bool,
    pub sda_low: bool,
}

impl I2c for Device {
    fn start(&mut self, address: u8, read: bool, _now: Cycles) -> bool {
        self.seen.push(OnBus::Start(address, read));
        address == 0x28
    }

    fn write(&mut self, byte: u8, _now: Cycles) -> bool {
        self.seen.push(OnBus::Write(byte));
        !self.refuses_data
    }

    fn read(&mut self, _now: Cycles) -> u8 {
        self.seen.push(OnBus::Read);
        self.to_read.pop_front().unwrap_or(0xFF)
    }

    fn stop(&mut self, _now: Cycles) {
        self.seen.push(OnBus::Stop);
    }

    fn stretch(&mut self, _now: Cycles) -> Cycles {
        self.stretch
    }

    fn held(&mut self, _now: Cycles) -> (bool, bool) {
        (self.scl_low, self.sda_low)
    }

    fn pulse(&mut self, _now: Cycles) {}
}

/// A model with its context, and time.
pub struct Bench<P> {
    pub model: P,
    pub now: Cycles,
    pub master_clock_hz: u32,
    pub memory: Ram,
    pub world: Pins,
    pub warnings: WarningLog,
    /// Signals of the model to the chip, with their times.
    pub signals: Vec<(Cycles, Signal)>,
}

impl<P: Peripheral> Bench<P> {
    /// The model as its constructor leaves it, at time 0, at a master clock of 84 MHz.
    pub fn new(model: P) -> Self {
        Self {
            model,
            now: 0,
            master_clock_hz: CYCLES_PER_SECOND as u32,
            memory: Ram::new(),
            world: Pins::default(),
            warnings: WarningLog::default(),
            signals: Vec::new(),
        }
    }

    /// Calls the model as the chip does.
    pub fn with<R>(&mut self, call: impl FnOnce(&mut P, &mut Context) -> R) -> R {
        let mut signals = Vec::new();
        let mut context = Context {
            now: self.now,
            master_clock_hz: self.master_clock_hz,
            memory: &mut self.memory,
            world: &mut self.world,
            warnings: &mut self.warnings,
            signals: &mut signals,
        };
        let result = call(&mut self.model, &mut context);
        self.signals.extend(signals.into_iter().map(|signal| (self.now, signal)));
        result
    }

    pub fn read(&mut self, offset: u32) -> u32 {
        self.with(|model, context| {
            model.advance(context);
            model.read(offset, context)
        })
    }

    pub fn write(&mut self, offset: u32, value: u32) {
        self.with(|model, context| {
            model.advance(context);
            model.write(offset, value, context);
        });
    }

    pub fn signal(&mut self, signal: Signal) {
        self.with(|model, context| {
            model.advance(context);
            model.signal(signal, context);
        });
    }

    /// Texts of the warnings since the last call.
    pub fn reports(&mut self) -> Vec<String> {
        self.warnings.take().into_iter().map(|warning| warning.text).collect()
    }

    /// Signals of the model, without their times.
    pub fn signalled(&self) -> Vec<Signal> {
        self.signals.iter().map(|(_, signal)| *signal).collect()
    }

    /// Lets time pass, stopping at each event on the way as the board does.
    pub fn run(&mut self, cycles: Cycles) {
        let end = self.now + cycles;
        self.with(Peripheral::advance);
        while let Some(event) = self.model.next_event().filter(|event| *event <= end) {
            self.now = self.now.max(event);
            self.with(Peripheral::advance);
            assert!(
                self.model.next_event().is_none_or(|next| next > self.now),
                "an event at {event} is still due after it was served"
            );
        }
        self.now = end;
        self.with(Peripheral::advance);
    }

    /// Runs until `done` returns true; returns the time it took.
    pub fn run_until(&mut self, limit: Cycles, mut done: impl FnMut(&mut Self) -> bool) -> Cycles {
        let start = self.now;
        while !done(self) {
            assert!(self.now < start + limit, "not done within {limit} cycles");
            self.run(1);
        }
        self.now - start
    }
}
