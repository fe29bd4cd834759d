//! Six simulated BNO055s behind a simulated TCA9548A, whose every fault is a field, and the few lines that run a future.

#![allow(dead_code, reason = "each test program uses its own part")]

use board_core::imus::{BusRecovery, BusStuck, ImuReadings, Imus};
use board_core::tca9548a::{self, Tca9548a};
use board_table::{ImuAddress, Wiring};
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource, Operation};
use embedded_hal_async::i2c::{ErrorType, I2c};
use std::cell::RefCell;
use std::convert::Infallible;
use std::pin::pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};
use telemetry::SensorState;

/// Ticks from reset to CONFIGMODE: 650 ms.
pub const POWER_ON_TICKS: u32 = 65;

/// Runs a future that never has to wait.
pub fn now<F: Future>(future: F) -> F::Output {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(output) => output,
        Poll::Pending => panic!("the future waits"),
    }
}

/// A quaternion about the vertical, of a heading in degrees.
pub fn heading(degrees: f64) -> [i16; 4] {
    let half = degrees.to_radians() / 2.0;
    [half.cos(), 0.0, 0.0, half.sin()].map(|component| (component * 16384.0).round() as i16)
}

/// One BNO055.
#[derive(Debug, Clone)]
pub struct Chip {
    pub place: ImuAddress,
    pub is_plugged: bool,
    pub mode: u8,
    pub page: u8,
    pub units: u8,
    pub answers_from: u32,
    pub quaternion: [i16; 4],
    /// Value of QUA_DATA in place of the measured one.
    pub forced: Option<[i16; 4]>,
    /// Its transactions never end.
    pub stretches: bool,
}

impl Chip {
    fn reset(&mut self, tick: u32) {
        (self.mode, self.page, self.units) = (0, 0, 0x80);
        self.answers_from = tick + POWER_ON_TICKS;
    }

    fn read(&self, register: u8) -> u8 {
        let quaternion = self.forced.unwrap_or(if self.mode == 8 { self.quaternion } else { [0; 4] });
        match register {
            0x00 if self.page == 0 => 0xA0,
            0x07 => self.page,
            0x20..0x28 => {
                let offset = usize::from(register - 0x20);
                quaternion[offset / 2].to_le_bytes()[offset % 2]
            }
            0x39 => [0, 5][usize::from(self.mode == 8)],
            0x3B => self.units,
            0x3D => 0x10 | self.mode,
            _ => 0,
        }
    }

    fn write(&mut self, register: u8, value: u8, tick: u32) {
        match register {
            0x07 => self.page = value,
            0x3B if self.mode == 0 => self.units = value,
            0x3D => self.mode = value & 0x0F,
            0x3F if value & 0x20 != 0 => self.reset(tick),
            _ => panic!("{value:#04x} written to {register:#04x}"),
        }
    }
}

/// Device that holds SDA low.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holder {
    /// The IMU on this channel, while that is connected; clocks free it.
    Clockable(usize),
    /// The IMU on this channel, while that is connected; nothing frees it.
    Broken(usize),
    /// A short of the bus itself.
    Short,
}

/// The bus with all that is on it.
#[derive(Debug)]
pub struct SimulatedBus {
    pub tick: u32,
    pub connected: u8,
    pub chips: Vec<Chip>,
    pub holder: Option<Holder>,
    /// The multiplexer acknowledges, and stays as it is.
    pub mux_ignores: bool,
    /// The multiplexer does not acknowledge.
    pub mux_is_gone: bool,
    /// The multiplexer connects the channel that is so many further on, and confirms the one that is selected.
    pub mux_lies_by: u8,
    /// The transaction of this number in the tick never ends.
    pub hangs_at: Option<usize>,
    /// Transactions of this tick: address, and how many bits were on the wire.
    pub log: Vec<(u8, u32)>,
    pub recoveries: u32,
}

impl SimulatedBus {
    fn is_held(&self) -> bool {
        match self.holder {
            Some(Holder::Clockable(channel) | Holder::Broken(channel)) => self.connected & (1 << channel) != 0,
            Some(Holder::Short) => true,
            None => false,
        }
    }

    /// Result of the transaction; `None`: it never ends.
    fn transact(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Option<Result<(), ErrorKind>> {
        let bytes = operations.iter().map(|operation| match operation {
            Operation::Read(bytes) => 1 + bytes.len(),
            Operation::Write(bytes) => 1 + bytes.len(),
        });
        let bits = 9 * bytes.sum::<usize>() as u32 + 1 + operations.len() as u32;
        if self.hangs_at == Some(self.log.len()) {
            self.log.push((address, bits));
            return None;
        }
        self.log.push((address, bits));
        if self.is_held() {
            return Some(Err(ErrorKind::Bus));
        }
        if address == tca9548a::ADDRESS {
            Some(self.speak_to_mux(operations))
        } else {
            self.speak_to_chip(address, operations)
        }
    }

    fn speak_to_mux(&mut self, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        if self.mux_is_gone {
            return self.refuse();
        }
        match operations {
            [Operation::Write([control])] if !self.mux_ignores => self.connected = *control,
            [Operation::Write([_])] => {}
            [Operation::Read([control])] => *control = self.connected,
            _ => panic!("no transaction of a TCA9548A"),
        }
        Ok(())
    }

    fn speak_to_chip(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Option<Result<(), ErrorKind>> {
        assert!(self.connected.count_ones() <= 1, "several IMUs are connected: {:#010b}", self.connected);
        let (tick, connected) = (self.tick, self.connected);
        let place = ImuAddress { channel: connected.trailing_zeros() as u8 + self.mux_lies_by, address };
        let chip = self.chips.iter_mut().find(|chip| chip.place == place);
        let Some(chip) = chip.filter(|chip| chip.is_plugged && chip.answers_from <= tick) else {
            return Some(self.refuse());
        };
        if chip.stretches {
            return None;
        }
        match operations {
            [Operation::Write([register, value])] => chip.write(*register, *value, tick),
            [Operation::Write([register]), Operation::Read(bytes)] => {
                (*register..).zip(bytes.iter_mut()).for_each(|(register, byte)| *byte = chip.read(register));
            }
            _ => panic!("no transaction of a BNO055"),
        }
        Some(Ok(()))
    }

    /// A transaction that ends at its address.
    fn refuse(&mut self) -> Result<(), ErrorKind> {
        self.log.last_mut().expect("it was just logged").1 = 11;
        Err(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address))
    }
}

/// The board's end of the bus.
#[derive(Debug)]
pub struct Controller(Rc<RefCell<SimulatedBus>>);

impl ErrorType for Controller {
    type Error = ErrorKind;
}

impl I2c for Controller {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        let outcome = self.0.borrow_mut().transact(address, operations);
        match outcome {
            Some(outcome) => outcome,
            None => std::future::pending().await,
        }
    }
}

