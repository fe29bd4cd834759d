//! BNO055: quaternions of an IMU in the fusion mode IMUPLUS, one short step a tick.
//!
//! A [`Bno055`] is advanced once a tick of 10 ms and never blocks: a step makes at most two transactions, each of at most
//! eight bytes of data, and the chip's 650 ms of reset are ticks without a transaction. The time is the number of the
//! tick, given by the caller, and may wrap.
//!
//! | phase | transactions in one tick | next phase after |
//! |---|---|---|
//! | identify | PAGE_ID ← 0, CHIP_ID → | CHIP_ID is 0xA0 |
//! | inspect | OPR_MODE →, then UNIT_SEL ← its mark, or SYS_TRIGGER ← RST_SYS | one tick |
//! | boot | none | 700 ms have passed; identified again |
//! | start | OPR_MODE ← IMUPLUS | one tick |
//! | settle | none for two ticks, then SYS_STATUS … OPR_MODE → | fusion runs; after 1 s without, reset |
//! | run | QUA_DATA →, UNIT_SEL … OPR_MODE →, every 8th tick from SYS_STATUS on | fusion has ended |
//!
//! A chip in CONFIGMODE has just come out of a reset and holds all defaults (BST-BNO055-DS000, 3.2 and 3.3.1), which
//! suit IMUPLUS here: a quaternion has no selectable unit (3.6.5.5), and the internal clock works on every board, also on
//! those without a crystal. A chip in any other mode is reset first, so that each start is from the
//! same state. A start takes 6 ticks from CONFIGMODE and about 77 ticks with a reset.
//!
//! A supply that dips returns the chip silently to CONFIGMODE, where it answers and reads zero or its last reading
//! (3.3.1), and a multiplexer that fails may connect another IMU than it confirms. A reading therefore counts only with
//! the mode and the mark that were read after it. The mark is a number of the IMU's own in the bits of UNIT_SEL that
//! select the units of acceleration, rate, Euler angles and temperature (3.6.1): a quaternion has none. It is written in
//! CONFIGMODE and lost in a reset. Another mark is another chip, which is left as it is. A chip that does not keep its
//! mark is read without it. After a start the heading has a new zero.
//!
//! The published crate `bno055` 0.4 does not suit: its start blocks for 650 ms and more, each of its calls first
//! writes the page register, which doubles the transactions, and it records a mode before the write has succeeded, so
//! that after one lost write it assumes a fusion that does not run.

use core::ops::RangeInclusive;
use embedded_hal::i2c::{Error, ErrorKind};
use embedded_hal_async::i2c::I2c;

/// The chip's address with COM3 low (Table 4-7).
pub const ADDRESS: u8 = 0x28;

const CHIP_ID: u8 = 0x00;
const PAGE_ID: u8 = 0x07;
const QUA_DATA_W_LSB: u8 = 0x20;
const SYS_STATUS: u8 = 0x39;
const UNIT_SEL: u8 = 0x3B;
const OPR_MODE: u8 = 0x3D;
const SYS_TRIGGER: u8 = 0x3F;

/// Value of CHIP_ID.
const IDENTITY: u8 = 0xA0;
/// Low bits of OPR_MODE (Table 3-5); the others are reserved.
const MODE_MASK: u8 = 0x0F;
const MODE_CONFIG: u8 = 0x00;
const MODE_IMUPLUS: u8 = 0x08;
/// SYS_STATUS: the fusion algorithm runs.
const STATUS_FUSION: u8 = 5;
/// UNIT_SEL after a reset (4.2.1).
const UNITS: u8 = 0x80;
/// SYS_TRIGGER: reset.
const RST_SYS: u8 = 0x20;

/// 650 ms from reset to CONFIGMODE is typical (Table 0-2); a chip that takes longer does not answer yet.
const BOOT_TICKS: u32 = 70;
/// 7 ms from CONFIGMODE to any other (Table 3-6); two ticks, because a step may come late in one and early in the next.
const SWITCH_TICKS: u32 = 2;
/// Longest time until fusion runs; after it the chip is started again.
const SETTLE_TICKS: u32 = 100;
/// Period of the checks of the status, ticks.
const CHECK_TICKS: u32 = 8;

