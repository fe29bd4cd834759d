//! Estimated place of the tip over time, of sessions without its truth.

use std::collections::VecDeque;

use estimator_core::{FusedOps, Method};
use proprio_session::Row;

use super::downsample::Timeline;
use super::plot::{Axis, ESTIMATES, Figure, Marks, Panel, Series, Size, extent, padded, rounded};
use crate::Outcome;

/// Coordinates of the tip.
const AXES: [(&str, &str, &str); 2] = [("x", "x of the tip, mm", "tip_x_mm"), ("y", "y of the tip, mm", "tip_y_mm")];
/// Channels: x, then y, of each estimate.
const CHANNELS: usize = 2 * ESTIMATES.len();
/// Place of fusion in the estimates.
const FUSION: usize = Method::Fusion as usize;
/// Fewest bins of a session.
const BINS: usize = 100;
/// Length of the session's end that is shown without averaging, s.
const END_S: u64 = 30;
/// Shortest step between two of its samples, µs.
const END_STEP_US: u64 = 50_000;
/// 97.5 % quantile of the normal distribution.
const NORMAL_975: f64 = 1.96;

/// Places of the tip of one session, mm.
pub struct TipPlaces {
    timeline: Timeline<CHANNELS>,
    end: VecDeque<Moment>,
}

/// One sample near the session's end.
struct Moment {
    time_us: u64,
    places_mm: [Option<f64>; CHANNELS],
    /// Deviations of fusion's x and y, mm.
    deviations_mm: Option<[f64; 2]>,
}

impl TipPlaces {
    pub fn new() -> Self {
        Self { timeline: Timeline::new(BINS), end: VecDeque::new() }
    }

    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        let time_us = row.sample.time_us;
        let smoothed = outcome.smoothed.as_ref().map(|smoothed| &smoothed.shape);
        let mut places_mm = [None; CHANNELS];
        for (k, shape) in outcome.shapes.iter().chain(smoothed).enumerate() {
            if let Some(tip) = shape.last().and_then(|segment| segment.end) {
                places_mm[2 * k] = Some(tip.x.to_f64() * 1e3);
                places_mm[2 * k + 1] = Some(tip.y.to_f64() * 1e3);
            }
        }
        self.timeline.add(time_us, places_mm);
        while self.end.pop_front_if(|moment| moment.time_us + END_S * 1_000_000 < time_us).is_some() {}
        if self.end.back().is_none_or(|last| time_us >= last.time_us + END_STEP_US) {
            let covariance = outcome.uncertainties.last().and_then(|uncertainty| uncertainty.end);
            let deviations_mm = covariance.map(|covariance| {
                let [xx, _, yy] = covariance.square_metres();
                [xx, yy].map(|variance| variance.sqrt() * 1e3)
            });
            self.end.push_back(Moment { time_us, places_mm, deviations_mm });
        }
    }

    fn panels(&self, session: &str) -> Vec<Panel> {
        let panels = (0..AXES.len()).flat_map(|axis| {
            let whole = self.whole(session, axis);
            let mut end = self.end(session, axis);
            end.y.range = whole.y.range;
            [whole, end]
        });
        panels.filter(|panel| !panel.series.is_empty()).collect()
    }

    /// The whole session: means, and the range of fusion.
    fn whole(&self, session: &str, axis: usize) -> Panel {
        let bins = self.timeline.bins();
        let range = |bin: &super::downsample::Bin<CHANNELS>| {
            (rounded(bin.time_s()), bin.range(2 * FUSION + axis).map(|range| range.map(rounded)))
        };
        let band = bins.iter().map(range).collect();
        let (low, high) = (["tip_x_least_mm", "tip_y_least_mm"][axis], ["tip_x_largest_mm", "tip_y_largest_mm"][axis]);
        let band = Marks::Band { x: "time_s", low, high, points: band };
        panel(session, axis, "", band, |k| {
            bins.iter().map(|bin| (rounded(bin.time_s()), bin.mean(2 * k + axis).map(rounded))).collect()
        })
    }

    /// The end as it is, with fusion's 95 % interval.
    fn end(&self, session: &str, axis: usize) -> Panel {
        let time_s = |moment: &Moment| rounded(moment.time_us as f64 / 1e6);
        let interval = |moment: &Moment| {
            let (place, deviation) = (moment.places_mm[2 * FUSION + axis]?, moment.deviations_mm?[axis]);
            Some([-NORMAL_975, NORMAL_975].map(|factor| rounded(place + factor * deviation)))
        };
        let points = self.end.iter().map(|moment| (time_s(moment), interval(moment))).collect();
        let (low, high) = (["tip_x_low_mm", "tip_y_low_mm"][axis], ["tip_x_high_mm", "tip_y_high_mm"][axis]);
        let band = Marks::Band { x: "time_s", low, high, points };
        panel(session, axis, " end", band, |k| {
            self.end.iter().map(|moment| (time_s(moment), moment.places_mm[2 * k + axis].map(rounded))).collect()
        })
    }
}

/// A panel of one coordinate: a band of fusion, and a line of each known estimate.
fn panel(
    session: &str,
    axis: usize,
    part: &str,
    band: Marks,
    points: impl Fn(usize) -> Vec<(f64, Option<f64>)>,
) -> Panel {
    let (name, title, y) = AXES[axis];
    let series = |k: usize, marks| {
        let (name, colour) = ESTIMATES[k];
        Series { name: name.to_owned(), colour, marks }
    };
    let has_band = matches!(&band, Marks::Band { points, .. } if points.iter().any(|(_, range)| range.is_some()));
    let lines = (0..ESTIMATES.len()).map(|k| (k, points(k)));
    let lines = lines.filter(|(_, points)| points.iter().any(|(_, value)| value.is_some()));
    let lines = lines.map(|(k, points)| series(k, Marks::Line { x: "time_s", y, points }));
    let all: Vec<Series> = has_band.then(|| series(FUSION, band)).into_iter().chain(lines).collect();
    let [x, y] = extent(&all);
    let kind = if part.is_empty() { "" } else { ", the last 30 s" };
    Panel {
        session: Some(session.to_owned()),
        name: format!("{name}{part}"),
        title: format!("{name} of the tip{kind}"),
        facts: Vec::new(),
        size: Size::Half,
        x: Axis::new("time, s", x),
        y: Axis::new(title, padded(y)),
        series: all,
    }
}

/// The figure of the names and places of the sessions without true tips.
pub fn figure<'s>(sessions: impl Iterator<Item = (&'s str, &'s TipPlaces)>) -> Figure {
    let panels: Vec<Panel> = sessions.flat_map(|(name, places)| places.panels(name)).collect();
    Figure {
        name: "estimate",
        title: "Estimated place of the tip against time",
        caption: format!(
            "Place of the tip in the world frame, base at the origin, of sessions without its truth. Left: means over bins of \
             equally many samples; area, least to largest value of fusion. Right: the last {END_S} s as they are; area, 95 % \
             interval of fusion, where the table has error sources. Estimates that part show drift or a fault of some sensor."
        ),
        is_drawn: !panels.is_empty(),
        panels,
    }
}
