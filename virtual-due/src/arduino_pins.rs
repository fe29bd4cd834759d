//! Names of the Due's pins, as its headers and the Arduino tools have them.

use sam3x_models::model::Pin;

const fn pin(port: u8, line: u8) -> Pin {
    Pin { port, line }
}

const A: u8 = 0;
const B: u8 = 1;
const C: u8 = 2;
const D: u8 = 3;

/// D0 to D53, port and line.
const DIGITAL: [(u8, u8); 54] = [
    (A, 8),
    (A, 9),
    (B, 25),
    (C, 28),
    (C, 26),
    (C, 25),
    (C, 24),
    (C, 23),
    (C, 22),
    (C, 21),
    (C, 29),
    (D, 7),
    (D, 8),
    (B, 27),
    (D, 4),
    (D, 5),
    (A, 13),
    (A, 12),
    (A, 11),
    (A, 10),
    (B, 12),
    (B, 13),
    (B, 26),
    (A, 14),
    (A, 15),
    (D, 0),
    (D, 1),
    (D, 2),
    (D, 3),
    (D, 6),
    (D, 9),
    (A, 7),
    (D, 10),
    (C, 1),
    (C, 2),
    (C, 3),
    (C, 4),
    (C, 5),
    (C, 6),
    (C, 7),
    (C, 8),
    (C, 9),
    (A, 19),
    (A, 20),
    (C, 19),
    (C, 18),
    (C, 17),
    (C, 16),
    (C, 15),
    (C, 14),
    (C, 13),
    (C, 12),
    (B, 21),
    (B, 14),
];

/// A0 to A11, port and line.
const ANALOG: [(u8, u8); 12] =
    [(A, 16), (A, 24), (A, 23), (A, 22), (A, 6), (A, 4), (A, 3), (A, 2), (B, 17), (B, 18), (B, 19), (B, 20)];

/// The other pins of the headers, and the two LEDs of the programming port.
const OTHERS: [(&str, Pin); 12] = [
    ("DAC0", pin(B, 15)),
    ("DAC1", pin(B, 16)),
    ("CANRX", pin(A, 1)),
    ("CANTX", pin(A, 0)),
    ("SDA1", pin(A, 17)),
    ("SCL1", pin(A, 18)),
    ("LED_RX", pin(C, 30)),
    ("LED_TX", pin(A, 21)),
    ("MISO", pin(A, 25)),
    ("MOSI", pin(A, 26)),
    ("SCK", pin(A, 27)),
    ("SS0", pin(A, 28)),
];

/// All pins with names, in the order of the Arduino tools: D0 to D53, A0 to A11, and the others.
pub fn all() -> Vec<(String, Pin)> {
    let numbered = |letter: char, pins: &[(u8, u8)]| -> Vec<(String, Pin)> {
        pins.iter().enumerate().map(|(number, (port, line))| (format!("{letter}{number}"), pin(*port, *line))).collect()
    };
    let mut all = numbered('D', &DIGITAL);
    all.extend(numbered('A', &ANALOG));
    all.extend(OTHERS.map(|(name, pin)| (name.to_owned(), pin)));
    all
}

/// The pin with this number of D0 to D53.
pub fn digital(number: u8) -> Option<Pin> {
    DIGITAL.get(usize::from(number)).map(|(port, line)| pin(*port, *line))
}

/// The pin of a name, in capitals or not.
pub fn named(name: &str) -> Option<Pin> {
    all().into_iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, pin)| pin)
}

#[cfg(test)]
mod tests {
    use super::{all, named};
    use crate::model::Pin;
    use std::collections::BTreeSet;

    #[test]
    fn each_name_is_a_pin_of_its_own() {
        let pins: BTreeSet<Pin> = all().into_iter().map(|(_, pin)| pin).collect();
        assert_eq!(pins.len(), 54 + 12 + 12);
    }

    #[test]
    fn pins_are_found_by_name() {
        assert_eq!(named("D13"), Some(Pin { port: 1, line: 27 }), "the LED is PB27");
        assert_eq!(named("a11"), Some(Pin { port: 1, line: 20 }));
        assert_eq!(named("D54"), None);
    }
}
