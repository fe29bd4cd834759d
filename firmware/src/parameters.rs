//! Parameters of the board; those of the arm are in its table.

use core::ops::Range;

use board_table::STORE_BYTES;
use telemetry::TICK_US;

/// Ticks a second: the rate of the ADC's trigger and of all tasks.
pub const TICK_HZ: u32 = (1_000_000 / TICK_US) as u32;

/// From the ADC's trigger to the tick's interrupt, µs: a scan of twelve channels takes 50 µs.
pub const SCAN_US: u32 = 200;

/// Deadline of the IMUs' poll after a tick's trigger, µs. An IMU that has not answered by then counts as not read.
pub const IMUS_US: u64 = 6_000;

/// ADC channels of the analog pins: A0 … A7 are channels 7 … 0, A8 … A11 are 10 … 13.
pub const ANALOG_CHANNELS: u16 = 0x3CFF;

/// Segments of the arm of a board without a table, which has the reference wiring.
pub const SEGMENTS_WITHOUT_TABLE: usize = 6;

/// Counts of the regulators' PWM period: 84 MHz / 4200 = 20 kHz, which their filters smooth to a set-point.
pub const PWM_COUNTS: u16 = 4_200;

/// Speed of the serial line, Bd: exact on both of the board's chips, where 115 200 is off by 3 %.
pub const BAUD: u32 = 250_000;

/// Size of the transmit buffer, bytes: 40 ms of the line.
pub const TRANSMIT_BYTES: usize = 1024;

/// Size of the receive buffer, bytes: 20 ms of the line.
pub const RECEIVE_BYTES: usize = 512;

/// The end of the flash: the two slots of the table. They are in the second bank, so that the program runs while they are
/// written.
pub const STORAGE: Range<u32> = 0x0010_0000 - STORE_BYTES as u32..0x0010_0000;

/// Nominal period of the watchdog, ms. Its clock is ±40 %, so that the true period is 60 to 140 ms.
pub const WATCHDOG_MS: u32 = 100;
