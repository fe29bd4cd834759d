//! Wiring of an arm to the board: analog pins of the bend sensors, multiplexer channels of the IMUs, pins of the
//! regulators.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use crate::error::WiringError;

/// Segments of the longest arm that the board has room for.
pub const MAX_SEGMENTS: usize = 8;

/// Regulators of an arm, at most: the board's PWM channels.
pub const MAX_REGULATORS: usize = 8;

/// Number of analog pins, A0 to A11.
pub const ANALOG_PINS: u8 = 12;

/// Channels of the TCA9548A, the multiplexer of the IMUs.
pub const IMU_CHANNELS: u8 = 8;

/// I²C addresses of a BNO055, by its pin COM3.
pub const IMU_ADDRESSES: [u8; 2] = [0x28, 0x29];

/// Digital pins with a PWM channel of their own, in the order of preference.
pub const REGULATOR_PINS: [u8; MAX_REGULATORS] = [6, 7, 8, 9, 34, 36, 38, 40];

/// Regulators of the reference wiring.
const REFERENCE_REGULATORS: usize = 6;

/// Full scale of the regulators in the reference wiring, Pa over the atmosphere.
pub const REFERENCE_FULL_SCALE_PA: u32 = 280_000;

/// Largest full scale of a regulator, Pa over the atmosphere.
pub const MAX_FULL_SCALE_PA: u32 = 1_000_000;

/// Size of a segment's or a regulator's row in an image, bytes.
const ROW_BYTES: usize = 4;

/// Pin in a row where there is no bend sensor.
const NO_PIN: u8 = 0xFF;

/// Address in a row where there is no IMU.
const NO_ADDRESS: u8 = 0;

/// Wiring of an arm to the board.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring {
    /// Each segment's sensors, from the base.
    pub segments: Vec<SegmentWiring, MAX_SEGMENTS>,
    /// The regulators, in the order of the pressures in messages.
    pub regulators: Vec<RegulatorWiring, MAX_REGULATORS>,
}

/// Sensors of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SegmentWiring {
    /// Analog pins of bend sensors a and b: 0 to 11 for A0 to A11; `None`: no such sensor.
    pub bend: [Option<u8>; 2],
    /// Its IMU, if it has one.
    pub imu: Option<ImuAddress>,
}

/// An IMU behind the multiplexer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImuAddress {
    /// Channel of the TCA9548A, 0 to 7.
    pub channel: u8,
    /// I²C address, 0x28 or 0x29.
    pub address: u8,
}

/// A pressure regulator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegulatorWiring {
    /// Digital pin, one of [`REGULATOR_PINS`].
    pub pin: u8,
    /// Pressure at full duty of the PWM, Pa over the atmosphere.
    pub full_scale_pa: u32,
}

impl Wiring {
    /// A wiring without segments and regulators.
    pub(crate) const fn new() -> Self {
        Self { segments: Vec::new(), regulators: Vec::new() }
    }

    /// The reference wiring of an arm of 1 to 8 segments, as in `docs/how-to/wiring.md`: bend sensors a and b of segment k,
    /// from 0, on A(2k) and A(2k + 1), none past A11, its IMU on channel k at 0x28, and six regulators. More segments than
    /// the board has room for have no wiring.
    pub fn reference(segments: usize) -> Self {
        let pin = |index: u8| (index < ANALOG_PINS).then_some(index);
        let [address, _] = IMU_ADDRESSES;
        Self {
            segments: (0..MAX_SEGMENTS as u8)
                .take(segments)
                .map(|k| SegmentWiring {
                    bend: [pin(2 * k), pin(2 * k + 1)],
                    imu: Some(ImuAddress { channel: k, address }),
                })
                .collect(),
            regulators: REGULATOR_PINS
                .into_iter()
                .take(REFERENCE_REGULATORS)
                .map(|pin| RegulatorWiring { pin, full_scale_pa: REFERENCE_FULL_SCALE_PA })
                .collect(),
        }
    }

    /// Number of bend sensors.
    pub fn bend_sensors(&self) -> usize {
        self.segments.iter().flat_map(|segment| segment.bend).flatten().count()
    }

