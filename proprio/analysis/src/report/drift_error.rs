//! Deviation of the IMUs' bend angles from the truth, or from the bend sensors in a session without truth: drift without the arm's
//! motion.

use std::collections::BTreeSet;

use calibration_tables::{AnchorToml, ArmFile};
use estimator_core::{FusedOps, Method};
use proprio_session::Row;

use super::average::MovingAverage;
use super::downsample::Timeline;
use super::plot::{Axis, Colour, Figure, Marks, Panel, Series, Size, extent, padded, rounded, share_y};
use crate::Outcome;

/// Methods whose deviations are shown.
const METHODS: [Method; 3] = [Method::Bend, Method::ImuO, Method::ImuC];
/// Deviations of a segment: those from the truth, then those from the bend sensors.
const CHANNELS: usize = 2 * METHODS.len();
/// Fewest bins of a session.
const BINS: usize = 128;

/// Deviations of one session, deg.
pub struct DriftErrors {
    window_s: f64,
    segments: Vec<Segment>,
}

struct Segment {
    averages: [MovingAverage; CHANNELS],
    timeline: Timeline<CHANNELS>,
}

impl DriftErrors {
    pub fn new(table: &ArmFile) -> Self {
        let AnchorToml { window, rate_hz, .. } = table.anchor;
        let average = MovingAverage::new(&table.anchor);
        let segment =
            |_: &_| Segment { averages: std::array::from_fn(|_| average.clone()), timeline: Timeline::new(BINS) };
        Self { window_s: f64::from(window) / rate_hz, segments: table.segments.iter().map(segment).collect() }
    }

    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        let time_us = row.sample.time_us;
        for (i, segment) in self.segments.iter_mut().enumerate() {
            let angle =
                |method: Method| outcome.shapes[method as usize].get(i)?.theta.map(|theta| theta.rad().to_degrees());
            let references = [row.true_theta(i).map(f64::to_degrees), angle(Method::Bend)];
            let deviations = references.map(|reference| METHODS.map(|method| Some(angle(method)? - reference?)));
            let mut deviations = deviations.as_flattened().iter();
            let averages = segment.averages.each_mut();
            let averages = averages.map(|average| average.add(time_us, deviations.next().copied().flatten()));
            segment.timeline.add(time_us, averages);
        }
    }

    /// A panel of each segment that has any, all with one scale.
    fn panels(&self, session: &str) -> Vec<Panel> {
        let has_truth = self.segments.iter().any(|segment| segment.has(0..METHODS.len()));
        let (first, title) = if has_truth {
            (0, "angle from the true one, deg")
        } else {
            (METHODS.len(), "angle from bend sensors, deg")
        };
        let all: Vec<Vec<Series>> = self.segments.iter().map(|segment| segment.series(first)).collect();
        let [x, y] = extent(all.iter().flatten());
        let panel = |(i, series): (usize, Vec<Series>)| Panel {
            session: Some(session.to_owned()),
            name: format!("segment {}", i + 1),
            title: format!("segment {}", i + 1),
            facts: Vec::new(),
            size: Size::Third,
            x: Axis::new("time, s", x),
            y: Axis::new(title, padded(y)),
            series,
        };
        all.into_iter().enumerate().filter(|(_, series)| !series.is_empty()).map(panel).collect()
    }
}

impl Segment {
    fn has(&self, channels: std::ops::Range<usize>) -> bool {
        self.timeline.bins().iter().any(|bin| channels.clone().any(|channel| bin.mean(channel).is_some()))
    }

    /// The methods' deviations from the reference whose channels begin at `first`, without that of the reference itself.
    fn series(&self, first: usize) -> Vec<Series> {
        let of = |(k, method): (usize, Method)| {
            let channel = first + k;
            let is_itself = first > 0 && method == Method::Bend;
            let points = self.timeline.bins().iter();
            let points = points.map(|bin| (rounded(bin.time_s()), bin.mean(channel).map(rounded))).collect();
            let marks = Marks::Line { x: "time_s", y: "deviation_average_deg", points };
            let series = Series { name: method.name().to_owned(), colour: Colour::Of(method), marks };
            (!is_itself && self.has(channel..channel + 1)).then_some(series)
        };
        METHODS.into_iter().enumerate().filter_map(of).collect()
    }
}

/// The figure of the sessions' names, numbers of samples and deviations.
pub fn figure<'s>(sessions: impl Iterator<Item = (&'s str, u64, &'s DriftErrors)>) -> Figure {
    let (mut panels, mut samples, mut window_s) = (Vec::new(), 0, 0.0);
    for (name, count, errors) in sessions {
        panels.extend(errors.panels(name));
        samples += count;
        window_s = errors.window_s;
    }
    let references: BTreeSet<&str> = panels.iter().map(|panel| panel.y.title).collect();
    for reference in references {
        share_y(panels.iter_mut().filter(|panel| panel.y.title == reference));
    }
    Figure {
        name: "drift_error",
        title: "Drift of the IMUs and its correction",
        caption: format!(
            "Bend angles less the true ones, or less those of the bend sensors in a session without truth: raw IMUs (imu_o), IMUs \
             whose drift bend sensors correct (imu_c), and bend sensors. Moving averages over the anchor's window, {window_s} s, \
             {samples} samples in bins of equally many. All panels with one reference have one scale."
        ),
        is_drawn: true,
        panels,
    }
}
