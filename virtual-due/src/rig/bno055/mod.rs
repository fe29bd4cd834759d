//! A BNO055 (Bosch BST-BNO055-DS000): registers, operation modes, and the fusion's output.

mod fusion;
mod registers;

use fusion::{Fusion, gravity};
use registers::Registers;
use sam3x_models::model::{CYCLES_PER_SECOND, Cycles};

/// Time from power to the first answer (data sheet table 0-2).
const POWER_ON: Cycles = ms(400);
/// Time from RST_SYS to the first answer (data sheet table 0-2).
const RESET: Cycles = ms(650);
/// Mode switching (data sheet table 3-6).
const TO_CONFIG: Cycles = ms(19);
const FROM_CONFIG: Cycles = ms(7);
/// From the mode's start to the first output of the fusion (assumed: a few of its periods).
const FIRST_OUTPUT: Cycles = ms(50);
/// Time for which it holds the clock low before a byte whose data it has to fetch (assumed; the data sheet gives no time).
const STRETCH: Cycles = CYCLES_PER_SECOND / 100_000;

const CONFIG: u8 = 0x00;
/// IMUPLUS 0x08 … NDOF 0x0C.
const FUSION: std::ops::RangeInclusive<u8> = 0x08..=0x0C;

const fn ms(count: u64) -> Cycles {
    count * CYCLES_PER_SECOND / 1000
}

/// One unit.
#[derive(Debug, Clone)]
pub struct Bno055 {
    /// Time from which it answers.
    answers_from: Cycles,
    mode: u8,
    /// The requested mode, and the time at which it begins.
    switching: Option<(u8, Cycles)>,
    mode_began: Cycles,
    registers: Registers,
    fusion: Fusion,
    /// The register that is read or written next.
    pointer: u8,
    /// True if the next byte written is the register's address.
    expects_pointer: bool,
    /// True if the clock is to be held low before the next byte.
    fetches: bool,
}

impl Bno055 {
    /// Power comes on at `now`.
    pub fn powered(now: Cycles) -> Self {
        Self {
            answers_from: now + POWER_ON,
            mode: CONFIG,
            switching: None,
            mode_began: now,
            registers: Registers::new(),
            fusion: Fusion::default(),
            pointer: 0,
            expects_pointer: false,
            fetches: false,
        }
    }

    /// True if it acknowledges its address.
    pub fn answers(&self, now: Cycles) -> bool {
        now >= self.answers_from
    }

    /// Handles its address; `orientation` is the present orientation of its mount.
    pub fn start(&mut self, read: bool, orientation: [i16; 4], now: Cycles) {
        self.complete_switching(now);
        self.expects_pointer = !read;
        self.fetches = read;
        if read {
            let valid = FUSION.contains(&self.mode) && now >= self.mode_began + FIRST_OUTPUT;
            let output = valid.then(|| self.fusion.output(orientation));
            self.registers.sample(self.mode, output, gravity(orientation), self.mode != CONFIG);
        }
    }

    /// Receives a byte: the register's address, then data for it and those that follow.
    pub fn write(&mut self, byte: u8, now: Cycles) {
        self.complete_switching(now);
        if self.expects_pointer {
            self.pointer = byte;
            self.expects_pointer = false;
            return;
        }
        match (self.registers.page(), self.pointer) {
            (0, registers::OPR_MODE) => self.switch_to(byte & 0x0F, now),
            (0, registers::SYS_TRIGGER) if byte & registers::RST_SYS != 0 => self.restart(now + RESET),
            _ => self.registers.write(self.pointer, byte, self.mode == CONFIG),
        }
        self.pointer = self.pointer.wrapping_add(1);
    }

    /// The next register.
    pub fn read(&mut self) -> u8 {
        let value = self.registers.read(self.pointer);
        self.pointer = self.pointer.wrapping_add(1);
        value
    }

    /// Time for which it holds the clock low before the next byte.
    pub fn stretch(&mut self) -> Cycles {
        if std::mem::take(&mut self.fetches) { STRETCH } else { 0 }
    }

    /// Power returns at `now`, after it was lost: it boots.
    pub fn power_returns(&mut self, now: Cycles) {
        self.restart(now + POWER_ON);
    }

    /// A power-on reset at `now` (data sheet 3.2).
    pub fn power_on_reset(&mut self, now: Cycles) {
        self.restart(now + RESET);
    }

    /// A dip of the supply that is too short for a power-on reset: it is in CONFIG again, with all its settings lost.
    pub fn brown_out(&mut self, now: Cycles) {
        self.restart(now);
    }

    /// Loses all but the zero of the heading, which is another one as soon as it has had one.
    fn restart(&mut self, answers_from: Cycles) {
        let mut fusion = std::mem::take(&mut self.fusion);
        fusion.begin_again();
        *self = Self { answers_from, mode_began: answers_from, fusion, ..Self::powered(0) };
    }

    fn switch_to(&mut self, mode: u8, now: Cycles) {
        if mode == self.mode || mode > *FUSION.end() {
            return;
        }
        let duration = match (self.mode, mode) {
            (CONFIG, _) => FROM_CONFIG,
            (_, CONFIG) => TO_CONFIG,
            _ => TO_CONFIG + FROM_CONFIG,
        };
        self.switching = Some((mode, now + duration));
    }

    /// Completes a change of the mode that is due.
    fn complete_switching(&mut self, now: Cycles) {
        if let Some((mode, at)) = self.switching.take_if(|(_, at)| *at <= now) {
            if FUSION.contains(&self.mode) {
                self.fusion.begin_again();
            }
            self.mode = mode;
            self.mode_began = at;
        }
    }
}

#[cfg(test)]
mod tests;
