//! Snapshots of the arm's shape, estimated and true.

use calibration_tables::{ArmFile, MAX_SEGMENTS};
use estimator_core::{Angle, Covariance, FusedOps, Method, UnitArc};
use proprio_session::{Ellipse, Row, Truth};

use super::downsample::DecimatedItems;
use super::plot::{Axis, Colour, Figure, Marks, Panel, Series, Size, extent, padded, rounded};
use super::tip_view::{View, ellipse};
use crate::Outcome;
use crate::metrics::{ErrorMetrics, tip_errors_m};

/// Fewest moments of a session that are kept.
const MOMENTS: usize = 256;
/// Points of a drawn segment.
const SEGMENT_POINTS: u32 = 8;
/// Side of a view of the tip over the largest distance in it from its middle.
const ROOM: f64 = 1.1;
/// Least half side of a view of the tip, mm.
const LEAST_HALF_MM: f64 = 2.0;
/// Methods whose error circles are drawn.
const CIRCLES: [Method; 2] = [Method::Fusion, Method::ImuC];

/// Shapes of one session at some moments.
pub struct Shapes {
    lengths_m: Vec<f64>,
    /// The method whose errors choose the moments.
    leading: Method,
    kept: DecimatedItems<Snapshot>,
    worst: Option<Snapshot>,
}

/// One moment.
#[derive(Debug, Clone)]
struct Snapshot {
    time_s: f64,
    /// Tip error of the leading method, m.
    error_m: Option<f64>,
    shapes: [Vec<Option<End>>; Method::ALL.len()],
    /// Covariance of fusion's tip, m².
    covariance_m2: Option<[f64; 3]>,
    truth: [Option<Truth>; MAX_SEGMENTS],
}

/// A segment's end.
#[derive(Debug, Clone, Copy)]
struct End {
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
}

impl Shapes {
    pub fn new(table: &ArmFile) -> Self {
        let has_bend_sensors =
            table.segments.iter().any(|segment| segment.bend.as_ref().is_some_and(|b| !b.is_empty()));
        Self {
            lengths_m: table.segments.iter().map(|segment| (segment.length_mm + segment.offset_mm) / 1e3).collect(),
            leading: if has_bend_sensors { Method::Fusion } else { Method::ImuO },
            kept: DecimatedItems::new(MOMENTS),
            worst: None,
        }
    }

    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        let error_m = tip_errors_m(row, outcome)[self.leading as usize];
        let snapshot = || Snapshot::new(row, outcome, error_m);
        if error_m > self.worst.as_ref().and_then(|worst| worst.error_m) {
            self.worst = Some(snapshot());
        }
        self.kept.add(snapshot);
    }

    /// The moments whose tip errors are nearest to the quartiles, and the worst; without truth, four evenly spaced.
    fn moments(&self, errors: &ErrorMetrics) -> Vec<(String, &Snapshot)> {
        let items = self.kept.items();
        let Some(worst) = &self.worst else {
            let moments = (0..4).filter_map(|i| items.get((2 * i + 1) * items.len() / 8));
            return (1..).zip(moments).map(|(i, moment)| (format!("moment {i}"), moment)).collect();
        };
        let tips = errors.tips(self.leading);
        let quartiles = [("first quartile", 0.25), ("median", 0.5), ("third quartile", 0.75)];
        let nearest = quartiles.into_iter().filter_map(|(name, share)| {
            let wanted_m = tips.quantile_m(share)?;
            let distance = |moment: &&Snapshot| moment.error_m.map_or(f64::INFINITY, |m| (m - wanted_m).abs());
            Some((name, items.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?))
        });
        nearest.chain([("largest error", worst)]).map(|(name, moment)| (name.to_owned(), moment)).collect()
    }

    /// The moments' panels, all to one scale, and the same magnified about the tip.
    fn panels(&self, session: &str, errors: &ErrorMetrics) -> Vec<Panel> {
        let moments = self.moments(errors);
        let half_mm = moments.iter().map(|(_, moment)| moment.reach_mm()).fold(LEAST_HALF_MM, f64::max) * ROOM;
        let whole = moments.iter().map(|(name, moment)| moment.panel(session, name, &self.lengths_m, errors));
        let mut panels: Vec<Panel> = whole.collect();
        let [x, y] = extent(panels.iter().flat_map(|panel| &panel.series)).map(padded);
        let tips = moments
            .iter()
            .zip(&panels)
            .filter_map(|((_, moment), panel)| moment.tip_panel(panel, self.leading, half_mm));
        let tips: Vec<Panel> = tips.collect();
        for panel in &mut panels {
            (panel.x.range, panel.y.range) = (x, y);
        }
        panels.into_iter().chain(tips).collect()
    }
}

