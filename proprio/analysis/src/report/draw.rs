//! A panel as SVG.
//!
//! Plotters draws in whole units, so a unit is a tenth of a pixel; the page scales the drawing. Colours are those of
//! light pages; the style sheet replaces them by what they mean.

use std::cmp::Reverse;

use estimator_core::Method;
use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{
    Cartesian2d, Circle, DrawingArea, EmptyElement, IntoDrawingArea, PathElement, Polygon, SVGBackend,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, RGBColor, ShapeStyle, TextStyle};

use super::legend::{ROW_PX, legend};
use super::plot::{Colour, Marks, Panel, Series, Size};

/// Units of the drawing in a pixel.
pub const PX: i32 = 10;
/// Text, px.
const TEXT_PX: i32 = 13;
/// Room for labels left of and below the axes, px.
const LABELS_PX: [i32; 2] = [62, 44];
/// Room on all other sides, px.
pub const MARGIN_PX: i32 = 10;
/// Half the width of a box on an axis of names.
const HALF_BOX: f64 = 0.27;
/// A star's corners about its middle, tenths of its radius.
const STAR: [(i32, i32); 10] =
    [(0, -10), (2, -3), (10, -3), (4, 1), (6, 8), (0, 4), (-6, 8), (-4, 1), (-10, -3), (-2, -3)];

pub type Area<'s> = DrawingArea<SVGBackend<'s>, Shift>;
type Chart<'c, 's> = ChartContext<'c, SVGBackend<'s>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

impl Size {
    /// Width and height, px.
    pub const fn px(self) -> [i32; 2] {
        match self {
            Self::Half => [560, 360],
            Self::Third => [380, 300],
            Self::Quarter => [300, 420],
        }
    }

    /// Rows of the legend that there is room for at least, so that plots of one size are alike.
    const fn legend_rows(self) -> i32 {
        match self {
            Self::Half | Self::Third => 1,
            Self::Quarter => 3,
        }
    }
}

impl Colour {
    /// Those that differ in their [`Colour::rgb`].
    pub const ALL: [Self; 7] = [
        Self::Of(Method::Bend),
        Self::Of(Method::ImuO),
        Self::Of(Method::ImuC),
        Self::Of(Method::Fusion),
        Self::Smoothed,
        Self::Ink,
        Self::Grid,
    ];

    /// Okabe and Ito's palette, which colour-blind readers can tell apart.
    pub const fn rgb(self) -> [u8; 3] {
        match self {
            Self::Of(Method::Bend) => [0xE6, 0x9F, 0x00],
            Self::Of(Method::ImuO) => [0xD5, 0x5E, 0x00],
            Self::Of(Method::ImuC) => [0x00, 0x9E, 0x73],
            Self::Of(Method::Fusion) => [0x00, 0x72, 0xB2],
            Self::Smoothed => [0xCC, 0x79, 0xA7],
            Self::Truth | Self::Ink => [0x1A, 0x1A, 0x1A],
            Self::Grid => [0xDD, 0xDD, 0xDD],
        }
    }

    pub fn drawn(self) -> RGBColor {
        let [r, g, b] = self.rgb();
        RGBColor(r, g, b)
    }

    pub fn stroke(self, tenths_px: u32) -> ShapeStyle {
        self.drawn().stroke_width(tenths_px)
    }

    /// The truth is a broad light band, so that an estimate shows inside it; fusion is broader than imu_c, which is often
    /// as good.
    pub fn line(self) -> ShapeStyle {
        match self {
            Self::Truth => self.drawn().mix(0.35).stroke_width(45),
            Self::Of(Method::Fusion) => self.stroke(26),
            _ => self.stroke(14),
        }
    }
}

/// Draws a panel.
///
/// # Panics
/// Never: a drawing in memory does not fail.
pub fn svg(panel: &Panel) -> String {
    let mut svg = String::new();
    draw(panel, &mut svg).expect("a drawing in memory does not fail");
    svg
}

fn draw(panel: &Panel, svg: &mut String) -> Drawn {
    let [width, height] = panel.size.px().map(|px| (px * PX) as u32);
    let root = SVGBackend::with_string(svg, (width, height)).into_drawing_area();
    let keys = legend(panel);
    let rows = keys.last().map_or(0, |key| key.row + 1).max(panel.size.legend_rows());
    let (top, plot) = root.split_vertically((MARGIN_PX / 2 + rows * ROW_PX) * PX);
    keys.iter().try_for_each(|key| key.draw(&top))?;
    draw_plot(&plot, panel)?;
    Ok(root.present()?)
}

fn draw_plot(area: &Area, panel: &Panel) -> Drawn {
    let [left, bottom] = LABELS_PX.map(|px| px * PX);
    let margin = MARGIN_PX * PX;
    let (x, y) = ranges(area, panel);
    let mut chart = ChartBuilder::on(area)
        .margin(margin)
        .x_label_area_size(bottom)
        .y_label_area_size(left)
        .build_cartesian_2d(x[0]..x[1], y[0]..y[1])?;
    let (names, text) = (panel.x.names, text(HPos::Center, VPos::Center));
    let number = |value: &f64| number(*value);
    let name = |value: &f64| names.get(value.round() as usize).map_or_else(String::new, |name| (*name).to_owned());
    let mut mesh = chart.configure_mesh();
    mesh.axis_style(Colour::Ink.stroke(10))
        .bold_line_style(Colour::Grid.stroke(8))
        .max_light_lines(0)
        .label_style(text.clone())
        .axis_desc_style(text)
        .set_all_tick_mark_size(4 * PX)
        .x_desc(panel.x.title)
        .y_desc(panel.y.title)
        .x_labels(if panel.size == Size::Half { 8 } else { 5 })
        .y_labels(if panel.size == Size::Third { 6 } else { 8 })
        .y_label_formatter(&number);
    if names.is_empty() {
        mesh.x_label_formatter(&number).draw()?;
    } else {
        mesh.x_labels(names.len()).disable_x_mesh().x_label_formatter(&name).draw()?;
    }
    let mut layers: Vec<&Series> = panel.series.iter().collect();
    layers.sort_by_key(|series| layer(series));
    layers.into_iter().try_for_each(|series| draw_series(&mut chart, series))
}