/// Square of a quaternion's norm of 1 within 1 %: the chip's unit is 2¹⁴ steps (3.6.5.5).
const NORM_SQUARED: RangeInclusive<u64> = ((1 << 28) * 99 * 99 / 10_000)..=((1 << 28) * 101 * 101 / 10_000);

/// Result of one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// The orientation w, x, y, z in units of 2⁻¹⁴, of norm 1 within 1 %.
    Quaternion([i16; 4]),
    /// The chip answers, but with no unit quaternion, or it is another IMU, or no BNO055.
    Invalid,
    /// The chip is starting; the heading of its first reading has a new zero.
    Starting,
}

/// One IMU, read in IMUPLUS mode. The [module](self) documents the steps.
#[derive(Debug)]
pub struct Bno055 {
    address: u8,
    /// UNIT_SEL with its mark.
    marked_units: u8,
    phase: Phase,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Identify,
    Inspect,
    Boot {
        since: u32,
    },
    Start,
    Settle {
        since: u32,
    },
    /// `units`: UNIT_SEL when fusion began.
    Run {
        units: u8,
    },
}

impl Bno055 {
    /// The IMU at `address`, in any state, which gets `mark`: 1 to 15, and no other IMU's.
    #[must_use]
    pub const fn new(address: u8, mark: u8) -> Self {
        // Bits 0 to 2 and 4 select units; bit 3 is reserved.
        Self { address, marked_units: UNITS | mark & 0b0111 | (mark & 0b1000) << 1, phase: Phase::Identify }
    }

    /// Returns whether a step in this tick would make no transaction, so that it does not need the bus.
    #[must_use]
    pub fn is_waiting(&self, tick: u32) -> bool {
        match self.phase {
            Phase::Boot { since } => tick.wrapping_sub(since) < BOOT_TICKS,
            Phase::Settle { since } => tick.wrapping_sub(since) < SWITCH_TICKS,
            Phase::Identify | Phase::Inspect | Phase::Start | Phase::Run { .. } => false,
        }
    }

    /// Advances the driver in tick number `tick`: at most two transactions. The future may be dropped at any await.
    ///
    /// # Errors
    ///
    /// The bus's error; the step is repeated in the next tick. The caller decides how often it polls a chip that does not
    /// answer.
    pub async fn step<I: I2c>(&mut self, i2c: &mut I, tick: u32) -> Result<Answer, I::Error> {
        if self.is_waiting(tick) {
            return Ok(Answer::Starting);
        }
        match self.phase {
            Phase::Identify | Phase::Boot { .. } => self.identify(i2c).await,
            Phase::Inspect => self.inspect(i2c, tick).await,
            Phase::Start => self.start(i2c, tick).await,
            Phase::Settle { since } => self.settle(i2c, tick.wrapping_sub(since)).await,
            Phase::Run { units } => self.run(i2c, tick, units).await,
        }
    }

    async fn identify<I: I2c>(&mut self, i2c: &mut I) -> Result<Answer, I::Error> {
        // Another page would hide the identity; PAGE_ID is on both pages (4.2).
        self.write(i2c, PAGE_ID, 0).await?;
        if !self.is_bno055(i2c).await? {
            return Ok(Answer::Invalid);
        }
        self.phase = Phase::Inspect;
        Ok(Answer::Starting)
    }

    async fn inspect<I: I2c>(&mut self, i2c: &mut I, tick: u32) -> Result<Answer, I::Error> {
        let [mode] = self.read(i2c, OPR_MODE).await?;
        if mode & MODE_MASK == MODE_CONFIG {
            self.write(i2c, UNIT_SEL, self.marked_units).await?;
            self.phase = Phase::Start;
        } else {
            self.phase = Phase::Boot { since: tick };
            match self.write(i2c, SYS_TRIGGER, RST_SYS).await {
                // The chip may be gone before it acknowledges. If it was not reset, it is inspected again.
                Err(error) if !matches!(error.kind(), ErrorKind::NoAcknowledge(_)) => return Err(error),
                _ => {}
            }
        }
        Ok(Answer::Starting)
    }

