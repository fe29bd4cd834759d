//! Identity of the board and its firmware, for the `Hello`.

use atsam3x8e_hal::crash;
use atsam3x8e_hal::reset::Cause;
use board_table::{BoardTable, MAX_SEGMENTS};
use telemetry::{Hello, PROTOCOL_VERSION, ResetCause, SCHEMA, Text};

/// The board's `Hello`, of a board without a table.
pub fn hello(chip: [u8; 16], reset: ResetCause, boot: u32, last_panic: Option<&crash::Text>) -> Hello {
    Hello {
        protocol: PROTOCOL_VERSION,
        schema: SCHEMA,
        firmware: text(env!("CARGO_PKG_VERSION")),
        revision: text(env!("REVISION")),
        arm: Text::new(),
        table: 0,
        chip,
        reset,
        boot,
        last_panic: last_panic.map(|last| text(last.as_str())),
    }
}

/// Enters the board's table in its `Hello`.
pub fn enter_table(hello: &mut Hello, table: &BoardTable<MAX_SEGMENTS>) {
    hello.arm = text(table.arm());
    hello.table = table.checksum();
}

/// Cuts a text at N bytes.
fn text<const N: usize>(whole: &str) -> Text<N> {
    let mut text = Text::new();
    for character in whole.chars() {
        if text.push(character).is_err() {
            break;
        }
    }
    text
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
