//! Faults of a serial line.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rig_twin::Fault;
use sam3x_models::model::{CYCLES_PER_SECOND, Cycles};

/// The present faults of a line, with what they hold back.
#[derive(Debug, Clone)]
pub struct LineFaults {
    noise_share: f64,
    is_flooded: bool,
    is_cut: bool,
    replay: Option<Cycles>,
    is_reordered: bool,
    /// The begin of a frame to the board, of a reordered line.
    partial: Vec<u8>,
    /// A frame that waits for the next one, of a reordered line.
    held: Option<Vec<u8>>,
    random: ChaCha8Rng,
}

impl LineFaults {
    /// None; `seed` is that of faults at random.
    pub fn new(seed: u64) -> Self {
        Self {
            noise_share: 0.0,
            is_flooded: false,
            is_cut: false,
            replay: None,
            is_reordered: false,
            partial: Vec::new(),
            held: None,
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// Sets or ends a fault; false if it is another device's.
    pub fn set(&mut self, fault: Fault, is_present: bool) -> bool {
        match fault {
            Fault::LineNoise(share) => self.noise_share = if is_present { share } else { 0.0 },
            Fault::LineFlood => self.is_flooded = is_present,
            Fault::LineCut => self.is_cut = is_present,
            Fault::LineReplay(seconds) => {
                self.replay = is_present.then_some((seconds * CYCLES_PER_SECOND as f64) as Cycles);
            }
            Fault::LineReorder => self.is_reordered = is_present,
            _ => return false,
        }
        true
    }

    /// A byte that comes out of the line; `None` if it is lost.
    pub fn pass(&mut self, byte: u8) -> Option<u8> {
        if self.is_cut {
            return None;
        }
        let is_hit =
            self.noise_share > 0.0 && f64::from(self.random.next_u32()) < self.noise_share * f64::from(u32::MAX);
        Some(if is_hit { byte ^ 1 << (self.random.next_u32() % 8) } else { byte })
    }

    /// A byte that nobody sent.
    pub fn flood(&mut self) -> Option<u8> {
        self.is_flooded.then(|| self.random.next_u32() as u8)
    }

    /// Time after which bytes to the board arrive again.
    pub fn replay_after(&self) -> Option<Cycles> {
        self.replay
    }

    /// Bytes to the board in the order in which they leave.
    pub fn reorder(&mut self, bytes: &[u8]) -> Vec<u8> {
        if !self.is_reordered {
            let waiting = self.held.take().into_iter().flatten().chain(std::mem::take(&mut self.partial));
            return waiting.chain(bytes.iter().copied()).collect();
        }
        let mut out = Vec::new();
        for byte in bytes {
            self.partial.push(*byte);
            if *byte == 0 {
                let frame = std::mem::take(&mut self.partial);
                match self.held.take() {
                    // A zero alone is no frame.
                    held if frame.len() == 1 => {
                        self.held = held;
                        out.extend(frame);
                    }
                    Some(held) => out.extend(frame.into_iter().chain(held)),
                    None => self.held = Some(frame),
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::LineFaults;
    use rig_twin::Fault;

    fn with(fault: &str) -> LineFaults {
        let mut faults = LineFaults::new(1);
        assert!(faults.set(fault.parse::<Fault>().expect("a fault"), true));
        faults
    }

    #[test]
    fn noise_flips_a_bit_in_its_share_of_the_bytes() {
        let mut faults = with("line:noise=0.1");
        let flipped = (0..10_000).filter_map(|_| faults.pass(0x55)).filter(|byte| *byte != 0x55);
        let flipped: Vec<u8> = flipped.collect();
        assert!((800..1200).contains(&flipped.len()), "{}", flipped.len());
        assert!(flipped.iter().all(|byte| (byte ^ 0x55).is_power_of_two()));
    }

    #[test]
    fn every_two_frames_are_exchanged_and_none_is_lost() {
        let mut faults = with("line:reorder");
        assert_eq!(faults.reorder(b"\0ab\0c"), b"\0");
        assert_eq!(faults.reorder(b"d\0ef\0"), b"cd\0ab\0");
        faults.set(Fault::LineReorder, false);
        assert_eq!(faults.reorder(b"gh\0"), b"ef\0gh\0");
    }

    #[test]
    fn nothing_comes_out_of_a_line_that_is_cut() {
        assert_eq!(with("line:cut").pass(1), None);
    }
}