    async fn start<I: I2c>(&mut self, i2c: &mut I, tick: u32) -> Result<Answer, I::Error> {
        self.write(i2c, OPR_MODE, MODE_IMUPLUS).await?;
        self.phase = Phase::Settle { since: tick };
        Ok(Answer::Starting)
    }

    async fn settle<I: I2c>(&mut self, i2c: &mut I, ticks: u32) -> Result<Answer, I::Error> {
        let state = self.state(i2c).await?;
        if state.has_fusion() {
            self.phase = Phase::Run { units: state.units };
        } else if state.mode != MODE_IMUPLUS || ticks >= SETTLE_TICKS {
            self.phase = Phase::Identify;
        }
        Ok(Answer::Starting)
    }

    async fn run<I: I2c>(&mut self, i2c: &mut I, tick: u32, units: u8) -> Result<Answer, I::Error> {
        let quaternion = self.quaternion(i2c).await?;
        let state =
            if tick.is_multiple_of(CHECK_TICKS) { self.state(i2c).await? } else { self.state_but_status(i2c).await? };
        if !state.has_fusion() {
            self.phase = Phase::Identify;
            return Ok(Answer::Starting);
        }
        let is_valid = state.units == units && is_unit(quaternion);
        Ok(if is_valid { Answer::Quaternion(quaternion) } else { Answer::Invalid })
    }

    async fn is_bno055<I: I2c>(&self, i2c: &mut I) -> Result<bool, I::Error> {
        Ok(self.read(i2c, CHIP_ID).await? == [IDENTITY])
    }

    /// SYS_STATUS 0x39, UNIT_SEL 0x3B and OPR_MODE 0x3D in one read.
    async fn state<I: I2c>(&self, i2c: &mut I) -> Result<State, I::Error> {
        let [status, _, units, _, mode] = self.read(i2c, SYS_STATUS).await?;
        Ok(State { status, units, mode: mode & MODE_MASK })
    }

    /// The same without the status, in two bytes less.
    async fn state_but_status<I: I2c>(&self, i2c: &mut I) -> Result<State, I::Error> {
        let [units, _, mode] = self.read(i2c, UNIT_SEL).await?;
        Ok(State { status: STATUS_FUSION, units, mode: mode & MODE_MASK })
    }

    async fn quaternion<I: I2c>(&self, i2c: &mut I) -> Result<[i16; 4], I::Error> {
        let [w0, w1, x0, x1, y0, y1, z0, z1] = self.read(i2c, QUA_DATA_W_LSB).await?;
        Ok([[w0, w1], [x0, x1], [y0, y1], [z0, z1]].map(i16::from_le_bytes))
    }

    async fn read<I: I2c, const N: usize>(&self, i2c: &mut I, register: u8) -> Result<[u8; N], I::Error> {
        let mut bytes = [0; N];
        i2c.write_read(self.address, &[register], &mut bytes).await?;
        Ok(bytes)
    }

    async fn write<I: I2c>(&self, i2c: &mut I, register: u8, value: u8) -> Result<(), I::Error> {
        i2c.write(self.address, &[register, value]).await
    }
}

/// State of the chip.
struct State {
    status: u8,
    units: u8,
    mode: u8,
}

impl State {
    fn has_fusion(&self) -> bool {
        self.status == STATUS_FUSION && self.mode == MODE_IMUPLUS
    }
}

fn is_unit(quaternion: [i16; 4]) -> bool {
    let squares = quaternion.map(|component| u64::from(component.unsigned_abs()).pow(2));
    NORM_SQUARED.contains(&squares.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::is_unit;

    #[test]
    fn only_a_norm_within_one_percent_is_a_reading() {
        assert!(is_unit([16384, 0, 0, 0]));
        assert!(is_unit([-8192, 8192, -8192, 8192]));
        assert!(is_unit([0, 0, 0, 16547]) && is_unit([0, 16221, 0, 0]));
        assert!(!is_unit([0, 0, 0, 16548]) && !is_unit([0, 16219, 0, 0]));
        assert!(!is_unit([0; 4]));
        assert!(!is_unit([-1; 4]));
        assert!(!is_unit([i16::MIN; 4]));
    }
}
