//! The driver over registers in plain memory: what the hardware would do, each test does by hand.

use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use core::task::{Context, Waker};

use critical_section::Mutex;

use super::instance::{Sealed, Shared};
use super::*;
use crate::pac;

/// Places of registers, in words.
const CR: usize = 0;
const MMR: usize = 1;
const IADR: usize = 3;
const SR: usize = 8;
const IER: usize = 9;
const IDR: usize = 10;
const RHR: usize = 12;
const THR: usize = 13;

const TXCOMP: u32 = 1 << 0;
const RXRDY: u32 = 1 << 1;
const TXRDY: u32 = 1 << 2;
const NACK: u32 = 1 << 8;

/// A TWI of a test's own.
trait Fake: Instance + Sized {
    fn words() -> &'static [AtomicU32; 0x128 / 4];
    fn set_lines(high: bool);

    fn word(offset: usize) -> u32 {
        Self::words()[offset].load(Ordering::Relaxed)
    }

    /// The status takes a value, and its interrupt is served.
    fn interrupt(status: u32) {
        Self::words()[SR].store(status, Ordering::Relaxed);
        on_interrupt::<Self>();
    }
}

macro_rules! fake_twi {
    ($name:ident) => {
        struct $name;

        impl Sealed for $name {
            const INTERRUPT: pac::Interrupt = pac::Interrupt::TWI0;
            const PORT: char = 'A';
            const SDA: u8 = 17;
            const SCL: u8 = 18;

            fn registers() -> &'static pac::twi0::RegisterBlock {
                // SAFETY: the words are as large as the block and live as long as the program.
                unsafe { &*Self::words().as_ptr().cast() }
            }

            fn shared() -> &'static Mutex<RefCell<Shared>> {
                static SHARED: Mutex<RefCell<Shared>> = Shared::new();
                &SHARED
            }

            fn lines_are_high() -> bool {
                LINES.load(Ordering::Relaxed)
            }
        }

        impl Instance for $name {
            type Sda = ();
            type Scl = ();
        }

        static LINES: AtomicBool = AtomicBool::new(true);

        impl Fake for $name {
            fn words() -> &'static [AtomicU32; 0x128 / 4] {
                static WORDS: [AtomicU32; 0x128 / 4] = [const { AtomicU32::new(0) }; 0x128 / 4];
                &WORDS
            }

            fn set_lines(high: bool) {
                LINES.store(high, Ordering::Relaxed);
            }
        }
    };
}

/// A delay that takes no time, or all time.
struct Delay {
    over: bool,
}

impl DelayNs for Delay {
    async fn delay_ns(&mut self, _: u32) {
        if !self.over {
            core::future::pending::<()>().await;
        }
    }
}

fn twi<I: Fake>(time_over: bool) -> Twi<I, Delay> {
    set_up::<I>();
    Twi { delay: Delay { over: time_over }, instance: PhantomData }
}

fn poll<F: Future>(future: core::pin::Pin<&mut F>) -> Poll<F::Output> {
    future.poll(&mut Context::from_waker(Waker::noop()))
}

#[test]
fn a_register_read_goes_through_the_internal_address() {
    fake_twi!(Bus);
    let mut i2c = twi::<Bus>(false);
    let mut bytes = [0; 2];
    {
        let mut read = pin!(i2c.write_read(0x28, &[0x20], &mut bytes));
        assert!(poll(read.as_mut()).is_pending());
        assert_eq!(Bus::word(MMR), 0x28 << 16 | MMR_MREAD | 1 << 8);
        assert_eq!((Bus::word(IADR), Bus::word(CR)), (0x20, CR_START));

        Bus::words()[RHR].store(0x11, Ordering::Relaxed);
        Bus::interrupt(RXRDY);
        assert_eq!(Bus::word(CR), CR_STOP, "the first of two bytes is the next-to-last");
        Bus::words()[RHR].store(0x22, Ordering::Relaxed);
        Bus::interrupt(RXRDY);
        assert!(poll(read.as_mut()).is_pending());
        Bus::interrupt(TXCOMP | TXRDY);
        assert_eq!(poll(read.as_mut()), Poll::Ready(Ok(())));
    }
    assert_eq!(bytes, [0x11, 0x22]);
    assert_eq!(Bus::word(IER), 0, "no interrupt stays on");
}

