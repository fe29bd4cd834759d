//! Consistency of the tip's covariances: share of true tips inside their ellipses, and error over stated deviation against time.

use estimator_core::{FusedOps, Method};
use proprio_session::Row;

use super::downsample::Timeline;
use super::plot::{Axis, Colour, Figure, Marks, Panel, SMOOTHED, Series, Size, extent, rounded, share_y};
use crate::Outcome;
use crate::consistency::tip_square;

/// Estimates that have covariances.
const ESTIMATES: [(&str, Colour); 2] =
    [(Method::Fusion.name(), Colour::Of(Method::Fusion)), (SMOOTHED, Colour::Smoothed)];
/// Steps of the stated share, of 5 % each.
const STEPS: usize = 20;
/// The step of the 95 % ellipse.
const STEP_95: usize = 19;
/// Fewest bins of a session.
const BINS: usize = 100;

/// Normalised tip errors of one session.
pub struct Coverage {
    /// By estimate: number of true tips between the ellipses of neighbouring steps.
    between: [[u64; STEPS]; ESTIMATES.len()],
    /// Squared error over covariance for each coordinate.
    squares: Timeline<{ ESTIMATES.len() }>,
}

impl Coverage {
    pub fn new() -> Self {
        Self { between: [[0; STEPS]; ESTIMATES.len()], squares: Timeline::new(BINS) }
    }

    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        let fusion = tip_square(row, &outcome.shapes[Method::Fusion as usize], &outcome.uncertainties);
        let smoothed = outcome.smoothed.as_ref().and_then(|of| tip_square(row, &of.shape, &of.uncertainties));
        let squares = [fusion, smoothed];
        for (between, square) in self.between.iter_mut().zip(squares) {
            if let Some(square) = square {
                // The share of a normal distribution that is inside the ellipse through the true tip.
                let inside = 1.0 - (-square / 2.0).exp();
                between[((inside * STEPS as f64) as usize).min(STEPS - 1)] += 1;
            }
        }
        self.squares.add(row.sample.time_us, squares.map(|square| square.map(|square| square / 2.0)));
    }

    /// Share of true tips inside the ellipse of each step, %; `None` without any.
    fn inside_percent(&self, estimate: usize) -> Option<[f64; STEPS + 1]> {
        let between = &self.between[estimate];
        let all: u64 = between.iter().sum();
        let mut inside = 0;
        let share = |step: usize| {
            inside += if step == 0 { 0 } else { between[step - 1] };
            inside as f64 / all as f64 * 100.0
        };
        (all > 0).then(|| std::array::from_fn(share))
    }

    fn known(&self) -> Vec<usize> {
        (0..ESTIMATES.len()).filter(|estimate| self.inside_percent(*estimate).is_some()).collect()
    }

    fn shares(&self, session: &str) -> Panel {
        let stated = |step: usize| step as f64 * 100.0 / STEPS as f64;
        let curve = |estimate: usize| {
            let inside = self.inside_percent(estimate).into_iter().flatten().enumerate();
            inside.map(|(step, percent)| (stated(step), Some(rounded(percent)))).collect()
        };
        let consistent = [0, STEPS].map(|step| (stated(step), Some(stated(step)))).to_vec();
        let (x, y) = ("stated_percent", "inside_percent");
        let mut series = vec![line("consistent", Colour::Ink, Marks::Line { x, y, points: consistent })];
        let known = self.known();
        series.extend(known.iter().map(|k| of(*k, Marks::Line { x, y, points: curve(*k) })));
        let inside = known.iter().filter_map(|k| Some((ESTIMATES[*k].0, self.inside_percent(*k)?[STEP_95])));
        let texts: Vec<String> = inside.map(|(name, percent)| format!("{name} {percent:.1} %")).collect();
        Panel {
            session: Some(session.to_owned()),
            name: "coverage".to_owned(),
            title: format!("true tips in the 95 % ellipse: {}", texts.join(", ")),
            facts: Vec::new(),
            size: Size::Half,
            x: Axis::new("stated share, %", [0.0, 100.0]),
            y: Axis::new("share of true tips inside, %", [0.0, 100.0]),
            series,
        }
    }

    fn ratio(&self, session: &str) -> Panel {
        let bins = self.squares.bins();
        let points = |k: usize| {
            let ratio = |square: f64| rounded(square.sqrt());
            bins.iter().map(|bin| (rounded(bin.time_s()), bin.mean(k).map(ratio))).collect()
        };
        let (x, y) = ("time_s", "tip_error_over_deviation");
        let mut series: Vec<Series> =
            self.known().into_iter().map(|k| of(k, Marks::Line { x, y, points: points(k) })).collect();
        let [time_s, [_, largest]] = extent(&series);
        let consistent = time_s.map(|time_s| (time_s, Some(1.0))).to_vec();
        series.insert(0, line("consistent", Colour::Ink, Marks::Line { x, y, points: consistent }));
        Panel {
            session: Some(session.to_owned()),
            name: "ratio".to_owned(),
            title: "tip error over its stated deviation".to_owned(),
            facts: Vec::new(),
            size: Size::Half,
            x: Axis::new("time, s", time_s),
            y: Axis::new("error over stated deviation", [0.0, 1.05 * largest.max(1.0)]),
            series,
        }
    }
}

fn line(name: &str, colour: Colour, marks: Marks) -> Series {
    Series { name: name.to_owned(), colour, marks }
}

fn of(estimate: usize, marks: Marks) -> Series {
    let (name, colour) = ESTIMATES[estimate];
    line(name, colour, marks)
}

/// The figure of the sessions' names and normalised errors.
pub fn figure<'s>(sessions: impl Iterator<Item = (&'s str, &'s Coverage)>) -> Figure {
    let known = sessions.filter(|(_, coverage)| !coverage.known().is_empty());
    let mut panels: Vec<Panel> =
        known.flat_map(|(name, coverage)| [coverage.shares(name), coverage.ratio(name)]).collect();
    share_y(panels.iter_mut().filter(|panel| panel.name == "ratio"));
    Figure {
        name: "uncertainty",
        title: "Stated uncertainty of the tip",
        caption: "Left: share of true tips inside the ellipses that their covariances state, for any stated share; a curve above \
                  the line of consistency is of an estimate that states too large deviations, below it of an overconfident one. \
                  Right: root mean square, over bins of equally many samples, of the tip's error over its stated deviation; 1 is \
                  consistent, above 1 overconfident. All panels of errors have one scale."
            .to_owned(),
        is_drawn: !panels.is_empty(),
        panels,
    }
}