    /// Checks that the board has every pin, channel and address, and each of them once.
    ///
    /// # Errors
    /// [`WiringError`].
    pub fn check(&self) -> Result<(), WiringError> {
        if self.segments.is_empty() {
            return Err(WiringError::Segments);
        }
        // One bit for each pin or place in use.
        let (mut pins, mut imus, mut outputs) = (0_u32, 0_u32, 0_u32);
        for segment in &self.segments {
            for pin in segment.bend.into_iter().flatten() {
                if pin >= ANALOG_PINS {
                    return Err(WiringError::UnknownAnalogPin(pin));
                }
                if !occupy(&mut pins, pin) {
                    return Err(WiringError::SharedAnalogPin(pin));
                }
            }
            if let Some(ImuAddress { channel, address }) = segment.imu {
                if channel >= IMU_CHANNELS || !IMU_ADDRESSES.contains(&address) {
                    return Err(WiringError::UnknownImuAddress { channel, address });
                }
                if !occupy(&mut imus, channel | (address & 1) << 3) {
                    return Err(WiringError::SharedImuAddress { channel, address });
                }
            }
        }
        for &RegulatorWiring { pin, full_scale_pa } in &self.regulators {
            let channel = REGULATOR_PINS.iter().position(|known| *known == pin);
            let Some(channel) = channel else { return Err(WiringError::PinWithoutPwm(pin)) };
            if !occupy(&mut outputs, channel as u8) {
                return Err(WiringError::SharedRegulatorPin(pin));
            }
            if !(1..=MAX_FULL_SCALE_PA).contains(&full_scale_pa) {
                return Err(WiringError::FullScale(pin));
            }
        }
        Ok(())
    }

    /// Rows of the image: one for each segment, then one for each regulator.
    pub(crate) fn rows(&self) -> impl Iterator<Item = [u8; ROW_BYTES]> {
        let regulators = self.regulators.iter().copied().map(RegulatorWiring::row);
        self.segments.iter().copied().map(SegmentWiring::row).chain(regulators)
    }

    /// Reads the rows of an image, and returns the bytes after them. `None` if there are too few, or more than there is room
    /// for.
    pub(crate) fn read<'i>(&mut self, image: &'i [u8], segments: usize, regulators: usize) -> Option<&'i [u8]> {
        self.segments.clear();
        self.regulators.clear();
        let (bytes, rest) = image.split_at_checked((segments + regulators) * ROW_BYTES)?;
        let (rows, _) = bytes.as_chunks::<ROW_BYTES>();
        for (index, row) in rows.iter().enumerate() {
            if index < segments {
                self.segments.push(SegmentWiring::of(*row)).ok()?;
            } else {
                self.regulators.push(RegulatorWiring::of(*row)).ok()?;
            }
        }
        Some(rest)
    }
}

/// Sets a bit, and returns whether it was free.
const fn occupy(bits: &mut u32, index: u8) -> bool {
    let free = *bits >> index & 1 == 0;
    *bits |= 1 << index;
    free
}

impl SegmentWiring {
    /// Row of the image: pins a and b, channel and address of the IMU.
    fn row(self) -> [u8; ROW_BYTES] {
        let [a, b] = self.bend.map(|pin| pin.unwrap_or(NO_PIN));
        let ImuAddress { channel, address } = self.imu.unwrap_or(ImuAddress { channel: 0, address: NO_ADDRESS });
        [a, b, channel, address]
    }

    fn of([a, b, channel, address]: [u8; ROW_BYTES]) -> Self {
        Self {
            bend: [a, b].map(|pin| (pin != NO_PIN).then_some(pin)),
            imu: (address != NO_ADDRESS).then_some(ImuAddress { channel, address }),
        }
    }
}

impl RegulatorWiring {
    /// Row of the image: full scale in three bytes, little-endian, and the pin.
    const fn row(self) -> [u8; ROW_BYTES] {
        let [low, middle, high, _] = self.full_scale_pa.to_le_bytes();
        [low, middle, high, self.pin]
    }

    const fn of([low, middle, high, pin]: [u8; ROW_BYTES]) -> Self {
        Self { pin, full_scale_pa: u32::from_le_bytes([low, middle, high, 0]) }
    }
}
