//! Error of the tip over time.

use estimator_core::{FusedOps, Method};
use proprio_session::Row;

use super::downsample::Timeline;
use super::plot::{Axis, ESTIMATES, Figure, Marks, Panel, Series, Size, extent, rounded, share_y};
use crate::Outcome;
use crate::metrics::{smoothed_tip_error_m, tip_errors_m};

/// Fewest bins of a session: with more, five areas cannot be distinguished.
const BINS: usize = 100;
/// Least error on the axis, mm: a sixth of the error of a camera's marker.
const LEAST_MM: f64 = 0.1;
const CHANNELS: usize = ESTIMATES.len();

/// Tip errors of one session, mm.
pub struct TipErrors(Timeline<CHANNELS>);

impl TipErrors {
    pub fn new() -> Self {
        Self(Timeline::new(BINS))
    }

    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        let [bend, imu_o, imu_c, fusion] = tip_errors_m(row, outcome);
        let errors_m = [bend, imu_o, imu_c, fusion, smoothed_tip_error_m(row, outcome)];
        self.0.add(row.sample.time_us, errors_m.map(|error| error.map(|m| m * 1e3)));
    }

    fn panel(&self, session: &str) -> Option<Panel> {
        let is_known = |channel: &usize| self.0.bins().iter().any(|bin| bin.mean(*channel).is_some());
        let known: Vec<usize> = (0..CHANNELS).filter(is_known).collect();
        let series = |channel: usize, marks| {
            let (name, colour) = ESTIMATES[channel];
            Series { name: name.to_owned(), colour, marks }
        };
        let bands = known.iter().map(|channel| series(*channel, self.band(*channel)));
        let means = known.iter().map(|channel| series(*channel, self.mean(*channel)));
        let all: Vec<Series> = bands.chain(means).collect();
        let [x, [_, largest]] = extent(&all);
        let x = Axis::new("time, s", x);
        let y = Axis::log("tip error, mm", self.range_mm(&known, largest));
        let (session, title, name, facts) = (Some(session.to_owned()), session.to_owned(), String::new(), Vec::new());
        (!all.is_empty()).then_some(Panel { session, name, title, facts, size: Size::Half, x, y, series: all })
    }

    /// True where this method has errors.
    pub fn has(&self, method: Method) -> bool {
        self.0.bins().iter().any(|bin| bin.mean(method as usize).is_some())
    }

    /// Range of the axis: half the least mean of a bin, at least 0.1 mm and a tenth of the largest error, to that.
    fn range_mm(&self, channels: &[usize], largest_mm: f64) -> [f64; 2] {
        let means = channels.iter().flat_map(|channel| self.0.bins().iter().filter_map(|bin| bin.mean(*channel)));
        let least_mm = means.fold(f64::INFINITY, f64::min);
        let largest_mm = largest_mm.max(10.0 * LEAST_MM);
        [(0.5 * least_mm).clamp(LEAST_MM, 0.1 * largest_mm), 1.05 * largest_mm]
    }

    fn band(&self, channel: usize) -> Marks {
        let points =
            self.0.bins().iter().map(|bin| (rounded(bin.time_s()), bin.range(channel).map(|r| r.map(rounded))));
        Marks::Band { x: "time_s", low: "tip_error_least_mm", high: "tip_error_largest_mm", points: points.collect() }
    }

    /// The means of the bins.
    pub fn mean(&self, channel: usize) -> Marks {
        let points = self.0.bins().iter().map(|bin| (rounded(bin.time_s()), bin.mean(channel).map(rounded)));
        Marks::Line { x: "time_s", y: "tip_error_mean_mm", points: points.collect() }
    }
}

/// The figure of the sessions' names, numbers of samples and errors.
pub fn figure<'s>(sessions: impl Iterator<Item = (&'s str, u64, &'s TipErrors)>) -> Figure {
    let (mut panels, mut samples) = (Vec::new(), 0);
    for (name, count, errors) in sessions {
        if let Some(panel) = errors.panel(name) {
            panels.push(panel);
            samples += count;
        }
    }
    share_y(panels.iter_mut());
    Figure {
        name: "tip_error",
        title: "Tip error against time",
        caption: format!(
            "Distance of the tip from its true place, {samples} samples in bins of equally many: line, mean of a bin; \
             area, from its least to its largest error, so that every peak is seen. The scale is logarithmic, and the same in \
             all panels."
        ),
        is_drawn: !panels.is_empty(),
        panels,
    }
}
