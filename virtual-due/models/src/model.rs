//! The interface of a peripheral's model, and of the rest of the board to the models. It does not depend on the CPU engine.

use crate::warning_log::WarningLog;

/// An instant, or a span of time: cycles of 84 MHz since power-on, at any master clock.
pub type Cycles = u64;

/// Cycles in a second.
pub const CYCLES_PER_SECOND: Cycles = 84_000_000;

/// Model of a peripheral, for the bus, the interrupt controller and the scheduler of events.
///
/// Registers are 32 bits wide; the bus turns narrower accesses into these. Before every access the model is brought up
/// to the access's time by [`advance`](Self::advance).
pub trait Peripheral {
    /// Reads the register at `offset`, and clears the bits that reading clears.
    fn read(&mut self, offset: u32, context: &mut Context) -> u32;

    /// Writes the register at `offset`.
    fn write(&mut self, offset: u32, value: u32, context: &mut Context);

    /// Advances the model to `context.now`.
    fn advance(&mut self, context: &mut Context) {
        let _ = context;
    }

    /// The next instant at which the model has to be advanced, if any.
    fn next_event(&self) -> Option<Cycles> {
        None
    }

    /// True if the interrupt line is raised: status and mask.
    fn interrupt(&self) -> bool {
        false
    }

    /// The interrupt lines of a model that has several, bit 0 the first; one that has one gives
    /// [`interrupt`](Self::interrupt).
    fn interrupts(&self) -> u32 {
        u32::from(self.interrupt())
    }

    /// The level at which it drives a pin that is given to it as this side of the pin's multiplexer; `None`: it does not
    /// drive the pin.
    fn output(&self, pin: Pin, side: Side, now: Cycles) -> Option<bool> {
        let _ = (pin, side, now);
        None
    }

    /// An instant no later than the next change of such an output, and later than `now`; `None`: it does not change.
    fn next_output_edge(&self, pin: Pin, side: Side, now: Cycles) -> Option<Cycles> {
        let _ = (pin, side, now);
        None
    }

    /// Receives a signal from elsewhere in the chip.
    fn signal(&mut self, signal: Signal, context: &mut Context) {
        let _ = (signal, context);
    }

    /// Sets the state after the chip's reset.
    fn reset(&mut self);
}

/// The rest of the board, lent to a model while it is called.
pub struct Context<'a> {
    /// Time now.
    pub now: Cycles,
    /// The master clock, Hz.
    pub master_clock_hz: u32,
    /// The chip's memory, for the PDC.
    pub memory: &'a mut dyn Memory,
    /// The devices on the chip's pins.
    pub world: &'a mut dyn World,
    /// Receives warnings, such as accesses to unmodelled registers.
    pub warnings: &'a mut WarningLog,
    /// Signals to the rest of the chip, dispatched as soon as the call returns.
    pub signals: &'a mut Vec<Signal>,
}

/// A signal from a model to the rest of the chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// A timer channel's TIOA rose: 0…8 for TC0…TC8.
    Tioa(u8),
    /// An event line of the PWM, 0 or 1.
    PwmEvent(u8),
    /// The master clock now has this frequency, Hz.
    MasterClock(u32),
    /// The peripherals whose clock now runs, a bit for each identifier.
    PeripheralClocks(u64),
    /// Flash changed at an address, for a number of bytes.
    Flash(u32, u32),
    /// GPNVM bit 1: the next reset boots from flash, or from ROM.
    BootFlash(bool),
    /// The lines of PIO controller 0…3 that belong to peripheral A, and B, a bit each.
    Pins {
        /// 0 for PIOA … 3 for PIOD.
        port: u8,
        /// Lines of peripheral A.
        a: u32,
        /// Lines of peripheral B.
        b: u32,
    },
    /// Levels of the lines of a PIO controller that peripherals drive, to that controller.
    Outputs {
        /// Lines that a peripheral drives.
        driven: u32,
        /// Their levels.
        levels: u32,
    },
    /// Pins that are wired to outputs have other levels now.
    WiresMoved,
    /// The slow clock's crystal was selected, and is the slow clock from this instant on.
    SlowCrystal(Cycles),
    /// The chip is reset.
    Reset(Cause),
}