impl Snapshot {
    fn new<S: FusedOps>(row: &Row, outcome: &Outcome<S>, error_m: Option<f64>) -> Self {
        let shapes = outcome.shapes.each_ref().map(|shape| {
            let mut heading_rad = 0.0;
            let end = |segment: &estimator_core::SegmentShape<S>| {
                heading_rad += segment.theta?.rad();
                let end = segment.end?;
                Some(End { x_m: end.x.to_f64(), y_m: end.y.to_f64(), heading_rad })
            };
            shape.iter().map(end).collect()
        });
        let covariance_m2 = outcome.uncertainties.last().and_then(|tip| tip.end).map(Covariance::square_metres);
        Self { time_s: row.sample.time_us as f64 / 1e6, error_m, shapes, covariance_m2, truth: row.truth }
    }

    fn panel(&self, session: &str, name: &str, lengths_m: &[f64], errors: &ErrorMetrics) -> Panel {
        let (time_s, error_mm) = (self.time_s, self.error_m.map(|m| m * 1e3));
        let title = match error_mm {
            Some(mm) => format!("{name}: {mm:.1} mm at {time_s:.1} s"),
            None => format!("{name}: at {time_s:.1} s"),
        };
        let facts = [("time_s", Some(time_s)), ("tip_error_mm", error_mm)];
        Panel {
            session: Some(session.to_owned()),
            name: name.to_owned(),
            title,
            facts: facts.into_iter().filter_map(|(name, value)| Some((name, rounded(value?)))).collect(),
            size: Size::Quarter,
            x: Axis::new("x, mm", [0.0, 1.0]),
            y: Axis::new("y, mm", [0.0, 1.0]),
            series: self.series(lengths_m, errors),
        }
    }

    /// Place of the true tip, or else of the leading estimate's, mm.
    fn middle_mm(&self, leading: Method) -> Option<(f64, f64)> {
        let segments = self.shapes[leading as usize].len();
        let truth = self.truth[..segments].last().copied().flatten().map(|pose| (pose.x_m * 1e3, pose.y_m * 1e3));
        truth.or_else(|| self.tip_mm(leading))
    }

    fn tip_mm(&self, method: Method) -> Option<(f64, f64)> {
        let tip = (*self.shapes[method as usize].last()?)?;
        Some((tip.x_m * 1e3, tip.y_m * 1e3))
    }

    /// Distance from the middle of its view that the leading estimate and fusion's ellipse need, mm.
    fn reach_mm(&self) -> f64 {
        let ellipse_mm = self.covariance_m2.map_or(0.0, |covariance| Ellipse::of(covariance).major_mm);
        self.error_m.map_or(0.0, |m| m * 1e3) + ellipse_mm
    }

    /// A moment's panel magnified about the tip, with fusion's ellipse.
    fn tip_panel(&self, whole: &Panel, leading: Method, half_mm: f64) -> Option<Panel> {
        let view = View { center_mm: self.middle_mm(leading)?, half_mm };
        let mut series: Vec<Series> = whole.series.iter().filter_map(|series| view.cut(series)).collect();
        if let Some((tip, covariance)) = self.tip_mm(Method::Fusion).zip(self.covariance_m2) {
            let line = named("fusion 95 %", Colour::Of(Method::Fusion), ellipse(tip, covariance));
            series.extend(view.cut(&line));
        }
        let [x, y] = view.ranges();
        let name = format!("{} tip", whole.name);
        let title = format!("{}: the tip", whole.name);
        let (x, y) = (Axis { range: x, ..whole.x.clone() }, Axis { range: y, ..whole.y.clone() });
        Some(Panel { name, title, facts: Vec::new(), size: Size::Square, x, y, series, session: whole.session.clone() })
    }

    fn series(&self, lengths_m: &[f64], errors: &ErrorMetrics) -> Vec<Series> {
        let mut series = self.true_series(lengths_m);
        for method in Method::ALL {
            let ends = &self.shapes[method as usize];
            let points = curve(ends.iter().copied(), lengths_m);
            if points.len() > 1 {
                series.push(named(method.name(), Colour::Of(method), line(points)));
            }
        }
        series.extend(CIRCLES.into_iter().filter_map(|method| self.circle(method, errors)));
        series
    }

