//! Wrong poses, row by row, with a delay of one row: exact zeros, single rows, places that the arm cannot have, exchanged
//! names, and repeats.
//!
//! Each segment's end is compared with constant curvature in the frame of its start. This residual hardly depends on how fast
//! the arm moves; even in contact it changes little from row to row.

use calibration_tables::{ArmFile, MAX_SEGMENTS};
use nalgebra::Vector2;
use proprio_session::Truth;

use super::fault::{Fault, FaultKind};
use super::holds::Holds;
use super::links::{BASE, Chain, Links, distance, wrapped};
use super::row::TruthRow;
use super::usual::Usual;

/// Least change of the residual in a single row, as a share of the segment's length.
const JUMP: f64 = 0.1;
/// Largest difference of the rows before and after it, as a share of the change.
const RETURN: f64 = 0.5;
/// Residual that the arm cannot have, as a share of the segment's length, off the usual one.
const MISPLACED: f64 = 0.3;
/// Distance of two neighbouring ends that the arm cannot have, in lengths of the segment.
const TOO_FAR: f64 = 1.15;
/// Both limits grow with the noise, of which they are this multiple at least.
const NOISE: f64 = 8.0;
/// Weight of a row in the mean of the noise.
const NOISE_WEIGHT: f64 = 0.02;

/// A link of two ends that cannot both be right: indices of the segments, `None` for the base.
#[derive(Debug, Clone, Copy)]
struct Suspects {
    from: Option<usize>,
    to: usize,
    /// The rows before and after agree without it.
    is_jump: bool,
    /// The arm cannot have it.
    is_misplaced: bool,
}

/// True end of each segment less the expected one, in the frame of the segment's start, m; `None` without the poses.
type Residuals = [Option<Vector2<f64>>; MAX_SEGMENTS];

/// A row with its links.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinkedRow {
    pub row: TruthRow,
    pub links: Links,
}

/// The judge.
#[derive(Debug, Clone)]
pub(super) struct Judge {
    chain: Chain,
    usual: Usual,
    is_usual_known: bool,
    /// Rows that wait until the usual values are known.
    waiting: Vec<TruthRow>,
    current: Option<LinkedRow>,
    /// Residuals of the last good row.
    residuals: Residuals,
    /// Mean change of the residuals from row to row, m.
    noise: [f64; MAX_SEGMENTS],
    good: [Option<Truth>; MAX_SEGMENTS],
    /// Segments whose pose in the row before was wrong.
    was_wrong: [bool; MAX_SEGMENTS],
    holds: Holds,
}

impl Judge {
    pub fn new(arm: &ArmFile) -> Self {
        let chain = Chain::new(arm);
        Self {
            holds: Holds::new(&chain.lengths),
            usual: Usual::new(),
            is_usual_known: false,
            waiting: Vec::new(),
            current: None,
            residuals: [None; MAX_SEGMENTS],
            noise: [0.0; MAX_SEGMENTS],
            good: [None; MAX_SEGMENTS],
            was_wrong: [false; MAX_SEGMENTS],
            chain,
        }
    }

    /// Adds a row. Adds the faults that are found to `faults`, and the earlier rows without their wrong poses to `judged`.
    pub fn update(&mut self, mut row: TruthRow, faults: &mut Vec<Fault>, judged: &mut Vec<LinkedRow>) {
        take_zeros(&mut row, self.chain.count(), faults);
        if self.is_usual_known {
            self.advance(&row, faults, judged);
            return;
        }
        self.waiting.push(row);
        if Usual::is_enough(&self.waiting) {
            self.judge_waiting(faults, judged);
        }
    }

    /// Judges the last rows.
    pub fn finish(&mut self, faults: &mut Vec<Fault>, judged: &mut Vec<LinkedRow>) {
        self.judge_waiting(faults, judged);
        if let Some(last) = self.current.take() {
            self.judge(last, None, faults, judged);
        }
        self.holds.finish(faults);
    }

