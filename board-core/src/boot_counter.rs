//! Counter of boots and crashes across resets, which detects a boot loop.
//!
//! A few words are retained over a reset, but not over a loss of power: the chip's general-purpose backup registers
//! (datasheet, SYS_GPBR), or memory that start-up does not initialise. The firmware passes them in at boot, writes back
//! [`BootCounter::retained`], and then updates the one word [`UPTIME_WORD`] every tick. Since that is a single word and
//! the check word does not cover it, the words are valid after a reset at any moment after boot.
//!
//! A crash is a reset by the watchdog, or any reset after a panic or fault. [`CRASHES`] of them within the last
//! [`WINDOW_TICKS`] of uptime, which is counted across resets, are a boot loop: the board starts in safe mode. Another
//! reset does not end it, since a host that opens the port resets the board, too; a reset after that time does, and
//! power-on. If all three came before the first tick, the table in the flash is not used either.

use telemetry::ResetCause;

/// Words that are retained over a reset.
pub const RETAINED_WORDS: usize = 7;

/// Index of the uptime among the words.
pub const UPTIME_WORD: usize = RETAINED_WORDS - 1;

/// Crashes of a boot loop.
pub const CRASHES: usize = 3;

/// Uptime within which they are a boot loop, in ticks of 10 ms: 60 s.
pub const WINDOW_TICKS: u32 = 6000;

/// Number of this boot since power-on, and the crashes before it.
///
/// ```
/// use board_core::{BootCounter, RETAINED_WORDS, UPTIME_WORD};
/// use telemetry::ResetCause;
///
/// let first = BootCounter::start([0; RETAINED_WORDS], ResetCause::PowerOn, false);
/// let mut retained = first.retained();
/// retained[UPTIME_WORD] = first.uptime(500); // 5 s later
/// let second = BootCounter::start(retained, ResetCause::Watchdog, false);
/// assert_eq!((second.number(), second.crashes(), second.safe_mode()), (2, 1, false));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct BootCounter {
    number: u32,
    crashes: u32,
    /// Uptime at the last crashes, latest first, ticks.
    crash_uptimes: [u32; CRASHES],
    /// Uptime before this boot, ticks.
    uptime_before: u32,
}

impl BootCounter {
    /// Counts a boot from the retained words, the cause of the reset, and whether a panic or fault was recorded before
    /// it.
    ///
    /// Random words after power-on, or those of other firmware, do not match their check word; they are no error, and
    /// the count restarts.
    pub fn start(retained: [u32; RETAINED_WORDS], cause: ResetCause, panicked: bool) -> Self {
        let [check, covered @ .., uptime_before] = retained;
        if cause == ResetCause::PowerOn || check != check_word(&covered) {
            return Self { number: 1, crashes: 0, crash_uptimes: [0; CRASHES], uptime_before: 0 };
        }
        let [number, crashes, crash_uptimes @ ..] = covered;
        let same = Self { number: number.saturating_add(1), crashes, crash_uptimes, uptime_before };
        if cause == ResetCause::Watchdog || panicked { same.crashed() } else { same }
    }

    /// Adds a crash just before this boot.
    fn crashed(self) -> Self {
        let [last, before_last, _] = self.crash_uptimes;
        let crash_uptimes = [self.uptime_before, last, before_last];
        Self { crashes: self.crashes.saturating_add(1), crash_uptimes, ..self }
    }

    /// Number of this boot since power-on, from 1.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Crashes since power-on.
    pub fn crashes(&self) -> u32 {
        self.crashes
    }

    /// Returns whether the board is in a boot loop and must not move the arm. Constant for the whole boot.
    pub fn safe_mode(&self) -> bool {
        let [.., first] = self.crash_uptimes;
        self.crashes >= CRASHES as u32 && self.uptime_before.wrapping_sub(first) <= WINDOW_TICKS
    }

    /// Returns whether the boot loop's crashes all came before the first tick: the board must start without what may be
    /// their cause.
    pub fn fails_to_start(&self) -> bool {
        self.safe_mode() && self.crash_uptimes.iter().all(|uptime| *uptime == self.uptime_before)
    }

    /// Words to retain, written once at boot.
    pub fn retained(&self) -> [u32; RETAINED_WORDS] {
        let [last, before_last, first] = self.crash_uptimes;
        let covered = [self.number, self.crashes, last, before_last, first];
        [check_word(&covered), self.number, self.crashes, last, before_last, first, self.uptime_before]
    }

    /// Value of the word [`UPTIME_WORD`] from this tick on: ticks since power-on. The last one written dates a crash.
    pub fn uptime(&self, tick: u32) -> u32 {
        self.uptime_before.wrapping_add(tick)
    }
}

/// FNV-1a over whole words: any single different word gives another check word, and the check word of zeros is not 0.
fn check_word(words: &[u32]) -> u32 {
    words.iter().fold(0x811c_9dc5, |hash, word| (hash ^ word).wrapping_mul(0x0100_0193))
}