/// A side of the multiplexer of a pin that belongs to a peripheral (datasheet 31.5.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Peripheral A.
    A,
    /// Peripheral B.
    B,
}

/// Cause of a reset, with the values of RSTC_SR.RSTTYP (datasheet 12.5.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Power came up.
    General = 0,
    /// Out of backup mode.
    Backup = 1,
    /// The watchdog was not restarted in time.
    Watchdog = 2,
    /// A request of the firmware.
    Software = 3,
    /// NRST was held low: the reset button, or the USB bridge when a host opens the port.
    User = 4,
}

impl Context<'_> {
    /// Duration of `count` periods of the master clock at its present frequency.
    pub fn master_cycles(&self, count: u64) -> Cycles {
        (u128::from(count) * u128::from(CYCLES_PER_SECOND) / u128::from(self.master_clock_hz)) as Cycles
    }
}

/// RAM and flash as a peripheral's DMA sees them.
pub trait Memory {
    /// Reads `bytes.len()` bytes at `address`; false where there is no memory.
    fn read(&self, address: u32, bytes: &mut [u8]) -> bool;

    /// Writes bytes at `address`; false where there is no RAM.
    fn write(&mut self, address: u32, bytes: &[u8]) -> bool;
}

/// A pin of the chip: PIO controller A…D as 0…3, and line 0…31.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pin {
    /// 0 for PIOA … 3 for PIOD.
    pub port: u8,
    /// 0…31.
    pub line: u8,
}

/// The devices that are wired to the chip's pins.
pub trait World {
    /// Result of converting an ADC channel, 0…15, now: counts 0…4095.
    fn adc_counts(&mut self, channel: u8, now: Cycles) -> u16;

    /// The channel number that a conversion of `channel` is tagged with; another than its own is a fault of the converter.
    fn adc_tag(&mut self, channel: u8) -> u8 {
        channel
    }

    /// True if the converter ignores its triggers, which is a fault.
    fn adc_is_stopped(&mut self) -> bool {
        false
    }

    /// The devices on the wires of TWI0 or TWI1.
    fn i2c(&mut self, twi: usize) -> &mut dyn I2c;

    /// A PWM channel, 0…7, now is high for the first number of the second number of clocks; `None`: it is not running.
    fn pwm(&mut self, channel: u8, duty: Option<(u32, u32)>, now: Cycles);

    /// The chip now drives the pin to a level; `None`: it is an input or belongs to a peripheral.
    fn drive(&mut self, pin: Pin, level: Option<bool>, now: Cycles);

    /// The level at which the outside drives a pin; `None`: nothing drives it.
    fn level(&mut self, pin: Pin, now: Cycles) -> Option<bool>;

    /// A byte that left the chip on a serial port: 0 for UART, 1…4 for USART0…3.
    fn transmitted(&mut self, port: usize, byte: u8, now: Cycles);

    /// Takes the next byte on its way to a serial port if it is complete by `now`, at the port's baud rate; else returns
    /// when it will be. A byte arrives at most once in `byte_time`.
    fn receive(&mut self, port: usize, byte_time: Cycles, now: Cycles) -> Reception;
}

/// Result of [`World::receive`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reception {
    /// Nothing is on its way.
    Idle,
    /// The next byte is complete at this time.
    At(Cycles),
    /// A byte has arrived.
    Byte(u8),
}

/// The devices on an I²C bus, byte by byte as a master sees them.
pub trait I2c {
    /// A start or repeated start with an address, 7 bits; whether a device acknowledged.
    fn start(&mut self, address: u8, read: bool, now: Cycles) -> bool;

    /// A byte to the addressed device; whether it acknowledged.
    fn write(&mut self, byte: u8, now: Cycles) -> bool;

    /// A byte from the addressed device.
    fn read(&mut self, now: Cycles) -> u8;

    /// A stop condition.
    fn stop(&mut self, now: Cycles);

    /// Time for which devices hold the clock low before the next byte.
    fn stretch(&mut self, now: Cycles) -> Cycles;

    /// True for SCL, and for SDA, if a device holds it low.
    fn held(&mut self, now: Cycles) -> (bool, bool);

    /// A clock pulse that the firmware generated with SCL as a GPIO.
    fn pulse(&mut self, now: Cycles);
}
