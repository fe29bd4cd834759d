//! The touch at 1200 Bd, by which the programming port's bridge chip erases the SAM3X and resets it into its boot loader.

use std::thread::sleep;
use std::time::Duration;

use super::FlashError;

/// Speed that the bridge chip takes for the request to erase, Bd.
pub const TOUCH_BD: u32 = 1200;

/// Time after which the chip is in its boot loader.
const PAUSE: Duration = Duration::from_millis(500);

/// Opens the port at 1200 Bd with DTR off, closes it, and waits until the chip is in its boot loader.
///
/// These are the steps of arduino-cli, `TouchSerialPortAt1200bps` in `serialutils.go`, with the same pause. It does not wait
/// for a new port either: `boards.txt` of the SAM core has `upload.wait_for_upload_port=false` for the programming port, as the
/// bridge chip stays on the bus.
///
/// # Errors
/// [`FlashError::Touch`] if the port cannot be opened.
pub fn touch(port: &str) -> Result<(), FlashError> {
    let opened = serialport::new(port, TOUCH_BD).dtr_on_open(false).open();
    drop(opened.map_err(|source| FlashError::Touch { port: port.to_owned(), source })?);
    sleep(PAUSE);
    Ok(())
}
