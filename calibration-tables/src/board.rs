//! `[board]`: pins of the arm's sensors and regulators on its board, an Arduino Due.

use std::fmt;

use board_table::{
    ANALOG_PINS, IMU_ADDRESSES, IMU_CHANNELS, ImuAddress, MAX_FULL_SCALE_PA, MAX_SEGMENTS, REGULATOR_PINS,
    RegulatorWiring, SegmentWiring, Wiring,
};
use serde::{Deserialize, Serialize};

use crate::error::{FileError, ensure, within};
use crate::segment::SegmentToml;

/// Largest full scale of a regulator, kPa.
const MAX_FULL_SCALE_KPA: f64 = MAX_FULL_SCALE_PA as f64 / 1000.0;

/// `[board]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoardToml {
    /// Sensors of each segment, from the base.
    #[serde(rename = "segment", default)]
    pub segments: Vec<BoardSegmentToml>,
    /// The regulators, in the order of the pressures in messages.
    #[serde(rename = "regulator", default, skip_serializing_if = "Vec::is_empty")]
    pub regulators: Vec<RegulatorToml>,
}

/// `[[board.segment]]`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoardSegmentToml {
    /// Pins of bend sensors a and b, as many as there are.
    #[serde(default)]
    pub bend: Vec<AnalogPin>,
    /// The IMU; `None`: the segment has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imu: Option<ImuToml>,
}

/// `imu`: an IMU behind the multiplexer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImuToml {
    /// Channel of the TCA9548A, 0 to 7.
    pub channel: u8,
    /// I²C address, 0x28 or 0x29.
    pub address: u8,
}

/// `[[board.regulator]]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegulatorToml {
    /// Pin of the set-point.
    pub pin: DigitalPin,
    /// Pressure over the atmosphere at full duty of the PWM.
    pub full_scale_kpa: f64,
}

/// An analog pin, in the file `"A0"` to `"A11"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct AnalogPin(pub u8);

/// A digital pin, in the file such as `"D6"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct DigitalPin(pub u8);

impl BoardToml {
    /// The wiring, as the board has it; `None` for more segments than the board has room for.
    pub(crate) fn wiring(&self) -> Option<Wiring> {
        (self.segments.len() <= MAX_SEGMENTS).then(|| Wiring {
            segments: self.segments.iter().map(BoardSegmentToml::wiring).collect(),
            regulators: self.regulators.iter().take(REGULATOR_PINS.len()).map(RegulatorToml::wiring).collect(),
        })
    }

    pub(crate) fn check(&self, segments: &[SegmentToml]) -> Result<(), FileError> {
        let (found, n) = (self.segments.len(), segments.len());
        ensure(found == n, "board.segment", &format!("{found} segments"), &format!("{n}, one for each [[segment]]"))?;
        let mut pins = Places::default();
        let mut imus = Places::default();
        for (i, (wired, segment)) in self.segments.iter().zip(segments).enumerate() {
            let key = format!("board.segment[{}]", i + 1);
            wired.check_bend(&format!("{key}.bend"), segment, &mut pins)?;
            wired.check_imu(&format!("{key}.imu"), &mut imus)?;
        }
        let count = self.regulators.len();
        let most = REGULATOR_PINS.len();
        ensure(count <= most, "board.regulator", &format!("{count} regulators"), &format!("at most {most}"))?;
        let mut outputs = Places::default();
        for (i, regulator) in self.regulators.iter().enumerate() {
            regulator.check(&format!("board.regulator[{}]", i + 1), &mut outputs)?;
        }
        Ok(())
    }
}

impl BoardSegmentToml {
    fn wiring(&self) -> SegmentWiring {
        let mut pins = self.bend.iter().map(|pin| pin.0);
        SegmentWiring {
            bend: [pins.next(), pins.next()],
            imu: self.imu.map(|ImuToml { channel, address }| ImuAddress { channel, address }),
        }
    }

