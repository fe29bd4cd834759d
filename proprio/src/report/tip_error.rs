//! The tip's error against time.

use estimator_core::{FusedOps, Method};

use super::plot::{Axis, Colour, Figure, Marks, Panel, Series, Size, extent, rounded};
use super::thin::Timeline;
use crate::replay::Outcome;
use crate::score::tip_errors_m;
use crate::session::Row;

/// Bins of a session at least: few enough for four areas to be told apart.
const BINS: usize = 100;
const METHODS: usize = Method::ALL.len();

/// Tip errors of one session, mm.
pub struct TipErrors(Timeline<METHODS>);

impl TipErrors {
    pub fn new() -> Self {
        Self(Timeline::new(BINS))
    }

    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        self.0.add(row.sample.time_us, tip_errors_m(row, outcome).map(|error| error.map(|m| m * 1e3)));
    }

    fn panel(&self, session: &str) -> Option<Panel> {
        let spoken = |(channel, _): &(usize, &Method)| self.0.bins().iter().any(|bin| bin.mean(*channel).is_some());
        let said: Vec<(usize, &Method)> = Method::ALL.iter().enumerate().filter(spoken).collect();
        let series =
            |marks, method: &Method| Series { name: method.name().to_owned(), colour: Colour::Of(*method), marks };
        let bands = said.iter().map(|(channel, method)| series(self.band(*channel), method));
        let means = said.iter().map(|(channel, method)| series(self.mean(*channel), method));
        let all: Vec<Series> = bands.chain(means).collect();
        let [x, [_, largest]] = extent(&all);
        let x = Axis::new("time, s", x);
        let y = Axis::new("tip error, mm", [0.0, 1.05 * largest]);
        let (session, title, name, facts) = (Some(session.to_owned()), session.to_owned(), String::new(), Vec::new());
        (!all.is_empty()).then_some(Panel { session, name, title, facts, size: Size::Half, x, y, series: all })
    }

    fn band(&self, channel: usize) -> Marks {
        let points =
            self.0.bins().iter().map(|bin| (rounded(bin.time_s()), bin.range(channel).map(|r| r.map(rounded))));
        Marks::Band { x: "time_s", low: "tip_error_least_mm", high: "tip_error_largest_mm", points: points.collect() }
    }

    fn mean(&self, channel: usize) -> Marks {
        let points = self.0.bins().iter().map(|bin| (rounded(bin.time_s()), bin.mean(channel).map(rounded)));
        Marks::Line { x: "time_s", y: "tip_error_mean_mm", points: points.collect() }
    }
}

/// From the sessions' names, numbers of samples and errors.
pub fn figure<'s>(sessions: impl Iterator<Item = (&'s str, u64, &'s TipErrors)>) -> Figure {
    let (mut panels, mut samples) = (Vec::new(), 0);
    for (name, count, errors) in sessions {
        if let Some(panel) = errors.panel(name) {
            panels.push(panel);
            samples += count;
        }
    }
    Figure {
        name: "tip_error",
        title: "Tip error against time",
        caption: format!(
            "Distance of the tip from its true place, {samples} samples in bins of equally many: line, mean of a bin; \
             area, from its least to its largest error, so that every peak is seen."
        ),
        panels,
    }
}
