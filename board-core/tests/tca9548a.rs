//! The TCA9548A's transactions, one by one.

use board_core::tca9548a::{ADDRESS, Channel, MuxError, Selected, Tca9548a};
use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use embedded_hal_async::i2c::I2c;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Level};
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use std::pin::pin;
use std::task::{Context, Waker};

mod imu_rig;
use imu_rig::now;

const DEVICE: u8 = 0x28;
const NACK: ErrorKind = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
const THIRD: Channel = Channel::ALL[2];

fn write(control: u8) -> Transaction {
    Transaction::write(ADDRESS, vec![control])
}

fn kept(control: u8) -> Transaction {
    Transaction::read(ADDRESS, vec![control])
}

fn device() -> Transaction {
    Transaction::read(DEVICE, vec![42])
}

fn unwired() -> Tca9548a<Pin> {
    Tca9548a::new(ADDRESS, None)
}

/// A multiplexer of which it is known that no channel is connected.
fn disconnected() -> Tca9548a<Pin> {
    let mut pin = Pin::new(&[Level::set(State::Low), Level::set(State::High)]);
    let mut mux = Tca9548a::new(ADDRESS, Some(pin.clone()));
    mux.reset().expect("the pin is a mock");
    pin.done();
    assert_eq!(mux.selected(), Selected::None);
    mux
}

/// Reads one byte of the device on `channel`, with exactly these transactions.
fn access(mux: &mut Tca9548a<Pin>, channel: Channel, transactions: &[Transaction]) -> Result<u8, MuxError<ErrorKind>> {
    let mut i2c = Mock::new(transactions);
    let answer = now(mux.with_channel(&mut i2c, channel, async |i2c| {
        let mut byte = [0];
        i2c.read(DEVICE, &mut byte).await?;
        Ok(byte[0])
    }));
    i2c.done();
    answer
}

#[test]
fn all_channels_are_deselected_before_the_first_is_used() {
    let mut mux = unwired();
    assert_eq!(access(&mut mux, THIRD, &[write(0), kept(0), write(4), kept(4), device()]), Ok(42));
    assert_eq!(mux.selected(), Selected::Channel(THIRD));
}

#[test]
fn a_connected_channel_is_not_selected_again() {
    let mut mux = disconnected();
    assert_eq!(access(&mut mux, THIRD, &[write(4), kept(4), device()]), Ok(42));
    assert_eq!(access(&mut mux, THIRD, &[device()]), Ok(42));
    assert_eq!(access(&mut mux, Channel::ALL[7], &[write(0x80), kept(0x80), device()]), Ok(42));
}

#[test]
fn an_error_of_any_transaction_forgets_the_channel() {
    let whole = [write(4), kept(4), device()];
    let errors = [MuxError::Mux(NACK), MuxError::Mux(NACK), MuxError::Device(NACK)];
    for (failed, error) in errors.into_iter().enumerate() {
        let mut mux = disconnected();
        let mut until = whole[..=failed].to_vec();
        until[failed] = until[failed].clone().with_error(NACK);
        assert_eq!(access(&mut mux, THIRD, &until), Err(error));
        assert_eq!(mux.selected(), Selected::Unknown);
        assert_eq!(access(&mut mux, THIRD, &[write(0), kept(0), write(4), kept(4), device()]), Ok(42));
    }
}

#[test]
fn a_bus_that_fails_when_a_channel_is_connected_is_laid_to_that_channel() {
    let mut mux = disconnected();
    let failed = kept(4).with_error(ErrorKind::Bus);
    assert_eq!(access(&mut mux, THIRD, &[write(4), failed]), Err(MuxError::Device(ErrorKind::Bus)));
    assert_eq!(mux.selected(), Selected::Unknown);
}

#[test]
fn a_device_is_not_asked_where_the_channel_was_not_taken() {
    let mut mux = disconnected();
    assert_eq!(access(&mut mux, THIRD, &[write(4), kept(2)]), Err(MuxError::NotTaken(2)));
    assert_eq!(mux.selected(), Selected::Unknown);
}

#[test]
fn a_device_is_not_asked_where_deselecting_fails() {
    let mut mux = unwired();
    let refused = write(0).with_error(NACK);
    assert_eq!(access(&mut mux, THIRD, &[refused]), Err(MuxError::Mux(NACK)));
    assert_eq!(access(&mut mux, THIRD, &[write(0), kept(4)]), Err(MuxError::NotTaken(4)));
}

#[test]
fn a_future_dropped_in_the_devices_transaction_forgets_the_channel() {
    let mut mux = disconnected();
    let mut i2c = Mock::new(&[write(4), kept(4)]);
    {
        let access = pin!(mux.with_channel::<_, ()>(&mut i2c, THIRD, async |_| std::future::pending().await));
        assert!(access.poll(&mut Context::from_waker(Waker::noop())).is_pending());
    }
    i2c.done();
    assert_eq!(mux.selected(), Selected::Unknown);
    assert_eq!(access(&mut mux, THIRD, &[write(0), kept(0), write(4), kept(4), device()]), Ok(42));
}

#[test]
fn without_a_reset_pin_a_reset_only_forgets() {
    let mut mux = unwired();
    assert_eq!(access(&mut mux, THIRD, &[write(0), kept(0), write(4), kept(4), device()]), Ok(42));
    mux.reset().expect("no pin, no error");
    assert_eq!(mux.selected(), Selected::Unknown);
}
