//! Pins of the four parallel I/O controllers, with their mode in their type.
//!
//! ```no_run
//! use atsam3x8e_hal::{clock, gpio::Split, pac};
//! use embedded_hal::digital::{InputPin, OutputPin, PinState};
//!
//! let device = pac::Peripherals::take().unwrap();
//! let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1)?;
//! let port_b = device.PIOB.split(clocks);
//! let mut led = port_b.pb27.into_output(PinState::Low); // the Due's LED "L"
//! let mut button = port_b.pb25.into_pull_up();
//! if button.is_low().unwrap() {
//!     led.set_high().unwrap();
//! }
//! # Ok::<(), clock::Error>(())
//! ```

use core::convert::Infallible;
use core::marker::PhantomData;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin, PinState, StatefulOutputPin};

use crate::clock::Clocks;
use crate::{pac, reg};

/// As the reset left it: an input with pull-up, or a system pin's own function (datasheet 31.5.1).
#[derive(Debug)]
pub struct Reset(());
/// An input without pull-up.
#[derive(Debug)]
pub struct Input(());
/// An input with the internal pull-up, about 100 kΩ (datasheet chapter 45, DC characteristics).
#[derive(Debug)]
pub struct PullUp(());
/// A push-pull output.
#[derive(Debug)]
pub struct Output(());
/// Driven low or released (datasheet 31.5.6).
#[derive(Debug)]
pub struct OpenDrain(());
/// Given to the pin's peripheral A (datasheet chapter 9, multiplexing).
#[derive(Debug)]
pub struct PeripheralA(());
/// Given to the pin's peripheral B (datasheet chapter 9, multiplexing).
#[derive(Debug)]
pub struct PeripheralB(());

/// Pin `N` of port `PORT` ('A' to 'D') in a mode.
#[derive(Debug)]
pub struct Pin<const PORT: char, const N: u8, MODE>(PhantomData<MODE>);

/// The registers of a port. All four have the layout of PIOA (datasheet chapter 31).
pub(crate) fn port(port: char) -> &'static pac::pioa::RegisterBlock {
    let address = match port {
        'A' => pac::PIOA::ptr(),
        'B' => pac::PIOB::ptr().cast(),
        'C' => pac::PIOC::ptr().cast(),
        _ => pac::PIOD::ptr().cast(),
    };
    // SAFETY: the controllers are always there and have this layout. Only this crate's owners of pins reach this, and
    // they write set and clear registers with their own pins' bits (ABSR, see `select_peripheral`, excepted).
    unsafe { &*address }
}

/// Makes pins outputs of the controller: first the level, then the driver, then the multiplexer, so that the line shows
/// nothing in between.
pub(crate) fn drive(block: &pac::pioa::RegisterBlock, mask: u32, state: PinState) {
    match state {
        PinState::Low => reg::set(&block.codr, mask),
        PinState::High => reg::set(&block.sodr, mask),
    }
    reg::set(&block.oer, mask);
    reg::set(&block.per, mask);
}

/// Gives pins to a peripheral (datasheet 31.5.2). ABSR has no set and clear registers: read, modify, write in a critical
/// section.
pub(crate) fn select_peripheral(block: &pac::pioa::RegisterBlock, mask: u32, b: bool) {
    critical_section::with(|_| {
        let others = block.absr.read().bits() & !mask;
        reg::set(&block.absr, if b { others | mask } else { others });
    });
    reg::set(&block.pdr, mask);
}

impl<const PORT: char, const N: u8, MODE> Pin<PORT, N, MODE> {
    const MASK: u32 = 1 << N;

    fn block() -> &'static pac::pioa::RegisterBlock {
        port(PORT)
    }

    /// An input without pull-up.
    pub fn into_input(self) -> Pin<PORT, N, Input> {
        reg::set(&Self::block().pudr, Self::MASK);
        reg::set(&Self::block().odr, Self::MASK);
        reg::set(&Self::block().per, Self::MASK);
        Pin(PhantomData)
    }

    /// An input with the internal pull-up.
    pub fn into_pull_up(self) -> Pin<PORT, N, PullUp> {
        reg::set(&Self::block().puer, Self::MASK);
        reg::set(&Self::block().odr, Self::MASK);
        reg::set(&Self::block().per, Self::MASK);
        Pin(PhantomData)
    }

    /// A push-pull output that starts at `state`.
    pub fn into_output(self, state: PinState) -> Pin<PORT, N, Output> {
        reg::set(&Self::block().mddr, Self::MASK);
        drive(Self::block(), Self::MASK, state);
        Pin(PhantomData)
    }

    /// An open-drain output that starts driven low or released.
    pub fn into_open_drain(self, state: PinState) -> Pin<PORT, N, OpenDrain> {
        reg::set(&Self::block().mder, Self::MASK);
        drive(Self::block(), Self::MASK, state);
        Pin(PhantomData)
    }

    /// Gives the pin to its peripheral A, without pull-up.
    pub fn into_peripheral_a(self) -> Pin<PORT, N, PeripheralA> {
        reg::set(&Self::block().pudr, Self::MASK);
        select_peripheral(Self::block(), Self::MASK, false);
        Pin(PhantomData)
    }

    /// Gives the pin to its peripheral B, without pull-up.
    pub fn into_peripheral_b(self) -> Pin<PORT, N, PeripheralB> {
        reg::set(&Self::block().pudr, Self::MASK);
        select_peripheral(Self::block(), Self::MASK, true);
        Pin(PhantomData)
    }

    fn level() -> bool {
        Self::block().pdsr.read().bits() & Self::MASK != 0
    }
}