impl BusRecovery for Controller {
    async fn recover(&mut self) -> Result<(), BusStuck> {
        let mut bus = self.0.borrow_mut();
        bus.recoveries += 1;
        if matches!(bus.holder, Some(Holder::Clockable(channel)) if bus.connected & (1 << channel) != 0) {
            bus.holder = None;
        }
        if bus.is_held() { Err(BusStuck) } else { Ok(()) }
    }
}

/// The multiplexer's RESET.
#[derive(Debug)]
pub struct ResetPin(Rc<RefCell<SimulatedBus>>);

impl digital::ErrorType for ResetPin {
    type Error = Infallible;
}

impl OutputPin for ResetPin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().connected = 0;
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// The IMUs as the firmware reads them, and the bus as it is.
pub struct ImuRig {
    pub imus: Imus<Controller, ResetPin>,
    bus: Rc<RefCell<SimulatedBus>>,
    /// Transactions of the last tick: address, and how many bits were on the wire.
    pub log: Vec<(u8, u32)>,
}

impl ImuRig {
    /// Six IMUs that have just come out of their reset, at headings 10°, 20° … 60°.
    pub fn powered_up() -> Self {
        Self::wired(&Wiring::reference(6))
    }

    /// The IMUs of a wiring that have just come out of their reset, at headings 10°, 20°, …
    pub fn wired(wiring: &Wiring) -> Self {
        let places = wiring.segments.iter().enumerate().filter_map(|(k, segment)| Some((k, segment.imu?)));
        let chip = |(k, place): (usize, ImuAddress)| Chip {
            place,
            is_plugged: true,
            mode: 0,
            page: 0,
            units: 0x80,
            answers_from: 0,
            quaternion: heading(10.0 * (k + 1) as f64),
            forced: None,
            stretches: false,
        };
        let chips = places.map(chip).collect();
        let bus = SimulatedBus {
            tick: 0,
            connected: 0,
            chips,
            holder: None,
            mux_ignores: false,
            mux_is_gone: false,
            mux_lies_by: 0,
            hangs_at: None,
            log: Vec::new(),
            recoveries: 0,
        };
        let bus = Rc::new(RefCell::new(bus));
        let mux = Tca9548a::new(tca9548a::ADDRESS, Some(ResetPin(bus.clone())));
        Self { imus: Imus::new(Controller(bus.clone()), mux, wiring), bus, log: Vec::new() }
    }

    /// IMUs that have been read for a while.
    pub fn running() -> Self {
        let mut rig = Self::powered_up();
        rig.ticks(10);
        assert!(rig.tick().imu.iter().all(Option::is_some));
        rig
    }

    pub fn bus(&self) -> std::cell::RefMut<'_, SimulatedBus> {
        self.bus.borrow_mut()
    }

    /// One tick. A transaction that does not end is cut off.
    pub fn tick(&mut self) -> ImuReadings {
        let tick = self.bus().tick;
        {
            let reading = pin!(self.imus.read(tick));
            let _ = reading.poll(&mut Context::from_waker(Waker::noop()));
        }
        let readings = self.imus.validate();
        let mut bus = self.bus.borrow_mut();
        bus.tick += 1;
        self.log = std::mem::take(&mut bus.log);
        readings
    }

    pub fn ticks(&mut self, count: u32) {
        for _ in 0..count {
            self.tick();
        }
    }

    /// Time of the last tick's transactions at 400 kHz, µs.
    pub fn wire_us(&self) -> f64 {
        self.log.iter().map(|(_, bits)| f64::from(*bits) * 2.5).sum()
    }
}

/// Reading of IMU k (from 0) in a tick: no two are equal.
pub fn measured(k: usize, tick: u32) -> [i16; 4] {
    heading(10.0 * (k + 1) as f64 + 0.02 * f64::from(tick % 200))
}

/// One tick in which every IMU moves.
pub fn moving_tick(rig: &mut ImuRig) -> ImuReadings {
    let tick = rig.bus().tick;
    for (k, chip) in rig.bus().chips.iter_mut().enumerate() {
        chip.quaternion = measured(k, tick);
    }
    rig.tick()
}

pub fn state(rig: &ImuRig, k: usize) -> SensorState {
    rig.imus.health()[k].state
}

/// Ticks until IMU k is in a state, at most `limit`.
pub fn ticks_until(rig: &mut ImuRig, k: usize, wanted: SensorState, limit: u32) -> u32 {
    (1..=limit)
        .find(|_| {
            moving_tick(rig);
            state(rig, k) == wanted
        })
        .unwrap_or_else(|| panic!("IMU {k} is not {wanted:?} within {limit} ticks"))
}
