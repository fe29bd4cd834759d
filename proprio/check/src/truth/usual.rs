//! The scale of the truth and the usual residuals of its links, from the first rows: lengths in another unit and markers that
//! are mounted off the axis must not make every row impossible. Two markers whose numbers are exchanged from the first row on
//! are no markers off the axis.

use calibration_tables::MAX_SEGMENTS;
use nalgebra::Vector2;

use super::links::Chain;
use super::row::TruthRow;
use crate::median::median;

/// Rows with truth from which the usual values are found.
const FIRST: usize = 1000;
/// Median misfit of a link from which on two markers may be exchanged, and below which all are with the exchange, as shares of
/// the segment's length.
const IMPOSSIBLE: f64 = 0.5;
const POSSIBLE: f64 = 0.2;

/// Usual values of a session's truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Usual {
    /// The truth over the arm's lengths.
    pub scale: f64,
    links: [Link; MAX_SEGMENTS],
}

/// Usual values of a link.
#[derive(Debug, Clone, Copy, Default)]
struct Link {
    residual: Vector2<f64>,
    change: f64,
}

impl Usual {
    /// The values before any row.
    pub fn new() -> Self {
        Self { scale: 1.0, links: [Link::default(); MAX_SEGMENTS] }
    }

    /// True for rows enough to find the values.
    pub fn is_enough(rows: &[TruthRow]) -> bool {
        rows.len() >= FIRST
    }

    /// Finds the values from the first rows.
    pub fn of(rows: &[TruthRow], chain: &Chain) -> Self {
        let (as_named, misfit) = Self::with(rows, chain, None);
        if misfit < IMPOSSIBLE {
            return as_named;
        }
        let n = chain.count();
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j]));
        let exchanged = pairs.map(|pair| Self::with(rows, chain, Some(pair))).min_by(|a, b| a.1.total_cmp(&b.1));
        exchanged.filter(|(_, misfit)| *misfit < POSSIBLE).map_or(as_named, |(usual, _)| usual)
    }

    /// The values with two markers exchanged, and the largest median misfit of a link.
    fn with(rows: &[TruthRow], chain: &Chain, exchanged: Option<[usize; 2]>) -> (Self, f64) {
        let mut links: Vec<Vec<[Vector2<f64>; 2]>> = vec![Vec::new(); chain.count()];
        for row in rows {
            let mut poses = row.poses;
            if let Some([i, j]) = exchanged {
                poses.swap(i, j);
            }
            for (i, links) in links.iter_mut().enumerate() {
                links.extend(chain.link(i, &poses).map(|link| [link.end, link.expected]));
            }
        }
        let ratios = links.iter().flatten().map(|[end, expected]| end.norm() / expected.norm());
        let scale = median(ratios.collect()).filter(|scale| *scale > 0.0).unwrap_or(1.0);
        let (mut found, mut largest) = ([Link::default(); MAX_SEGMENTS], 0.0_f64);
        for ((found, links), length) in found.iter_mut().zip(&links).zip(&chain.lengths) {
            let residuals: Vec<Vector2<f64>> = links.iter().map(|[end, expected]| end - expected * scale).collect();
            let of = |axis: usize| median(residuals.iter().map(|residual| residual[axis]).collect()).unwrap_or(0.0);
            let changes = residuals.windows(2).map(|pair| (pair[1] - pair[0]).norm());
            *found = Link { residual: Vector2::new(of(0), of(1)), change: median(changes.collect()).unwrap_or(0.0) };
            let misfit = median(residuals.iter().map(Vector2::norm).collect()).unwrap_or(0.0);
            largest = largest.max(misfit / (length * scale));
        }
        (Self { scale, links: found }, largest)
    }

    /// True end of segment `i` less the expected one, in the frame of its start.
    pub fn residual(&self, i: usize) -> Vector2<f64> {
        self.links[i].residual
    }

    /// Median change of this difference from row to row, m.
    pub fn change(&self, i: usize) -> f64 {
        self.links[i].change
    }
}
