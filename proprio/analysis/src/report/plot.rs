//! Contents of a figure without its drawing: the numbers of the page, the JSON and the CSV.

use estimator_core::Method;
use serde::{Serialize, Serializer};

/// A figure of one or more panels.
#[derive(Debug, Serialize)]
pub struct Figure {
    /// Its name in JSON and CSV.
    #[serde(rename = "figure")]
    pub name: &'static str,
    pub title: &'static str,
    /// Description of the figure, with the number of samples.
    pub caption: String,
    /// True where the page shows it; else JSON and CSV alone have it.
    #[serde(skip)]
    pub is_drawn: bool,
    pub panels: Vec<Panel>,
}

/// One plot.
#[derive(Debug, Clone, Serialize)]
pub struct Panel {
    /// The session; `None` for all sessions together.
    pub session: Option<String>,
    /// Its subject in the session: a segment, a sensor, a moment; empty for the whole session.
    pub name: String,
    /// Title above the plot.
    pub title: String,
    /// Numbers about it, by their names with units.
    #[serde(serialize_with = "as_map")]
    pub facts: Vec<(&'static str, f64)>,
    #[serde(skip)]
    pub size: Size,
    #[serde(skip)]
    pub x: Axis,
    #[serde(skip)]
    pub y: Axis,
    pub series: Vec<Series>,
}

/// Width of a panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// Two in a row.
    Half,
    /// Three in a row.
    Third,
    /// Four in a row, tall, with equal scales of both axes.
    Quarter,
    /// Four in a row, square, with equal scales of both axes.
    Square,
    /// A column of a paper.
    Column,
    /// Both columns of a paper.
    Page,
}

/// An axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Title with the unit.
    pub title: &'static str,
    pub range: [f64; 2],
    /// Names instead of numbers, at 0, 1, …
    pub names: &'static [&'static str],
    /// Logarithmic; marks below the range are drawn at its begin.
    pub is_log: bool,
}

/// Marks of one colour.
#[derive(Debug, Clone, Serialize)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    #[serde(skip)]
    pub colour: Colour,
    #[serde(flatten)]
    pub marks: Marks,
}

/// Form in which numbers are drawn. The names of quantities are those of the CSV, with their unit.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Marks {
    /// A line, broken where there is no value.
    Line { x: &'static str, y: &'static str, points: Vec<(f64, Option<f64>)> },
    /// An area between two values.
    Band { x: &'static str, low: &'static str, high: &'static str, points: Vec<(f64, Option<[f64; 2]>)> },
    /// A share of time in a row of its own, % of the row's height.
    Strip {
        #[serde(skip)]
        row: f64,
        x: &'static str,
        y: &'static str,
        points: Vec<(f64, Option<f64>)>,
    },
    /// Single points.
    Dots { x: &'static str, y: &'static str, points: Vec<(f64, f64)> },
    /// A circle about a point, mm.
    Circle { center_x_mm: f64, center_y_mm: f64, radius_mm: f64 },
    /// A box plot at a place of the x axis, mm.
    Box {
        #[serde(skip)]
        place: f64,
        samples: u64,
        low_mm: f64,
        quartile1_mm: f64,
        median_mm: f64,
        quartile3_mm: f64,
        high_mm: f64,
        largest_mm: f64,
        rmse_mm: f64,
    },
}

/// Colours by meaning; the page's style sheet has them for light and dark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    Of(Method),
    Smoothed,
    Truth,
    Ink,
    Grid,
}

/// Estimates whose tip errors are shown: all methods, and the smoothed shape.
pub const ESTIMATES: [(&str, Colour); Method::ALL.len() + 1] = [
    (Method::Bend.name(), Colour::Of(Method::Bend)),
    (Method::ImuO.name(), Colour::Of(Method::ImuO)),
    (Method::ImuC.name(), Colour::Of(Method::ImuC)),
    (Method::Fusion.name(), Colour::Of(Method::Fusion)),
    (SMOOTHED, Colour::Smoothed),
];
/// Name of the smoothed shape.
pub const SMOOTHED: &str = "smoothed";

impl Axis {
    /// Numbers over `range`.
    pub fn new(title: &'static str, range: [f64; 2]) -> Self {
        Self { title, range, names: &[], is_log: false }
    }

    /// Positive numbers over `range`, on a logarithmic scale.
    pub fn log(title: &'static str, range: [f64; 2]) -> Self {
        Self { is_log: true, ..Self::new(title, range) }
    }
}

fn as_map<S: Serializer>(facts: &[(&'static str, f64)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(facts.iter().copied())
}

impl Marks {
    /// Points that an axis must have room for.
    fn points(&self) -> Vec<(f64, f64)> {
        match self {
            Self::Line { points, .. } => points.iter().filter_map(|(x, y)| Some((*x, (*y)?))).collect(),
            Self::Band { points, .. } => points
                .iter()
                .filter_map(|(x, range)| Some((*x, (*range)?)))
                .flat_map(|(x, [a, b])| [(x, a), (x, b)])
                .collect(),
            Self::Strip { row, points, .. } => points.iter().flat_map(|(x, _)| [(*x, *row), (*x, row + 1.0)]).collect(),
            Self::Dots { points, .. } => points.clone(),
            Self::Circle { center_x_mm: x, center_y_mm: y, radius_mm: r } => vec![(x - r, y - r), (x + r, y + r)],
            Self::Box { place, low_mm, high_mm, rmse_mm, .. } => {
                vec![(*place, *low_mm), (*place, high_mm.max(*rmse_mm))]
            }
        }
    }
}

/// Extent of all series in x and y.
pub fn extent<'s>(series: impl IntoIterator<Item = &'s Series>) -> [[f64; 2]; 2] {
    let mut extents = [Extent::new(), Extent::new()];
    for (x, y) in series.into_iter().flat_map(|series| series.marks.points()) {
        extents.iter_mut().zip([x, y]).for_each(|(extent, value)| extent.add(value));
    }
    extents.map(Extent::range)
}

/// Least and largest of some numbers.
#[derive(Debug, Clone, Copy)]
struct Extent(f64, f64);

impl Extent {
    fn new() -> Self {
        Self(f64::INFINITY, f64::NEG_INFINITY)
    }

    fn add(&mut self, value: f64) {
        (self.0, self.1) = (self.0.min(value), self.1.max(value));
    }

    /// Never empty, so that an axis can be drawn.
    fn range(self) -> [f64; 2] {
        match self {
            Self(least, largest) if least < largest => [least, largest],
            Self(least, _) if least.is_finite() => [least - 1.0, least + 1.0],
            _ => [0.0, 1.0],
        }
    }
}

/// Gives panels that are compared one scale of y: the extent of all of theirs.
pub fn share_y<'p>(panels: impl Iterator<Item = &'p mut Panel>) {
    let panels: Vec<&mut Panel> = panels.collect();
    let mut extent = Extent::new();
    panels.iter().flat_map(|panel| panel.y.range).for_each(|value| extent.add(value));
    for panel in panels {
        panel.y.range = extent.range();
    }
}

/// A range with a margin at both ends.
pub fn padded([from, to]: [f64; 2]) -> [f64; 2] {
    let room = 0.04 * (to - from);
    [from - room, to + room]
}

/// Rounds to three decimals: finer than the drawing's resolution of millimetres, degrees and seconds.
pub fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}
