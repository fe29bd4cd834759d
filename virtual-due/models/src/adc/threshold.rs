//! The comparison window (datasheet 43.6.9).

use super::fields::CompareMode;

/// Counts how many results in a row passed.
#[derive(Debug, Clone, Default)]
pub struct Threshold {
    in_a_row: u32,
}

impl Threshold {
    /// True if this result raises COMPE: it is the (CMPFILTER + 1)th in a row that meets CMPMODE's condition.
    pub fn passes(&mut self, channel: u8, result: u16, compare: CompareMode) -> bool {
        let all_channels = compare.extended & (1 << 9) != 0;
        let selected = (compare.extended >> 4) & 15;
        if !all_channels && selected != u32::from(channel) {
            return false;
        }
        let result = u32::from(result);
        let low = compare.window & 0xFFF;
        let high = (compare.window >> 16) & 0xFFF;
        let inside = (low..=high).contains(&result);
        let passes = match compare.extended & 3 {
            0 => result < low,
            1 => result > high,
            2 => inside,
            _ => !inside,
        };
        self.in_a_row = if passes { self.in_a_row + 1 } else { 0 };
        let raises = self.in_a_row > (compare.extended >> 12) & 3;
        if raises {
            self.in_a_row = 0;
        }
        raises
    }
}