    fn judge_waiting(&mut self, faults: &mut Vec<Fault>, judged: &mut Vec<LinkedRow>) {
        if !self.waiting.is_empty() {
            self.usual = Usual::of(&self.waiting, &self.chain);
            self.is_usual_known = true;
            self.noise = std::array::from_fn(|i| self.usual.change(i));
        }
        for row in &std::mem::take(&mut self.waiting) {
            self.advance(row, faults, judged);
        }
    }

    fn advance(&mut self, next: &TruthRow, faults: &mut Vec<Fault>, judged: &mut Vec<LinkedRow>) {
        let links = self.chain.links(&next.poses);
        if let Some(current) = self.current.replace(LinkedRow { row: *next, links }) {
            let of_next = self.residuals(&links);
            self.judge(current, Some(&of_next), faults, judged);
        }
    }

    fn judge(
        &mut self,
        LinkedRow { mut row, mut links }: LinkedRow,
        next: Option<&Residuals>,
        faults: &mut Vec<Fault>,
        judged: &mut Vec<LinkedRow>,
    ) {
        let original = row;
        let mut own = self.residuals(&links);
        let suspects = self.suspects(&row, &own, next);
        if !suspects.is_empty() {
            self.blame(&mut row, next, &suspects, faults);
            links = self.chain.links(&row.poses);
            own = self.residuals(&links);
        }
        self.holds.update(&original, self.usual.scale, faults);
        for (i, residual) in own.into_iter().enumerate().take(self.chain.count()) {
            self.was_wrong[i] = original.poses[i].is_some() && row.poses[i].is_none();
            self.good[i] = row.poses[i].or(self.good[i]);
            let Some(residual) = residual else { continue };
            if let Some(last) = self.residuals[i].replace(residual) {
                let change = (residual - last).norm().min(JUMP * self.length(i));
                self.noise[i] += NOISE_WEIGHT * (change - self.noise[i]);
            }
        }
        judged.push(LinkedRow { row, links });
    }

    /// Length of a segment with its connector in the truth's own unit.
    fn length(&self, i: usize) -> f64 {
        self.chain.lengths[i] * self.usual.scale
    }

    fn residuals(&self, links: &Links) -> Residuals {
        links.map(|link| link.map(|link| link.end - link.expected * self.usual.scale))
    }

    fn residuals_of(&self, row: &TruthRow) -> Residuals {
        self.residuals(&self.chain.links(&row.poses))
    }

    /// Links of a row that cannot be right.
    fn suspects(&self, row: &TruthRow, own: &Residuals, next: Option<&Residuals>) -> Vec<Suspects> {
        let mut suspects = Vec::new();
        let mut last = None;
        for to in (0..self.chain.count()).filter(|i| row.poses[*i].is_some()) {
            let from = last.replace(to);
            let is_jump = from.map_or(0, |from| from + 1) == to && self.is_jump(to, own, next);
            let is_misplaced = self.is_misplaced(from, to, &row.poses, own);
            if is_jump || is_misplaced {
                suspects.push(Suspects { from, to, is_jump, is_misplaced });
            }
        }
        suspects
    }

    fn is_misplaced(
        &self,
        from: Option<usize>,
        to: usize,
        poses: &[Option<Truth>; MAX_SEGMENTS],
        own: &Residuals,
    ) -> bool {
        let start = from.map_or(Some(BASE), |from| poses[from]);
        let Some((start, end)) = start.zip(poses[to]) else { return false };
        let first = from.map_or(0, |from| from + 1);
        let length: f64 = (first..=to).map(|i| self.length(i)).sum();
        let usual = self.usual.residual(to);
        let margin = NOISE * self.noise[to];
        if distance(&start, &end) > TOO_FAR * length + usual.norm() + margin {
            return true;
        }
        let residual = own[to].filter(|_| first == to);
        residual.is_some_and(|residual| (residual - usual).norm() > (MISPLACED * length).max(margin))
    }

