//! The board's time: the sum of instructions and sleep.

use sam3x_models::model::{CYCLES_PER_SECOND, Cycles};

/// Time is kept in fifths of a cycle of 84 MHz, and an instruction is worth seven fifths of a core cycle: 1.4 cycles,
/// the mean of Cortex-M3 code from the Due's flash. At 84 MHz no rounding exists.
const FIFTHS: u64 = 5;
const FIFTHS_PER_INSTRUCTION: u64 = 7;

/// Maps instructions to board time and to the core's own cycles, for any core frequency.
#[derive(Debug, Clone)]
pub struct Clock {
    hz: u32,
    // Instructions are counted from here, at this board time.
    instructions: u64,
    fifths: u64,
    // When the core frequency last changed: board and core time then.
    changed: u64,
    core: u64,
}

impl Clock {
    /// Time zero.
    pub fn new(hz: u32) -> Self {
        Self { hz, instructions: 0, fifths: 0, changed: 0, core: 0 }
    }

    /// Board time with `instructions` retired.
    pub fn now(&self, instructions: u64) -> Cycles {
        self.fifths(instructions) / FIFTHS
    }

    /// Core cycles with `instructions` retired.
    pub fn core_cycles(&self, instructions: u64) -> u64 {
        self.core_fifths(self.fifths(instructions)) / FIFTHS
    }

    /// Board time of a future count of core cycles: the first cycle at which it is reached.
    pub fn at_core_cycles(&self, core_cycles: u64) -> Cycles {
        let ahead = (core_cycles * FIFTHS).saturating_sub(self.core);
        (self.changed + scale_up(ahead, CYCLES_PER_SECOND, self.hz.into())).div_ceil(FIFTHS)
    }

    /// Number of instructions after `instructions` until the board time is `then` or later.
    pub fn instructions_until(&self, instructions: u64, then: Cycles) -> u64 {
        let ahead = (then * FIFTHS).saturating_sub(self.fifths);
        let total = scale_up(ahead, self.hz.into(), CYCLES_PER_SECOND).div_ceil(FIFTHS_PER_INSTRUCTION);
        total.saturating_sub(instructions - self.instructions)
    }

    /// Lets the core sleep until `then`, with `instructions` retired.
    pub fn sleep_until(&mut self, instructions: u64, then: Cycles) {
        let then = then * FIFTHS;
        if then > self.fifths(instructions) {
            self.fifths = then;
            self.instructions = instructions;
        }
    }

    /// Sets the core's frequency from now on, Hz.
    pub fn set_hz(&mut self, instructions: u64, hz: u32) {
        let now = self.fifths(instructions);
        self.core = self.core_fifths(now);
        self.changed = now;
        self.fifths = now;
        self.instructions = instructions;
        self.hz = hz;
    }

    fn fifths(&self, instructions: u64) -> u64 {
        let core = (instructions - self.instructions) * FIFTHS_PER_INSTRUCTION;
        self.fifths + scale(core, CYCLES_PER_SECOND, self.hz.into())
    }

    fn core_fifths(&self, fifths: u64) -> u64 {
        self.core + scale(fifths - self.changed, self.hz.into(), CYCLES_PER_SECOND)
    }
}

/// value · to / from, rounded down.
fn scale(value: u64, to: u64, from: u64) -> u64 {
    if to == from {
        return value;
    }
    (u128::from(value) * u128::from(to) / u128::from(from)) as u64
}

/// value · to / from, rounded up.
fn scale_up(value: u64, to: u64, from: u64) -> u64 {
    if to == from {
        return value;
    }
    (u128::from(value) * u128::from(to)).div_ceil(u128::from(from)) as u64
}

#[cfg(test)]
mod tests {
    use super::Clock;

    #[test]
    fn an_instruction_takes_seven_fifths_of_a_core_cycle() {
        assert_eq!(Clock::new(84_000_000).now(5), 7);
        assert_eq!(Clock::new(12_000_000).now(5), 49);
    }

    #[test]
    fn an_instant_is_reached_after_its_number_of_instructions() {
        for hz in [84_000_000, 12_000_000, 32_768, 4_000_000] {
            let mut clock = Clock::new(84_000_000);
            clock.set_hz(3, hz);
            for then in [5, 1000, 123_456_789] {
                let count = clock.instructions_until(10, then);
                assert!(clock.now(10 + count) >= then, "{hz} {then}");
                assert!(count == 0 || clock.now(10 + count - 1) < then, "{hz} {then}");
            }
        }
    }

    #[test]
    fn sleep_in_two_pieces_is_sleep_in_one() {
        let mut one = Clock::new(4_000_000);
        let mut two = one.clone();
        one.sleep_until(11, 1_000_003);
        two.sleep_until(11, 555_557);
        two.sleep_until(11, 1_000_003);
        assert_eq!((one.now(99), one.core_cycles(99)), (two.now(99), two.core_cycles(99)));
    }

    #[test]
    fn core_cycles_continue_at_the_new_frequency() {
        let mut clock = Clock::new(84_000_000);
        clock.sleep_until(0, 84_000);
        clock.set_hz(0, 12_000_000);
        clock.sleep_until(0, 168_000);
        assert_eq!(clock.core_cycles(0), 84_000 + 12_000);
        assert_eq!(clock.at_core_cycles(84_000 + 24_000), 252_000);
    }
}
