//! The poses of a session that are left out.

use proprio_session::Row;

use super::fault::Fault;

/// Segments, one bit each, that are left out of each row.
#[derive(Debug, Clone, Default)]
pub struct LeftOut {
    segments: Vec<u16>,
}

impl LeftOut {
    /// Adds the rows of a fault.
    pub fn add(&mut self, fault: &Fault) {
        let (first, last) = (fault.rows.first as usize, fault.rows.last as usize);
        if self.segments.len() < last {
            self.segments.resize(last, 0);
        }
        for segments in &mut self.segments[first - 1..last] {
            *segments |= 1 << fault.segment;
        }
    }

    /// True where the pose of segment `i` (from 0) is left out of row `row`, from 0.
    #[must_use]
    pub fn contains(&self, row: usize, i: usize) -> bool {
        self.segments.get(row).is_some_and(|segments| segments >> i & 1 == 1)
    }

    /// The row without its wrong poses; `number` counts from 0.
    #[must_use]
    pub fn without(&self, row: &Row, number: usize) -> Row {
        let mut row = row.clone();
        for (i, truth) in row.truth.iter_mut().enumerate() {
            *truth = truth.filter(|_| !self.contains(number, i));
        }
        row
    }
}
