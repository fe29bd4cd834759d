//! The scale of the truth and the usual residuals of its links, from the first rows: lengths in another unit and markers that
//! are mounted off the axis must not make every row impossible.

use calibration_tables::MAX_SEGMENTS;
use nalgebra::Vector2;

use super::links::Chain;
use super::row::TruthRow;
use crate::median::median;

/// Rows with truth from which the usual values are found.
const FIRST: usize = 1000;

/// Usual values.
#[derive(Debug, Clone)]
pub(super) struct Usual {
    links: Vec<Vec<[Vector2<f64>; 2]>>,
    rows: usize,
    found: Option<(f64, [Link; MAX_SEGMENTS])>,
}

/// Usual values of a link.
#[derive(Debug, Clone, Copy, Default)]
struct Link {
    residual: Vector2<f64>,
    change: f64,
}

impl Usual {
    pub fn new() -> Self {
        Self { links: vec![Vec::new(); MAX_SEGMENTS], rows: 0, found: None }
    }

    /// True where the values are found.
    pub fn is_known(&self) -> bool {
        self.found.is_some() || self.rows >= FIRST
    }

    /// The truth over the arm's lengths.
    pub fn scale(&self) -> f64 {
        self.found.map_or(1.0, |(scale, _)| scale)
    }

    /// True end of segment `i` less the expected one, in the frame of its start.
    pub fn residual(&self, i: usize) -> Vector2<f64> {
        self.found.map_or(Vector2::zeros(), |(_, links)| links[i].residual)
    }

    /// Median change of this difference from row to row, m.
    pub fn change(&self, i: usize) -> f64 {
        self.found.map_or(0.0, |(_, links)| links[i].change)
    }

    pub fn add(&mut self, row: &TruthRow, chain: &Chain) {
        for i in 0..chain.count() {
            if let Some(link) = chain.link(i, &row.poses) {
                self.links[i].push([link.end, link.expected]);
            }
        }
        self.rows += 1;
    }

    /// Finds the values from the rows that were added.
    pub fn find(&mut self) {
        let links = std::mem::take(&mut self.links);
        let ratios = links.iter().flatten().map(|[end, expected]| end.norm() / expected.norm());
        let scale = median(ratios.collect()).filter(|scale| *scale > 0.0).unwrap_or(1.0);
        let mut found = [Link::default(); MAX_SEGMENTS];
        for (found, links) in found.iter_mut().zip(&links) {
            let residuals: Vec<Vector2<f64>> = links.iter().map(|[end, expected]| end - expected * scale).collect();
            let of = |axis: usize| median(residuals.iter().map(|residual| residual[axis]).collect()).unwrap_or(0.0);
            let changes = residuals.windows(2).map(|pair| (pair[1] - pair[0]).norm());
            *found = Link { residual: Vector2::new(of(0), of(1)), change: median(changes.collect()).unwrap_or(0.0) };
        }
        self.found = Some((scale, found));
    }
}