    fn true_series(&self, lengths_m: &[f64]) -> Vec<Series> {
        let known = self.truth.iter().take(lengths_m.len());
        let places: Vec<(f64, f64)> =
            known.clone().flatten().map(|pose| (rounded(pose.x_m * 1e3), rounded(pose.y_m * 1e3))).collect();
        let end = |pose: &Truth| Some(End { x_m: pose.x_m, y_m: pose.y_m, heading_rad: pose.heading_rad? });
        let points = curve(known.map(|pose| pose.as_ref().and_then(end)), lengths_m);
        let mut series = Vec::new();
        if points.len() > 1 {
            series.push(named("truth", Colour::Truth, line(points)));
        }
        if !places.is_empty() {
            series.push(named("truth", Colour::Truth, Marks::Dots { x: "end_x_mm", y: "end_y_mm", points: places }));
        }
        series
    }

    /// The circle about the estimated tip inside which three quarters of this session's errors are.
    fn circle(&self, method: Method, errors: &ErrorMetrics) -> Option<Series> {
        let tip = (*self.shapes[method as usize].last()?)?;
        let radius_m = errors.tips(method).quantile_m(0.75)?;
        let [center_x_mm, center_y_mm, radius_mm] = [tip.x_m, tip.y_m, radius_m].map(|m| rounded(m * 1e3));
        let marks = Marks::Circle { center_x_mm, center_y_mm, radius_mm };
        Some(named(&format!("{} 75 %", method.name()), Colour::Of(method), marks))
    }
}

fn named(name: &str, colour: Colour, marks: Marks) -> Series {
    Series { name: name.to_owned(), colour, marks }
}

fn line(points: Vec<(f64, f64)>) -> Marks {
    let points = points.into_iter().map(|(x, y)| (rounded(x), Some(rounded(y)))).collect();
    Marks::Line { x: "x_mm", y: "y_mm", points }
}

/// The arm through the ends of its segments, mm, up to the first that is unknown. Between two ends it is drawn as the cubic
/// that has their headings and is as fast as the segment is long (Hermite's), which is near a constant curvature.
fn curve(ends: impl Iterator<Item = Option<End>>, lengths_m: &[f64]) -> Vec<(f64, f64)> {
    let mut points = vec![(0.0, 0.0)];
    let mut before = End { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
    for (end, length_m) in ends.map_while(|end| end).zip(lengths_m) {
        let [from, to] = [before, end].map(|end| {
            let UnitArc { sin, cos, .. } = UnitArc::new(Angle::from(end.heading_rad));
            (end.x_m, end.y_m, sin * length_m, cos * length_m)
        });
        points.extend((1..=SEGMENT_POINTS).map(|k| {
            let t = f64::from(k) / f64::from(SEGMENT_POINTS);
            let (start, into) = ((1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t), t * (1.0 - t) * (1.0 - t));
            let (stop, out) = (t * t * (3.0 - 2.0 * t), t * t * (t - 1.0));
            let x_m = start * from.0 + into * from.2 + stop * to.0 + out * to.2;
            let y_m = start * from.1 + into * from.3 + stop * to.1 + out * to.3;
            (x_m * 1e3, y_m * 1e3)
        }));
        before = end;
    }
    points
}

/// The figure of the sessions' names, shapes and errors.
pub fn figure<'s>(sessions: impl Iterator<Item = (&'s str, &'s Shapes, &'s ErrorMetrics)>) -> Figure {
    let mut panels = Vec::new();
    let (mut has_errors, mut leading) = (false, Method::Fusion);
    for (name, shapes, errors) in sessions {
        panels.extend(shapes.panels(name, errors));
        has_errors |= shapes.worst.is_some();
        leading = shapes.leading;
    }
    let moments = if has_errors {
        format!(
            "The moments of a session with truth are those of its largest {leading} error at the tip and, of some hundred \
             samples evenly spaced in time, those whose error is nearest to the quartiles. Circles are about the tip of an \
             estimate; their radius is the 75th percentile of its tip error in this session.",
            leading = leading.name()
        )
    } else {
        "There is no truth; the moments are evenly spaced.".to_owned()
    };
    Figure {
        name: "shapes",
        title: "Shapes of the arm",
        caption: format!(
            "The arm in the world frame, base at the origin, and below it the same moments magnified about the tip, with the 95 % \
             ellipse that fusion states. A millimetre is as long on both axes. {moments}"
        ),
        is_drawn: !panels.is_empty(),
        panels,
    }
}
