//! The faults, with the sensor and the size of each.

use crate::constants::{MAX_SEGMENTS, SENSORS_PER_SEGMENT};

/// Place of a bend sensor: 1a, 1b, 2a, …
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BendPlace(u8);

impl BendPlace {
    /// The place of this index in the order 1a, 1b, 2a, …, counted from 0; `None` beyond the longest arm.
    pub fn new(index: usize) -> Option<Self> {
        (index < SENSORS_PER_SEGMENT * MAX_SEGMENTS).then_some(Self(index as u8))
    }

    /// Its index in the order 1a, 1b, 2a, …, counted from 0.
    pub fn index(self) -> usize {
        self.0.into()
    }
}

/// A segment, and its IMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SegmentNumber(u8);

impl SegmentNumber {
    /// The segment of this index, counted from 0; `None` beyond the longest arm.
    pub fn new(index: usize) -> Option<Self> {
        (index < MAX_SEGMENTS).then_some(Self(index as u8))
    }

    /// Its index, counted from 0.
    pub fn index(self) -> usize {
        self.0.into()
    }
}

/// Time for which a line of the bus is held low.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// Until the fault ends.
    UntilCleared,
    /// For this many clock pulses, generated with SCL as a GPIO.
    Clocks(u32),
    /// Until the multiplexer is reset, which disconnects the culprit.
    UntilMuxReset,
}

/// A fault.
///
/// Its name has a device, a fault and for some a value; `docs/reference/faults.md` lists them.
///
/// ```
/// use rig_twin::{Fault, FaultError};
///
/// let fault: Fault = "bend2a:factor=1.3".parse()?;
/// assert_eq!(fault.to_string(), "bend2a:factor=1.3");
/// assert!("bend2a:melted".parse::<Fault>().is_err());
/// # Ok::<(), FaultError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Full-scale counts: the strip is open.
    BendOpen(BendPlace),
    /// 0 counts: the strip is shorted.
    BendShort(BendPlace),
    /// The counts of the first conversion, again and again.
    BendStuck(BendPlace),
    /// Open at every second conversion.
    BendIntermittent(BendPlace),
    /// The counts drift from the begin on, counts/s.
    BendDrift(BendPlace, f64),
    /// Counts added.
    BendOffset(BendPlace, f64),
    /// The counts are multiplied.
    BendFactor(BendPlace, f64),
    /// No power; at the end it starts, with another zero of its heading.
    ImuUnplugged(SegmentNumber),
    /// Power-on reset.
    ImuReset(SegmentNumber),
    /// A dip of the supply that ends in CONFIG mode without a boot.
    ImuBrownOut(SegmentNumber),
    /// The output does not change.
    ImuFrozen(SegmentNumber),
    /// The heading is turned, clockwise positive, degrees.
    ImuJump(SegmentNumber, f64),
    /// Each output is another orientation, at random.
    ImuRandom(SegmentNumber),
    /// Quaternions of zeros.
    ImuZeros(SegmentNumber),
    /// Quaternions of this norm; registers overflow above 2.
    ImuNorm(SegmentNumber, f64),
    /// This share of the addresses is not acknowledged.
    ImuNack(SegmentNumber, f64),
    /// It holds the clock low before each transfer to the master, ms.
    ImuStretch(SegmentNumber, f64),
    /// SDA is held low.
    SdaHeld(Hold),
    /// SCL is held low.
    SclHeld(Hold),
    /// The multiplexer does not answer; its channels stay. A reset ends it.
    MuxSilent,
    /// The multiplexer acknowledges and changes nothing. A reset ends it.
    MuxStuck,
    /// The multiplexer connects a channel that is so many further on, and reads back what it has connected.
    MuxWrong(u8),
    /// The multiplexer connects a channel that is so many further on, and reads back the one requested.
    MuxLying(u8),
    /// The converter ignores its triggers.
    AdcStopped,
    /// Every conversion has the tag of the next channel.
    AdcTags,
    /// As [`AdcTags`](Self::AdcTags), in every second scan.
    AdcTagsEveryOther,
    /// A bit is flipped in this share of the bytes, in both directions.
    LineNoise(f64),
    /// Random bytes to the board, as fast as the line takes them.
    LineFlood,
    /// Nothing arrives in either direction.
    LineCut,
    /// The bytes sent to the board arrive again, this time later, s.
    LineReplay(f64),
    /// Every two frames to the board arrive in the other order.
    LineReorder,
    /// The lowest bit of the byte at this address of the flash is flipped.
    FlashFlip(u32),
    /// The supply of board, IMUs and multiplexer is cut for an instant.
    PowerCut,
    /// An interrupt of the chip is masked, so that its task does not run.
    IrqMasked(u8),
    /// The code that runs pushes until its stack overflows.
    StackOverflow,
}

impl Fault {
    /// True if it happens at an instant and does not last.
    pub fn is_instant(self) -> bool {
        matches!(
            self,
            Self::ImuReset(_) | Self::ImuBrownOut(_) | Self::FlashFlip(_) | Self::PowerCut | Self::StackOverflow
        )
    }

    /// Index of the bend sensor that it concerns.
    pub fn bend_sensor(self) -> Option<usize> {
        match self {
            Self::BendOpen(place)
            | Self::BendShort(place)
            | Self::BendStuck(place)
            | Self::BendIntermittent(place)
            | Self::BendDrift(place, _)
            | Self::BendOffset(place, _)
            | Self::BendFactor(place, _) => Some(place.index()),
            _ => None,
        }
    }

    /// Index of the segment whose IMU it concerns.
    pub fn imu(self) -> Option<usize> {
        match self {
            Self::ImuUnplugged(segment)
            | Self::ImuReset(segment)
            | Self::ImuBrownOut(segment)
            | Self::ImuFrozen(segment)
            | Self::ImuJump(segment, _)
            | Self::ImuRandom(segment)
            | Self::ImuZeros(segment)
            | Self::ImuNorm(segment, _)
            | Self::ImuNack(segment, _)
            | Self::ImuStretch(segment, _) => Some(segment.index()),
            _ => None,
        }
    }
}