#[test]
fn a_read_of_one_byte_starts_and_stops_at_once() {
    fake_twi!(Bus);
    let mut i2c = twi::<Bus>(false);
    let mut bytes = [0];
    let mut read = pin!(i2c.read(0x28, &mut bytes));
    assert!(poll(read.as_mut()).is_pending());
    assert_eq!(Bus::word(CR), CR_START | CR_STOP);
}

#[test]
fn a_refused_address_ends_the_write_and_leaves_thr_alone() {
    fake_twi!(Bus);
    let mut i2c = twi::<Bus>(false);
    let mut write = pin!(i2c.write(0x70, &[0xAA, 0xBB]));
    assert!(poll(write.as_mut()).is_pending());
    Bus::interrupt(NACK | TXCOMP | TXRDY);
    assert_eq!(poll(write.as_mut()), Poll::Ready(Err(Error::NackAddress)));
    assert_eq!(Bus::word(THR), 0xAA);
}

#[test]
fn a_bus_without_interrupts_ends_with_a_timeout_and_a_fresh_peripheral() {
    fake_twi!(Bus);
    let mut i2c = twi::<Bus>(true);
    let mut write = pin!(i2c.write(0x70, &[0xAA]));
    assert_eq!(poll(write.as_mut()), Poll::Ready(Err(Error::Timeout)));
    assert_eq!((Bus::word(CR), Bus::word(IDR)), (CR_MSEN | CR_SVDIS, !0));
}

#[test]
fn a_line_held_low_is_reported_as_stuck_without_a_start() {
    fake_twi!(Bus);
    let mut i2c = twi::<Bus>(true);
    Bus::set_lines(false);
    let mut write = pin!(i2c.write(0x70, &[0xAA]));
    assert_eq!(poll(write.as_mut()), Poll::Ready(Err(Error::Stuck)));
    assert_eq!(Bus::word(THR), 0);
}

#[test]
fn a_line_that_falls_during_the_transfer_is_reported_as_stuck() {
    fake_twi!(Bus);
    struct FallingDelay;
    impl DelayNs for FallingDelay {
        async fn delay_ns(&mut self, _: u32) {
            Bus::set_lines(false);
        }
    }
    set_up::<Bus>();
    let mut i2c = Twi::<Bus, _> { delay: FallingDelay, instance: PhantomData };
    let mut write = pin!(i2c.write(0x70, &[0xAA]));
    assert_eq!(poll(write.as_mut()), Poll::Ready(Err(Error::Stuck)));
}

#[test]
fn a_future_dropped_in_the_middle_leaves_a_peripheral_that_works() {
    fake_twi!(Bus);
    let mut i2c = twi::<Bus>(false);
    let mut bytes = [0; 4];
    {
        let mut read = pin!(i2c.read(0x28, &mut bytes));
        assert!(poll(read.as_mut()).is_pending());
        Bus::interrupt(RXRDY);
    }
    assert_eq!((Bus::word(CR), Bus::word(IDR)), (CR_MSEN | CR_SVDIS, !0));

    let mut write = pin!(i2c.write(0x70, &[1]));
    assert!(poll(write.as_mut()).is_pending());
    Bus::interrupt(TXRDY);
    Bus::interrupt(TXCOMP);
    assert_eq!(poll(write.as_mut()), Poll::Ready(Ok(())));
}

#[test]
fn transactions_that_the_chip_cannot_do_are_refused() {
    fake_twi!(Bus);
    let mut i2c = twi::<Bus>(false);
    let mut bytes = [0; 2];
    let four_bytes_before_a_read = poll(pin!(i2c.write_read(0x28, &[1, 2, 3, 4], &mut bytes)));
    assert_eq!(four_bytes_before_a_read, Poll::Ready(Err(Error::Unsupported)));
    let mut two_writes = [Operation::Write(&[1]), Operation::Write(&[2])];
    assert_eq!(poll(pin!(i2c.transaction(0x28, &mut two_writes))), Poll::Ready(Err(Error::Unsupported)));
    assert_eq!(poll(pin!(i2c.write(0x28, &[0; MAX_TRANSFER + 1]))), Poll::Ready(Err(Error::TooLong)));
}

#[test]
fn an_eight_byte_register_read_has_less_than_a_millisecond() {
    assert_eq!(budget_us(2 + 1 + 8), 895);
}