/// Which marks lie over which: areas below, then lines, broad ones first.
fn layer(series: &Series) -> (u8, Reverse<u32>) {
    match series.marks {
        Marks::Band { .. } | Marks::Box { .. } => (0, Reverse(0)),
        Marks::Dots { .. } => (1, Reverse(0)),
        Marks::Line { .. } => (2, Reverse(series.colour.line().stroke_width)),
        Marks::Circle { .. } => (3, Reverse(0)),
    }
}

/// Ranges of both axes; of a shape, grown so that a millimetre is as long on both.
fn ranges(area: &Area, panel: &Panel) -> ([f64; 2], [f64; 2]) {
    let (x, y) = (panel.x.range, panel.y.range);
    if panel.size != Size::Quarter {
        return (x, y);
    }
    let (width, height) = area.dim_in_pixel();
    let inside = [width as i32, height as i32].map(|units| units - 2 * MARGIN_PX * PX);
    let [width, height] = [inside[0] - LABELS_PX[0] * PX, inside[1] - LABELS_PX[1] * PX].map(f64::from);
    let per_unit = ((x[1] - x[0]) / width).max((y[1] - y[0]) / height);
    let grown = |[from, to]: [f64; 2], units: f64| {
        let (middle, half) = (f64::midpoint(from, to), per_unit * units / 2.0);
        [middle - half, middle + half]
    };
    (grown(x, width), grown(y, height))
}

fn draw_series(chart: &mut Chart<'_, '_>, series: &Series) -> Drawn {
    let colour = series.colour;
    match &series.marks {
        Marks::Line { points, .. } => {
            let style = colour.line();
            for run in runs(points) {
                chart.draw_series([PathElement::new(run, style)])?;
            }
        }
        Marks::Band { points, .. } => {
            for run in runs(points) {
                let low = run.iter().map(|(x, [low, _])| (*x, *low));
                let high = run.iter().rev().map(|(x, [_, high])| (*x, *high));
                chart.draw_series([Polygon::new(low.chain(high).collect::<Vec<_>>(), colour.drawn().mix(0.22))])?;
            }
        }
        Marks::Dots { points, .. } => {
            let radius = if points.len() > 100 { 12 } else { 25 };
            let style = colour.drawn().mix(0.6).filled();
            chart.draw_series(points.iter().map(|point| Circle::new(*point, radius, style)))?;
        }
        Marks::Circle { center_x_mm, center_y_mm, radius_mm } => {
            let area = chart.plotting_area();
            let (from, to) = (area.get_x_range().start, area.get_x_range().end);
            let units = radius_mm / (to - from) * f64::from(area.dim_in_pixel().0);
            let center = (*center_x_mm, *center_y_mm);
            chart.draw_series([Circle::new(center, units.round() as u32, colour.stroke(15))])?;
        }
        Marks::Box { place, low_mm, quartile1_mm, median_mm, quartile3_mm, high_mm, rmse_mm, .. } => {
            let (left, right) = (place - HALF_BOX, place + HALF_BOX);
            let outline = rectangle((left, *quartile1_mm), (right, *quartile3_mm));
            chart.draw_series([Polygon::new(outline.clone(), colour.drawn().mix(0.3))])?;
            let across = |y: f64, half: f64| vec![(place - half, y), (place + half, y)];
            let up = |from: f64, to: f64| vec![(*place, from), (*place, to)];
            let thin = [
                outline,
                across(*low_mm, 0.12),
                across(*high_mm, 0.12),
                up(*low_mm, *quartile1_mm),
                up(*quartile3_mm, *high_mm),
            ];
            chart.draw_series(thin.map(|path| PathElement::new(path, colour.stroke(15))))?;
            chart.draw_series([PathElement::new(across(*median_mm, HALF_BOX), colour.stroke(30))])?;
            chart.draw_series([EmptyElement::at((*place, *rmse_mm)) + star(Colour::Ink)])?;
        }
    }
    Ok(())
}

/// Stretches of points without a gap.
fn runs<T: Copy>(points: &[(f64, Option<T>)]) -> impl Iterator<Item = Vec<(f64, T)>> {
    let stretches = points.split(|(_, value)| value.is_none()).filter(|run| !run.is_empty());
    stretches.map(|run| run.iter().filter_map(|(x, value)| Some((*x, (*value)?))).collect())
}

pub fn rectangle<T: Copy>((left, top): (T, T), (right, bottom): (T, T)) -> Vec<(T, T)> {
    vec![(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]
}

pub fn star(colour: Colour) -> Polygon<(i32, i32)> {
    Polygon::new(STAR.map(|(x, y)| (x * PX * 7 / 10, y * PX * 7 / 10)), colour.drawn().filled())
}

/// Plotters draws text 1.24 times smaller than it is asked to.
pub fn text(horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    let style = ("sans-serif", f64::from(TEXT_PX * PX) * 1.24).into_font().color(&Colour::Ink.drawn());
    style.pos(Pos::new(horizontal, vertical))
}

/// A tick's number without digits that say nothing.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.replace('-', "\u{2212}") }
}
