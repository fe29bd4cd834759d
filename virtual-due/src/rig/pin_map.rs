//! Channels and lines of the pins that a wiring uses.

use board_table::Wiring;
use sam3x_models::model::Pin;

use crate::arduino_pins;

/// The ADC channel of each analog pin, A0 to A11.
const ANALOG_CHANNELS: [u8; 12] = [7, 6, 5, 4, 3, 2, 1, 0, 10, 11, 12, 13];
/// Digital pins of the regulators, each with its PWM channel.
const PWM_PINS: [(u8, u8); 8] = [(6, 7), (7, 6), (8, 5), (9, 4), (34, 0), (36, 1), (38, 2), (40, 3)];

/// Channels and lines of the wired pins.
#[derive(Debug, Clone)]
pub struct Pins {
    /// ADC channel of each bend sensor, in the order 1a, 1b, 2a, …
    bend_channels: Vec<Option<u8>>,
    /// The ADC channel whose conversion counts as that of a scan: the first bend sensor's, or A0's.
    pub scan_channel: u8,
    /// PWM channel and line of each regulator.
    regulators: Vec<Option<(u8, Pin)>>,
}

impl Pins {
    /// The pins of a wiring. A pin that the board does not have is not wired.
    pub fn new(wiring: &Wiring) -> Self {
        let channel = |pin: u8| ANALOG_CHANNELS.get(usize::from(pin)).copied();
        let pins = wiring.segments.iter().flat_map(|segment| segment.bend);
        let bend_channels: Vec<Option<u8>> = pins.map(|pin| pin.and_then(channel)).collect();
        let scan_channel = bend_channels.iter().flatten().next().copied().unwrap_or(ANALOG_CHANNELS[0]);
        let output = |wired: u8| {
            let (_, channel) = PWM_PINS.iter().find(|(pin, _)| *pin == wired)?;
            Some((*channel, arduino_pins::digital(wired)?))
        };
        let regulators = wiring.regulators.iter().map(|regulator| output(regulator.pin)).collect();
        Self { bend_channels, scan_channel, regulators }
    }

    /// The bend sensor on an ADC channel.
    pub fn sensor(&self, channel: u8) -> Option<usize> {
        self.bend_channels.iter().position(|wired| *wired == Some(channel))
    }

    /// The regulator on a PWM channel.
    pub fn pulsed(&self, channel: u8) -> Option<usize> {
        self.regulators.iter().position(|wired| wired.is_some_and(|(wired, _)| wired == channel))
    }

    /// The regulator on a line.
    pub fn driven(&self, pin: Pin) -> Option<usize> {
        self.regulators.iter().position(|wired| wired.is_some_and(|(_, wired)| wired == pin))
    }
}
