//! Identity of the board and its firmware, for the `Hello`.

use atsam3x8e_hal::crash;
use atsam3x8e_hal::reset::Cause;
use board_table::{BoardTable, MAX_SEGMENTS, Wiring};
use telemetry::{Hello, PROTOCOL_VERSION, ResetCause, SCHEMA, Text, text};

/// The board's `Hello`, of a board without a table.
pub fn hello(chip: [u8; 16], reset: ResetCause, boot: u32, last_panic: Option<&crash::Text>) -> Hello {
    Hello {
        protocol: PROTOCOL_VERSION,
        schema: SCHEMA,
        firmware: text(env!("CARGO_PKG_VERSION")),
        revision: text(env!("REVISION")),
        arm: Text::new(),
        table: 0,
        segments: 0,
        bend_sensors: 0,
        regulators: 0,
        chip,
        reset,
        boot,
        last_panic: last_panic.map(|last| text(last.as_str())),
    }
}

/// Enters the board's table and its arm's wiring in its `Hello`.
pub fn enter_arm(hello: &mut Hello, table: &BoardTable<MAX_SEGMENTS>, wiring: &Wiring) {
    hello.arm = text(table.arm());
    hello.table = table.checksum();
    hello.segments = wiring.segments.len() as u8;
    hello.bend_sensors = wiring.bend_sensors() as u8;
    hello.regulators = wiring.regulators.len() as u8;
}

/// Converts the HAL's cause of the reset to the protocol's.
pub fn reset_cause(cause: Cause) -> ResetCause {
    match cause {
        Cause::PowerUp | Cause::Unknown => ResetCause::PowerOn,
        Cause::Backup => ResetCause::Backup,
        Cause::Watchdog => ResetCause::Watchdog,
        Cause::Software => ResetCause::Software,
        Cause::Pin => ResetCause::Pin,
    }
}
