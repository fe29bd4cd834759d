//! Bend angles of the raw IMUs and of the corrected ones, segment by segment, as numbers.

use std::collections::VecDeque;

use calibration_tables::{AnchorToml, ArmFile, MAX_SEGMENTS};
use estimator_core::{FusedOps, Method};
use proprio_session::Row;

use super::average::MovingAverage;
use super::downsample::Timeline;
use super::plot::{Axis, Colour, Figure, Marks, Panel, Series, Size, extent, padded, rounded};
use crate::Outcome;

/// Curves of a segment, the truth first, so that it is drawn below the others.
const CURVES: [Colour; 4] =
    [Colour::Truth, Colour::Of(Method::Bend), Colour::Of(Method::ImuO), Colour::Of(Method::ImuC)];
const TRUTH: usize = 0;
const BEND: usize = 1;
const IMU_O: usize = 2;
/// Fewest bins of a session.
const BINS: usize = 256;
/// Length of the session's end that is shown without averaging, s.
const END_S: u64 = 30;
/// Shortest step between two of its samples, µs.
const END_STEP_US: u64 = 50_000;

type Angles = [Option<f64>; CURVES.len()];

/// Bend angles of one session, deg.
pub struct Drift {
    window_s: f64,
    segments: Vec<Segment>,
    end: VecDeque<(u64, [Angles; MAX_SEGMENTS])>,
}

struct Segment {
    averages: [MovingAverage; CURVES.len()],
    timeline: Timeline<{ CURVES.len() }>,
}

impl Drift {
    pub fn new(table: &ArmFile) -> Self {
        let AnchorToml { window, rate_hz, .. } = table.anchor;
        let average = MovingAverage::new(&table.anchor);
        let segment = |_: &_| Segment { averages: CURVES.map(|_| average.clone()), timeline: Timeline::new(BINS) };
        let segments = table.segments.iter().map(segment).collect();
        Self { window_s: f64::from(window) / rate_hz, segments, end: VecDeque::new() }
    }

    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        let time_us = row.sample.time_us;
        let mut angles = [[None; CURVES.len()]; MAX_SEGMENTS];
        for (i, (segment, angles)) in self.segments.iter_mut().zip(&mut angles).enumerate() {
            *angles = CURVES.map(|curve| match curve {
                Colour::Of(method) => {
                    outcome.shapes[method as usize].get(i)?.theta.map(|theta| theta.rad().to_degrees())
                }
                Colour::Truth | Colour::Smoothed | Colour::Ink | Colour::Grid => row.true_theta(i).map(f64::to_degrees),
            });
            let mut values = angles.iter();
            let averages = segment.averages.each_mut();
            let averages = averages.map(|average| average.add(time_us, values.next().copied().flatten()));
            segment.timeline.add(time_us, averages);
        }
        while self.end.pop_front_if(|(time, _)| *time + END_S * 1_000_000 < time_us).is_some() {}
        if self.end.back().is_none_or(|(last, _)| time_us >= last + END_STEP_US) {
            self.end.push_back((time_us, angles));
        }
    }

    /// The segment that drifts most, large and with the end of the session, and then the others.
    pub fn panels(&self, session: &str) -> Vec<Panel> {
        let drifts: Vec<f64> = self.segments.iter().map(|segment| segment.drift_deg().unwrap_or(0.0)).collect();
        let worst = (0..drifts.len()).reduce(|worst, i| if drifts[i] > drifts[worst] { i } else { worst }).unwrap_or(0);
        let mut panels = vec![self.averages(session, worst, Size::Half), self.end(session, worst)];
        let others = (0..self.segments.len()).filter(|i| *i != worst);
        panels.extend(others.map(|i| self.averages(session, i, Size::Third)));
        panels
    }

    fn averages(&self, session: &str, i: usize, size: Size) -> Panel {
        let segment = &self.segments[i];
        let mut timeline = segment.timeline.clone();
        if size == Size::Third {
            timeline.halve();
        }
        let bins = timeline.bins();
        let series = series("theta_average_deg", |channel| {
            bins.iter().map(|bin| (rounded(bin.time_s()), bin.mean(channel).map(rounded))).collect()
        });
        let name = format!("segment {}", i + 1);
        let drift_deg = segment.drift_deg();
        let title = drift_deg.map_or(name.clone(), |deg| format!("{name}: drift up to {deg:.1}°"));
        let facts = drift_deg.into_iter().map(|deg| ("drift_deg", rounded(deg))).collect();
        let [x, y] = axes(&series, "bend angle, moving average, deg");
        Panel { session: Some(session.to_owned()), name, title, facts, size, x, y, series }
    }

    fn end(&self, session: &str, i: usize) -> Panel {
        let at = |(time, angles): &(u64, [Angles; MAX_SEGMENTS]), channel: usize| {
            (rounded(*time as f64 / 1e6), angles[i][channel].map(rounded))
        };
        let series = series("theta_deg", |channel| self.end.iter().map(|row| at(row, channel)).collect());
        let name = format!("segment {} end", i + 1);
        let title = format!("segment {}: the last {END_S} s, not averaged", i + 1);
        let [x, y] = axes(&series, "bend angle, deg");
        Panel { session: Some(session.to_owned()), name, title, facts: Vec::new(), size: Size::Half, x, y, series }
    }
}

impl Segment {
    /// Largest distance of the raw IMUs' moving average from that of the truth, or else of the bend sensors.
    fn drift_deg(&self) -> Option<f64> {
        let distance = |from: usize| {
            let bins = self.timeline.bins().iter();
            bins.filter_map(move |bin| Some((bin.mean(IMU_O)? - bin.mean(from)?).abs())).reduce(f64::max)
        };
        distance(TRUTH).or_else(|| distance(BEND))
    }
}

/// The curves that have any value.
fn series(y: &'static str, points: impl Fn(usize) -> Vec<(f64, Option<f64>)>) -> Vec<Series> {
    let curves = CURVES.into_iter().enumerate().map(|(channel, colour)| {
        let name = match colour {
            Colour::Of(method) => method.name(),
            Colour::Truth | Colour::Smoothed | Colour::Ink | Colour::Grid => "truth",
        };
        (name, colour, points(channel))
    });
    let known = curves.filter(|(.., points)| points.iter().any(|(_, value)| value.is_some()));
    let line = |points| Marks::Line { x: "time_s", y, points };
    known.map(|(name, colour, points)| Series { name: name.to_owned(), colour, marks: line(points) }).collect()
}

fn axes(series: &[Series], title: &'static str) -> [Axis; 2] {
    let [x, y] = extent(series);
    [Axis::new("time, s", x), Axis::new(title, padded(y))]
}

/// The figure of the sessions' names, numbers of samples and angles.
pub fn figure<'s>(sessions: impl Iterator<Item = (&'s str, u64, &'s Drift)>) -> Figure {
    let (mut panels, mut samples, mut window_s) = (Vec::new(), 0, 0.0);
    for (name, count, drift) in sessions {
        panels.extend(drift.panels(name));
        samples += count;
        window_s = drift.window_s;
    }
    Figure {
        name: "drift",
        title: "Bend angles of the IMUs and of their correction",
        caption: format!(
            "Moving averages of the bend angles over the anchor's window, {window_s} s, {samples} samples in bins of equally many: raw IMUs \
             (imu_o), IMUs whose drift bend sensors correct (imu_c), bend sensors and truth, where they are known. Of each \
             session the segment that drifts most is large, with its last {END_S} s as they are. Drift is the largest \
             distance of imu_o's average from the truth's, or from the bend sensors' where there is no truth."
        ),
        is_drawn: false,
        panels,
    }
}
