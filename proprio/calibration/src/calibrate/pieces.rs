//! Pieces of a sweep: a wire is exchanged in all of them or it is not, so that their median decides about wires and mounts.

use std::ops::Range;

use super::statistics::quantile;
use super::sweep::LEAST_ROWS;

/// Largest number of pieces.
const MOST: usize = 15;
/// Least motion of a piece, as a share of that of the piece with the most: a segment may rest while others are swept.
const LEAST_MOTION: f64 = 0.25;

/// Rows of the pieces of a sweep, each twice as long as a fit needs where the sweep is long enough.
pub(super) fn pieces(rows: usize) -> impl Iterator<Item = Range<usize>> {
    let count = (rows / (2 * LEAST_ROWS)).clamp(1, MOST);
    (0..count).map(move |piece| piece * rows / count..(piece + 1) * rows / count)
}

/// The pieces in which a value moves, by the range of its middle half.
pub(super) fn moving(values: &[Option<f64>]) -> Vec<Range<usize>> {
    let spread = |rows: &Range<usize>| {
        let mut known: Vec<f64> = values[rows.clone()].iter().flatten().copied().collect();
        known.sort_unstable_by(f64::total_cmp);
        quantile(&known, 0.75) - quantile(&known, 0.25)
    };
    let all: Vec<(Range<usize>, f64)> = pieces(values.len()).map(|rows| (rows.clone(), spread(&rows))).collect();
    let most = all.iter().map(|(_, spread)| *spread).fold(0.0, f64::max);
    all.into_iter().filter(|(_, spread)| *spread >= LEAST_MOTION * most).map(|(rows, _)| rows).collect()
}

/// The median over pieces; `None` where no piece has a value.
pub(super) fn median(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let mut known: Vec<f64> = values.flatten().collect();
    known.sort_unstable_by(f64::total_cmp);
    (!known.is_empty()).then(|| quantile(&known, 0.5))
}

#[cfg(test)]
mod tests {
    use super::{moving, pieces};

    #[test]
    fn pieces_cover_all_rows_once_and_none_is_too_short() {
        for rows in [60, 199, 1000, 6001] {
            let all: Vec<usize> = pieces(rows).flatten().collect();
            assert_eq!(all, (0..rows).collect::<Vec<_>>());
            assert!(pieces(rows).all(|piece| piece.len() >= 60), "{rows}");
        }
    }

    /// A value that rests for the first half, with one wild reading.
    #[test]
    fn a_piece_at_rest_is_left_out_in_spite_of_a_wild_reading() {
        let swing = |row: usize| if row < 1500 { 0.0 } else { libm::sin(row as f64 * 0.05) };
        let mut values: Vec<Option<f64>> = (0..3000).map(|row| Some(swing(row))).collect();
        values[700] = Some(30.0);
        let first: Vec<usize> = moving(&values).iter().map(|rows| rows.start).collect();
        assert!(first.iter().all(|start| *start >= 1400), "{first:?}");
        assert_eq!(first.iter().filter(|start| **start >= 1600).count(), 7, "{first:?}");
    }
}
