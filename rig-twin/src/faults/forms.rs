//! Name, value, unit and effect of every fault: what the parser accepts, and what the reference lists.

use std::fmt::Write;

use Acts::{Board, Sensor};

/// Value of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ValueForm {
    pub low: f64,
    pub high: f64,
    /// Unit; empty for a factor.
    pub unit: &'static str,
    /// True if it is a whole number.
    pub is_whole: bool,
    /// A valid value, as text.
    pub example: &'static str,
}

/// What a fault acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Acts {
    /// The simulated sensors: in sessions and on the emulated board.
    Sensor,
    /// The emulated board alone.
    Board,
}

/// Form of a name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form {
    /// Kind of the device: its name without a number.
    pub kind: &'static str,
    /// The fault.
    pub fault: &'static str,
    pub value: Option<ValueForm>,
    pub acts: Acts,
    pub effect: &'static str,
}

const fn number(low: f64, high: f64, unit: &'static str, example: &'static str) -> ValueForm {
    ValueForm { low, high, unit, is_whole: false, example }
}

const fn whole(low: f64, high: f64, unit: &'static str, example: &'static str) -> ValueForm {
    ValueForm { low, high, unit, is_whole: true, example }
}

const fn form(
    (kind, fault): (&'static str, &'static str),
    value: Option<ValueForm>,
    acts: Acts,
    effect: &'static str,
) -> Form {
    Form { kind, fault, value, acts, effect }
}

/// Every fault.
#[rustfmt::skip]
pub(super) const FORMS: &[Form] = &[
    form(("bend", "open"), None, Sensor, "the strip is open: 4095 counts"),
    form(("bend", "short"), None, Sensor, "the strip is shorted: 0 counts"),
    form(("bend", "stuck"), None, Sensor, "the first counts, again and again"),
    form(("bend", "intermittent"), None, Sensor, "open at every second conversion"),
    form(("bend", "drift"), Some(number(-4095.0, 4095.0, "counts/s", "30")), Sensor, "counts that drift from the begin on"),
    form(("bend", "offset"), Some(number(-4095.0, 4095.0, "counts", "300")), Sensor, "counts added"),
    form(("bend", "factor"), Some(number(0.0, 100.0, "", "1.3")), Sensor, "counts multiplied"),
    form(("imu", "unplugged"), None, Sensor, "no power; at the end it boots for 400 ms, and its heading begins at another zero"),
    form(("imu", "reset"), None, Sensor, "power-on reset: 650 ms of boot, CONFIG mode, and its heading begins at another zero"),
    form(("imu", "brown-out"), None, Sensor, "CONFIG mode without a boot: the data are zero, and its heading begins at another zero"),
    form(("imu", "frozen"), None, Sensor, "the output does not change"),
    form(("imu", "jump"), Some(number(-360.0, 360.0, "°", "30")), Sensor, "the heading is turned, clockwise positive; at the end it turns back"),
    form(("imu", "random"), None, Sensor, "each output is another orientation, at random; `+0.01` is a single output"),
    form(("imu", "zeros"), None, Sensor, "quaternions of zeros"),
    form(("imu", "norm"), Some(number(0.0, 4.0, "", "0.7")), Sensor, "quaternions of this norm; from 2 on the registers overflow"),
    form(("imu", "nack"), Some(number(0.0, 1.0, "of 1", "0.1")), Board, "this share of the addresses is not acknowledged, at random"),
    form(("imu", "stretch"), Some(number(0.0, 1000.0, "ms", "2")), Board, "it holds the clock low before each transfer to the master"),
    form(("sda", "held"), None, Board, "the line is held low"),
    form(("sda", "held-clocks"), Some(whole(1.0, 1000.0, "clocks", "5")), Board, "held low for so many clock pulses by hand"),
    form(("sda", "held-until-reset"), None, Board, "held low until the multiplexer is reset"),
    form(("scl", "held"), None, Board, "the line is held low"),
    form(("scl", "held-until-reset"), None, Board, "held low until the multiplexer is reset"),
    form(("mux", "silent"), None, Board, "the multiplexer does not answer, until its reset"),
    form(("mux", "stuck"), None, Board, "the multiplexer acknowledges and keeps its channels, until its reset"),
    form(("mux", "wrong"), Some(whole(1.0, 7.0, "channels", "1")), Board, "it connects a channel that is so many further on, and reads that one back"),
    form(("mux", "lying"), Some(whole(1.0, 7.0, "channels", "1")), Board, "it connects a channel that is so many further on, and reads back the one requested"),
    form(("adc", "stopped"), None, Board, "the converter ignores its triggers"),
    form(("adc", "tags"), None, Board, "every conversion has the tag of the next channel"),
    form(("adc", "tags-every-other"), None, Board, "the same in every second scan"),
    form(("line", "noise"), Some(number(0.0, 1.0, "of 1", "0.001")), Board, "a bit is flipped in this share of the bytes, in both directions, at random"),
    form(("line", "flood"), None, Board, "random bytes to the board, as fast as the line takes them"),
    form(("line", "cut"), None, Board, "nothing arrives in either direction: the host is gone"),
    form(("line", "replay"), Some(number(0.001, 60.0, "s", "3")), Board, "bytes sent to the board arrive again, so much later"),
    form(("line", "reorder"), None, Board, "every two frames to the board arrive in the other order"),
    form(("flash", "flip"), Some(whole(0x8_0000 as f64, 0xF_FFFF as f64, "(address)", "0x000c0000")), Board, "the lowest bit of the byte at this address is flipped"),
    form(("power", "cut"), None, Board, "the supply of board, IMUs and multiplexer is cut for an instant"),
    form(("irq", "masked"), None, Board, "an interrupt of the chip, 0 to 44, is masked: its task is held up"),
    form(("stack", "overflow"), None, Board, "the code that runs pushes until its stack is full"),
];

impl Form {
    /// A valid name of this form.
    pub fn example(&self) -> String {
        let number = match self.kind {
            "bend" => "2a",
            "imu" => "3",
            "irq" => "27",
            _ => "",
        };
        let value = self.value.map_or(String::new(), |value| format!("={}", value.example));
        format!("{}{number}:{}{value}", self.kind, self.fault)
    }
}

/// The table of all faults of the reference, in Markdown.
pub fn reference_table() -> String {
    let mut table = "| name | effect | value | in sessions |\n|---|---|---|---|\n".to_owned();
    for form in FORMS {
        let value = form.value.map_or(String::new(), |value| {
            let number = |number: f64| {
                if form.kind == "flash" { format!("{:#010x}", number as u32) } else { number.to_string() }
            };
            format!("{} to {} {}", number(value.low), number(value.high), value.unit)
        });
        let in_sessions = if form.acts == Sensor { "yes" } else { "" };
        // Writing to a string cannot fail.
        let _ = writeln!(table, "| `{}` | {} | {} | {in_sessions} |", form.example(), form.effect, value.trim_end());
    }
    table
}
