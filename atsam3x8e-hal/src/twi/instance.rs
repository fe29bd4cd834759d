//! The chip's two TWIs and their pins.

use core::cell::RefCell;
use core::task::Waker;

use critical_section::Mutex;

use super::transfer::Transfer;
use crate::gpio::{self, PeripheralA, Pin};
use crate::pac;

/// State shared by a driver and its interrupt handler.
#[derive(Debug)]
pub struct Shared {
    pub(super) transfer: Transfer,
    pub(super) waker: Option<Waker>,
}

impl Shared {
    pub(super) const fn new() -> Mutex<RefCell<Self>> {
        Mutex::new(RefCell::new(Self { transfer: Transfer::IDLE, waker: None }))
    }
}

pub trait Sealed {
    const INTERRUPT: pac::Interrupt;
    /// Port of both pins.
    const PORT: char;
    const SDA: u8;
    const SCL: u8;
    fn registers() -> &'static pac::twi0::RegisterBlock;
    fn shared() -> &'static Mutex<RefCell<Shared>>;

    /// Runs `work` on the shared state in a critical section; `None` if it is nested, which no caller does.
    fn with_shared<T>(work: impl FnOnce(&mut Shared) -> T) -> Option<T> {
        critical_section::with(|token| {
            let mut shared = Self::shared().borrow(token).try_borrow_mut().ok()?;
            Some(work(&mut shared))
        })
    }

    /// Returns whether both lines are high. PDSR shows the pads also while the TWI has them (datasheet 31.5.8).
    fn lines_are_high() -> bool {
        let lines = 1 << Self::SDA | 1 << Self::SCL;
        gpio::port(Self::PORT).pdsr.read().bits() & lines == lines
    }
}

/// TWI0 or TWI1.
pub trait Instance: Sealed {
    /// The data pin.
    type Sda;
    /// The clock pin.
    type Scl;
}

macro_rules! instance {
    ($twi:ident, $port:literal, $sda:literal, $scl:literal) => {
        impl Sealed for pac::$twi {
            const INTERRUPT: pac::Interrupt = pac::Interrupt::$twi;
            const PORT: char = $port;
            const SDA: u8 = $sda;
            const SCL: u8 = $scl;

            fn registers() -> &'static pac::twi0::RegisterBlock {
                // SAFETY: the peripheral is always there, both have this layout (datasheet chapter 33), and `Twi::new`
                // consumed it; its driver and interrupt handler exclude each other by critical sections.
                unsafe { &*pac::$twi::ptr().cast() }
            }

            fn shared() -> &'static Mutex<RefCell<Shared>> {
                static SHARED: Mutex<RefCell<Shared>> = Shared::new();
                &SHARED
            }
        }

        impl Instance for pac::$twi {
            type Sda = Pin<$port, $sda, PeripheralA>;
            type Scl = Pin<$port, $scl, PeripheralA>;
        }
    };
}

// TWD and TWCK (datasheet chapter 9, multiplexing).
instance!(TWI0, 'A', 17, 18);
instance!(TWI1, 'B', 12, 13);
