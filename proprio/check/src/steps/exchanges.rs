//! Plugs that are exchanged for a part of the session: the wiring of each piece of it.

use calibration_tables::MAX_SEGMENTS;

use super::fit::{EXPLAINED, Fit, MISFIT};
use super::moments::Moments;
use super::wiring::{Fault, Wiring};
use crate::finding::{Finding, Kind, Rows, Source, is_unblamed};
use crate::frame::Frame;

/// Steps of a piece, in which a segment bends by this angle or more, deg.
const STEPS: u32 = 25;
const MOTION: f64 = 2.0;
/// Misfit below which a segment's sensors agree in a piece.
const AGREES: f64 = 0.45;
/// Least share of the misfit in a piece that an exchange explains.
const EXPLAINS: f64 = 0.6;
/// Least number of pieces with the exchange, and of those without it.
const PIECES: u32 = 2;

/// Pieces with and without the exchange of a pair.
#[derive(Debug, Clone, Copy)]
struct Pair {
    /// Segments of the two, from 0.
    segments: [usize; 2],
    are_imus: bool,
    in_order: u32,
    exchanged: u32,
    /// Share of the misfit that the exchange explains, %, summed over these pieces.
    explained: f64,
    rows: Rows,
    /// The last piece that was judged has the exchange.
    is_exchanged: bool,
    /// Rows since the last piece that was judged.
    unknown: Rows,
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Exchanges {
    segments: usize,
    moments: Moments,
    steps: u32,
    rows: Rows,
    pairs: Vec<Pair>,
}

impl Exchanges {
    pub fn new(segments: usize) -> Self {
        let pairs = (0..segments).flat_map(|i| (0..i).map(move |j| [j, i]));
        let pairs = pairs.flat_map(|pair| [Pair::new(pair, true), Pair::new(pair, false)]).collect();
        Self { segments, moments: Moments::ZERO, steps: 0, rows: Rows::default(), pairs }
    }

    pub fn update(&mut self, frame: &Frame) {
        self.rows.add(frame);
    }

    /// Adds a step of the headings and of the bend angles.
    pub fn add(&mut self, heading: &[f64; MAX_SEGMENTS], theta: &[f64; MAX_SEGMENTS]) {
        if !theta.iter().any(|step| step.abs() >= MOTION) {
            return;
        }
        self.moments.add(self.segments, heading, theta);
        self.steps += 1;
        if self.steps == STEPS {
            self.end();
        }
    }

    fn end(&mut self) {
        let fit = Fit::new(&std::mem::replace(&mut self.moments, Moments::ZERO), self.segments, |_| true);
        let rows = std::mem::take(&mut self.rows);
        self.steps = 0;
        let in_order: Vec<f64> = (0..self.segments).map(|i| fit.misfit(&Wiring::in_order(), i)).collect();
        for pair in &mut self.pairs {
            let segments: Vec<usize> = pair.changed().filter(|i| fit.segments.contains(i)).collect();
            let most = segments.iter().map(|i| in_order[*i]).fold(0.0, f64::max);
            pair.unknown.append(&rows);
            if !segments.is_empty() && most < AGREES {
                pair.in_order += 1;
                pair.is_exchanged = false;
                pair.unknown = Rows::default();
            } else if most > MISFIT {
                let wiring = pair.wiring();
                let exchanged: Vec<f64> = segments.iter().map(|i| fit.misfit(&wiring, *i)).collect();
                let before: f64 = segments.iter().map(|i| in_order[*i]).sum();
                let explained = 1.0 - exchanged.iter().sum::<f64>() / before;
                if explained > EXPLAINS && exchanged.iter().all(|misfit| *misfit < EXPLAINED) {
                    pair.exchanged += 1;
                    pair.is_exchanged = true;
                    pair.explained += 100.0 * explained;
                    pair.rows.append(&std::mem::take(&mut pair.unknown));
                }
            }
        }
    }

    pub fn finish(&mut self, findings: &mut Vec<Finding>) {
        self.end();
        for pair in self.pairs.iter_mut().filter(|pair| pair.is_exchanged && pair.unknown.count > 0) {
            pair.rows.append(&pair.unknown);
        }
        self.pairs.sort_by(|a, b| b.explained.total_cmp(&a.explained));
        // A sensor that is wrong otherwise explains nothing.
        let before = findings.clone();
        let mut changed: Vec<usize> = Vec::new();
        for pair in self.pairs.iter().filter(|pair| pair.exchanged.min(pair.in_order) >= PIECES) {
            // Another exchange may seem to explain the same segments in some of the pieces.
            if pair.changed().all(|i| is_unblamed(&before, i) && !changed.contains(&i)) {
                changed.extend(pair.changed());
                let figure = pair.explained / f64::from(pair.exchanged);
                findings.push(Finding { sensor: pair.sensor(), rows: pair.rows, kind: Kind::Exchanged, figure });
            }
        }
    }
}

impl Pair {
    fn new(segments: [usize; 2], are_imus: bool) -> Self {
        Self {
            segments,
            are_imus,
            in_order: 0,
            exchanged: 0,
            explained: 0.0,
            rows: Rows::default(),
            is_exchanged: false,
            unknown: Rows::default(),
        }
    }

    /// The wiring with the exchange.
    fn wiring(&self) -> Wiring {
        let [one, other] = self.segments;
        Wiring::in_order().with(if self.are_imus { Fault::Imus(one, other) } else { Fault::Bends(one, other) })
    }

    /// The segments that the exchange changes: one starts at the IMU before it.
    fn changed(&self) -> impl Iterator<Item = usize> + use<> {
        let next = usize::from(self.are_imus);
        self.segments.into_iter().flat_map(move |i| i..=i + next)
    }

    fn sensor(&self) -> Source {
        let [segment, other] = self.segments.map(|i| i + 1);
        if self.are_imus { Source::TwoImus { segment, other } } else { Source::TwoBends { segment, other } }
    }
}
