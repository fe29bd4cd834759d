//! Counts boots and crashes over resets, and stops a boot loop.
//!
//! A few words outlive a reset, but not a loss of power: the chip's general-purpose backup registers (datasheet,
//! SYS_GPBR), or memory that start-up leaves alone. The firmware hands them in at boot, writes back what
//! [`Boots::words`] gives, and from then on keeps the one word [`UPTIME_WORD`] up to date. Since that is a single word
//! and the check word does not cover it, a reset at any moment after boot finds the words whole.
//!
//! A crash is a reset by the watchdog, or any reset after a panic or fault. [`CRASHES`] of them within the last
//! [`WINDOW_TICKS`] of uptime, which goes on counting over resets, make a boot loop: the board comes up in safe mode.
//! Another reset does not lead out of it, since a host that opens the port to look resets the board, too; a reset once
//! that time is over does, and power-on.

use telemetry::ResetCause;

/// Words that outlive a reset.
pub const WORDS: usize = 7;

/// Which of the words is the uptime.
pub const UPTIME_WORD: usize = WORDS - 1;

/// Crashes that make a boot loop.
pub const CRASHES: usize = 3;

/// Uptime within which they make one, in ticks of 10 ms: 60 s.
pub const WINDOW_TICKS: u32 = 6000;

/// This boot, and those before it since power-on.
///
/// ```
/// use board_core::{Boots, UPTIME_WORD, WORDS};
/// use telemetry::ResetCause;
///
/// let first = Boots::start([0; WORDS], ResetCause::PowerOn, false);
/// let mut kept = first.words();
/// kept[UPTIME_WORD] = first.uptime(500); // 5 s later
/// let second = Boots::start(kept, ResetCause::Watchdog, false);
/// assert_eq!((second.number(), second.crashes(), second.safe_mode()), (2, 1, false));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Boots {
    number: u32,
    crashes: u32,
    /// Uptime at the last crashes, newest first, ticks.
    crashed_at: [u32; CRASHES],
    /// Uptime before this boot, ticks.
    uptime_before: u32,
}

impl Boots {
    /// A boot, with the words found, what started it, and whether a panic or fault was recorded before it.
    ///
    /// Words that the power-on left to chance, or that somebody else wrote, do not fit their check word; they are no
    /// error, and the count starts anew.
    pub fn start(kept: [u32; WORDS], cause: ResetCause, panicked: bool) -> Self {
        let [check, covered @ .., uptime_before] = kept;
        if cause == ResetCause::PowerOn || check != check_word(&covered) {
            return Self { number: 1, crashes: 0, crashed_at: [0; CRASHES], uptime_before: 0 };
        }
        let [number, crashes, crashed_at @ ..] = covered;
        let same = Self { number: number.saturating_add(1), crashes, crashed_at, uptime_before };
        if cause == ResetCause::Watchdog || panicked { same.crashed() } else { same }
    }

    /// The same boot, known to follow a crash.
    fn crashed(self) -> Self {
        let [last, before_last, _] = self.crashed_at;
        let crashed_at = [self.uptime_before, last, before_last];
        Self { crashes: self.crashes.saturating_add(1), crashed_at, ..self }
    }

    /// Number of this boot since power-on, from 1.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Crashes since power-on.
    pub fn crashes(&self) -> u32 {
        self.crashes
    }

    /// Whether the board is in a boot loop: it must not move the arm, but may say so. The same for the whole boot.
    pub fn safe_mode(&self) -> bool {
        let [.., first] = self.crashed_at;
        self.crashes >= CRASHES as u32 && self.uptime_before.wrapping_sub(first) <= WINDOW_TICKS
    }

    /// The words to keep, to be written once at boot.
    pub fn words(&self) -> [u32; WORDS] {
        let [last, before_last, first] = self.crashed_at;
        let covered = [self.number, self.crashes, last, before_last, first];
        [check_word(&covered), self.number, self.crashes, last, before_last, first, self.uptime_before]
    }

    /// What the word [`UPTIME_WORD`] must be from this tick on: ticks since power-on. A crash is as old as the last
    /// one written.
    pub fn uptime(&self, tick: u32) -> u32 {
        self.uptime_before.wrapping_add(tick)
    }
}

/// FNV-1a over whole words: each single word that differs makes another check word, and zeros do not check as 0.
fn check_word(words: &[u32]) -> u32 {
    words.iter().fold(0x811c_9dc5, |hash, word| (hash ^ word).wrapping_mul(0x0100_0193))
}