/// Modes whose level can be read by [`InputPin`]; PDSR is the pad's level in every mode (datasheet 31.5.8).
trait Readable {}
impl Readable for Input {}
impl Readable for PullUp {}
impl Readable for Output {}
impl Readable for OpenDrain {}

/// Modes that [`OutputPin`] drives.
trait Drivable {}
impl Drivable for Output {}
impl Drivable for OpenDrain {}

impl<const PORT: char, const N: u8, MODE> ErrorType for Pin<PORT, N, MODE> {
    type Error = Infallible;
}

impl<const PORT: char, const N: u8, MODE: Readable> InputPin for Pin<PORT, N, MODE> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(Self::level())
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!Self::level())
    }
}

impl<const PORT: char, const N: u8, MODE: Drivable> OutputPin for Pin<PORT, N, MODE> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        reg::set(&Self::block().codr, Self::MASK);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        reg::set(&Self::block().sodr, Self::MASK);
        Ok(())
    }
}

impl<const PORT: char, const N: u8, MODE: Drivable> StatefulOutputPin for Pin<PORT, N, MODE> {
    fn is_set_high(&mut self) -> Result<bool, Infallible> {
        Ok(Self::block().odsr.read().bits() & Self::MASK != 0)
    }

    fn is_set_low(&mut self) -> Result<bool, Infallible> {
        self.is_set_high().map(|high| !high)
    }
}

/// Takes a port apart into its pins and switches its clock on, which its inputs need (datasheet 31.4.2).
pub trait Split {
    /// The pins, by name.
    type Port;
    /// The port's pins as the reset left them.
    fn split(self, clocks: Clocks) -> Self::Port;
}

macro_rules! ports {
    ($($peripheral:ident $port_type:ident $letter:literal: $($name:ident $n:literal),+;)+) => { $(
        #[doc = concat!("The pins of port ", $letter, ".")]
        #[derive(Debug)]
        pub struct $port_type {
            $(#[doc = concat!("Pin ", $letter, stringify!($n), ".")] pub $name: Pin<$letter, $n, Reset>,)+
        }

        impl Split for pac::$peripheral {
            type Port = $port_type;

            fn split(self, clocks: Clocks) -> $port_type {
                clocks.enable(pac::Interrupt::$peripheral);
                $port_type { $($name: Pin(PhantomData),)+ }
            }
        }
    )+ };
}

// The pins of the 144-pin package (datasheet chapter 9, multiplexing).
ports! {
    PIOA PortA 'A': pa0 0, pa1 1, pa2 2, pa3 3, pa4 4, pa5 5, pa6 6, pa7 7, pa8 8, pa9 9, pa10 10, pa11 11, pa12 12, pa13 13,
        pa14 14, pa15 15, pa16 16, pa17 17, pa18 18, pa19 19, pa20 20, pa21 21, pa22 22, pa23 23, pa24 24, pa25 25, pa26 26,
        pa27 27, pa28 28, pa29 29;
    PIOB PortB 'B': pb0 0, pb1 1, pb2 2, pb3 3, pb4 4, pb5 5, pb6 6, pb7 7, pb8 8, pb9 9, pb10 10, pb11 11, pb12 12, pb13 13,
        pb14 14, pb15 15, pb16 16, pb17 17, pb18 18, pb19 19, pb20 20, pb21 21, pb22 22, pb23 23, pb24 24, pb25 25, pb26 26,
        pb27 27, pb28 28, pb29 29, pb30 30, pb31 31;
    PIOC PortC 'C': pc0 0, pc1 1, pc2 2, pc3 3, pc4 4, pc5 5, pc6 6, pc7 7, pc8 8, pc9 9, pc10 10, pc11 11, pc12 12, pc13 13,
        pc14 14, pc15 15, pc16 16, pc17 17, pc18 18, pc19 19, pc20 20, pc21 21, pc22 22, pc23 23, pc24 24, pc25 25, pc26 26,
        pc27 27, pc28 28, pc29 29, pc30 30;
    PIOD PortD 'D': pd0 0, pd1 1, pd2 2, pd3 3, pd4 4, pd5 5, pd6 6, pd7 7, pd8 8, pd9 9, pd10 10;
}