    fn is_jump(&self, i: usize, own: &Residuals, next: Option<&Residuals>) -> bool {
        let of_next = next.and_then(|next| next[i]);
        let Some(((own, before), after)) = own[i].zip(self.residuals[i]).zip(of_next) else {
            return false;
        };
        let change = (own - before).norm().min((own - after).norm());
        change > (JUMP * self.length(i)).max(NOISE * self.noise[i]) && (after - before).norm() < RETURN * change
    }

    /// Takes the poses out of a row that make its links impossible.
    fn blame(&mut self, row: &mut TruthRow, next: Option<&Residuals>, suspects: &[Suspects], faults: &mut Vec<Fault>) {
        if suspects.iter().any(|suspects| suspects.is_misplaced)
            && let Some([one, other]) = self.exchanged(row)
        {
            for (segment, of) in [(one, other), (other, one)] {
                faults.push(Fault { segment, rows: row.rows(), kind: FaultKind::Exchanged(of) });
                row.poses[segment] = None;
            }
            return;
        }
        let original = *row;
        let mut left = suspects.to_vec();
        while let Some((segment, is_jump)) = self.worst(row, &left) {
            row.poses[segment] = None;
            if (!is_jump || self.was_wrong[segment]) && self.holds.is_repeated(segment, &original) {
                self.holds.confirm(segment);
            } else {
                let is_single = is_jump && !self.was_wrong[segment];
                let kind = if is_single { FaultKind::Jump } else { FaultKind::Misplaced };
                faults.push(Fault { segment, rows: row.rows(), kind });
            }
            left = self.suspects(row, &self.residuals_of(row), next);
        }
    }

    /// The segment that is in most of the links, and true where its links are jumps. Among equals it is one that is repeated,
    /// then one that has no possible link, then the one that is furthest from its last good pose.
    fn worst(&self, row: &TruthRow, suspects: &[Suspects]) -> Option<(usize, bool)> {
        let of = |i: usize| suspects.iter().filter(move |link| link.to == i || link.from == Some(i));
        let is_jump = |i: usize| of(i).any(|link| link.is_jump);
        let links = |i: usize| 1 + usize::from(row.poses[i + 1..].iter().any(Option::is_some));
        let moved = |i: usize| {
            let (pose, good) = row.poses[i].zip(self.good[i])?;
            let turn = pose.heading_rad.zip(good.heading_rad).map_or(0.0, |(to, from)| wrapped(to - from));
            Some(distance(&pose, &good) + self.length(i) * turn.abs())
        };
        let rank = |i: &usize| {
            let count = of(*i).count();
            let is_repeated = !is_jump(*i) && self.holds.is_repeated(*i, row);
            ((count, is_repeated, std::cmp::Reverse(links(*i) - count)), moved(*i).unwrap_or(0.0))
        };
        let suspected = (0..self.chain.count()).filter(|i| of(*i).count() > 0);
        let worst = suspected.max_by(|a, b| {
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })?;
        Some((worst, is_jump(worst)))
    }

    /// Two segments whose exchange makes all links of a row possible.
    fn exchanged(&self, row: &TruthRow) -> Option<[usize; 2]> {
        let n = self.chain.count();
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j]));
        let is_possible = |[i, j]: &[usize; 2]| {
            let mut swapped = *row;
            swapped.poses.swap(*i, *j);
            row.poses[*i].is_some()
                && row.poses[*j].is_some()
                && self.suspects(&swapped, &self.residuals_of(&swapped), None).is_empty()
        };
        pairs.into_iter().find(is_possible)
    }
}

/// Takes exact zeros out of a row: no segment's end is at the base.
fn take_zeros(row: &mut TruthRow, segments: usize, faults: &mut Vec<Fault>) {
    let rows = row.rows();
    for (segment, pose) in row.poses.iter_mut().enumerate().take(segments) {
        if pose.is_some_and(|pose| pose.x_m == 0.0 && pose.y_m == 0.0) {
            *pose = None;
            faults.push(Fault { segment, rows, kind: FaultKind::Zeros });
        }
    }
}