    fn check_bend(&self, key: &str, segment: &SegmentToml, used: &mut Places) -> Result<(), FileError> {
        let (pins, maps) = (self.bend.len(), segment.bend.as_ref().map_or(0, Vec::len));
        ensure(pins <= 2, key, &format!("{pins} pins"), "at most two, of sensors a and b")?;
        ensure(pins >= maps, key, &format!("{pins} pins"), &format!("{maps}, one for each of the segment's `bend`"))?;
        for pin in &self.bend {
            let expected = format!("one of A0 to A{}", ANALOG_PINS - 1);
            ensure(pin.0 < ANALOG_PINS, key, &format!("pin {pin}"), &expected)?;
            used.occupy(key, format!("pin {pin}"), "a pin")?;
        }
        Ok(())
    }

    fn check_imu(&self, key: &str, used: &mut Places) -> Result<(), FileError> {
        let Some(ImuToml { channel, address }) = self.imu else { return Ok(()) };
        let expected = format!("0 to {}", IMU_CHANNELS - 1);
        ensure(channel < IMU_CHANNELS, &format!("{key}.channel"), &channel, &expected)?;
        let [low, high] = IMU_ADDRESSES;
        let expected = format!("{low:#04x} or {high:#04x}");
        ensure(IMU_ADDRESSES.contains(&address), &format!("{key}.address"), &format!("{address:#04x}"), &expected)?;
        used.occupy(key, format!("channel {channel}, address {address:#04x}"), "a place")
    }
}

impl RegulatorToml {
    fn wiring(&self) -> RegulatorWiring {
        RegulatorWiring { pin: self.pin.0, full_scale_pa: (self.full_scale_kpa * 1000.0).round() as u32 }
    }

    fn check(&self, key: &str, used: &mut Places) -> Result<(), FileError> {
        let key_of_pin = format!("{key}.pin");
        let known = REGULATOR_PINS.map(|pin| DigitalPin(pin).to_string()).join(", ");
        ensure(REGULATOR_PINS.contains(&self.pin.0), &key_of_pin, &self.pin, &format!("one of {known}"))?;
        used.occupy(&key_of_pin, self.pin.to_string(), "a pin")?;
        within(&format!("{key}.full_scale_kpa"), self.full_scale_kpa, 0.001..=MAX_FULL_SCALE_KPA)
    }
}

/// Places in use, each with the key that names it.
#[derive(Default)]
struct Places(Vec<(String, String)>);

impl Places {
    fn occupy(&mut self, key: &str, place: String, what: &str) -> Result<(), FileError> {
        if let Some((_, holder)) = self.0.iter().find(|(used, _)| *used == place) {
            let expected = format!("{what} of its own: {holder} has this one");
            return ensure(false, key, &place, &expected);
        }
        self.0.push((place, key.to_owned()));
        Ok(())
    }
}

/// Number of a pin from its name, such as 11 from `A11`.
fn number(name: &str, letter: char) -> Option<u8> {
    let number = name.strip_prefix(letter)?.parse().ok()?;
    // No sign and no leading zero.
    (name == format!("{letter}{number}")).then_some(number)
}

impl TryFrom<String> for AnalogPin {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        number(&name, 'A').map(Self).ok_or_else(|| format!("pin {name:?}, expected an analog pin such as \"A0\""))
    }
}

impl TryFrom<String> for DigitalPin {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        number(&name, 'D').map(Self).ok_or_else(|| format!("pin {name:?}, expected a digital pin such as \"D6\""))
    }
}

impl fmt::Display for AnalogPin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "A{}", self.0)
    }
}

impl fmt::Display for DigitalPin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "D{}", self.0)
    }
}

impl From<AnalogPin> for String {
    fn from(pin: AnalogPin) -> Self {
        pin.to_string()
    }
}

impl From<DigitalPin> for String {
    fn from(pin: DigitalPin) -> Self {
        pin.to_string()
    }
}
