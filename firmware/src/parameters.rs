//! Every number that was chosen for this rig.

use core::ops::Range;

use board_core::FULL_SCALE_PA;
use telemetry::{BEND_SENSORS, REGULATORS, TICK_US};

/// Ticks a second: the ADC's trigger, and with it everything else.
pub const TICK_HZ: u32 = (1_000_000 / TICK_US) as u32;

/// From the ADC's trigger to the tick's interrupt, µs: a scan of twelve channels takes 50 µs.
pub const SCAN_US: u32 = 200;

/// From a tick's trigger to the end of the IMUs' round, µs. What has not answered by then counts as not read.
pub const IMUS_US: u64 = 4_000;

/// ADC channels of the bend sensors: A0 … A7 are channels 7 … 0, A8 … A11 are 10 … 13.
pub const BEND_CHANNELS: u16 = 0x3CFF;

/// Where the bend sensors 1a, 1b, … 6b, on A0 … A11, stand in a scan, which comes in the order of the channels.
pub const BEND_POSITIONS: [usize; BEND_SENSORS] = [7, 6, 5, 4, 3, 2, 1, 0, 8, 9, 10, 11];

/// Counts of the regulators' PWM period: 84 MHz / 4200 = 20 kHz, which their filters smooth to a set-point.
pub const PWM_COUNTS: u16 = 4_200;

/// The most that each regulator may be set to, Pa.
pub const LIMITS_PA: [u32; REGULATORS] = [FULL_SCALE_PA; REGULATORS];

/// Speed of the serial line, Bd: exact on both of the board's chips, where 115 200 is off by 3 %.
pub const BAUD: u32 = 250_000;

/// Bytes that wait for the line, 40 ms of it.
pub const TRANSMIT_BYTES: usize = 1024;

/// Bytes that wait to be read, 20 ms of the line.
pub const RECEIVE_BYTES: usize = 512;

/// The end of the flash, kept free for a table that is saved by the board itself.
pub const STORAGE: Range<u32> = 0x000F_F000..0x0010_0000;

/// Time without feeding after which the watchdog bites, ms. Its clock is ±40 %, so that it is 60 to 140 ms in truth.
pub const WATCHDOG_MS: u32 = 100;
