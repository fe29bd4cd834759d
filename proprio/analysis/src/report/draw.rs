//! A panel as SVG.
//!
//! Plotters draws in whole units, so a unit is a tenth of a pixel; the page scales the drawing. Colours are those of
//! light pages; the style sheet replaces them by their meanings.

use std::cmp::Reverse;

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::ranged1d::ValueFormatter;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{
    Cartesian2d, Circle, EmptyElement, IntoDrawingArea, IntoLogRange, PathElement, Polygon, Ranged, SVGBackend,
};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{Area, Drawn, MARGIN_PX, PX, rectangle, star, text};
use super::legend::{ROW_PX, legend};
use super::plot::{Colour, Marks, Panel, Series, Size};

/// Room for labels left of and below the axes, px.
const LABELS_PX: [i32; 2] = [62, 44];
/// Room right of the plot, for half of the last label, px.
const RIGHT_PX: i32 = 18;
/// Half the width of a box on an axis of names.
const HALF_BOX: f64 = 0.27;
/// Height of a strip in its row.
const STRIP: f64 = 0.8;

type Chart<'c, 's, Y> = ChartContext<'c, SVGBackend<'s>, Cartesian2d<RangedCoordf64, Y>>;
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
    let (x, y) = ranges(area, panel);
    let mut builder = ChartBuilder::on(area);
    builder.margin(MARGIN_PX * PX).margin_right(RIGHT_PX * PX).x_label_area_size(bottom).y_label_area_size(left);
    if panel.y.is_log {
        draw_chart(builder.build_cartesian_2d(x[0]..x[1], (y[0]..y[1]).log_scale())?, panel)
    } else {
        draw_chart(builder.build_cartesian_2d(x[0]..x[1], y[0]..y[1])?, panel)
    }
}

fn draw_chart<Y>(mut chart: Chart<'_, '_, Y>, panel: &Panel) -> Drawn
where
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let (names, text) = (panel.x.names, text(HPos::Center, VPos::Center));
    let number = |value: &f64| number(*value);
    let name = |value: &f64| name(names, *value);
    let row = |value: &f64| self::name(panel.y.names, *value);
    let mut mesh = chart.configure_mesh();
    mesh.axis_style(Colour::Ink.stroke(10))
        .bold_line_style(Colour::Grid.stroke(8))
        .light_line_style(Colour::Grid.stroke(8))
        .max_light_lines(0)
        .label_style(text.clone())
        .axis_desc_style(text)
        .set_all_tick_mark_size(4 * PX)
        .x_desc(panel.x.title)
        .y_desc(panel.y.title)
        .x_labels(if matches!(panel.size, Size::Half | Size::Page) { 8 } else { 5 })
        .y_labels(if matches!(panel.size, Size::Third | Size::Column | Size::Square) { 6 } else { 8 })
        .y_label_formatter(if panel.y.names.is_empty() { &number } else { &row });
    if names.is_empty() {
        mesh.x_label_formatter(&number).draw()?;
    } else {
        mesh.x_labels(names.len()).disable_x_mesh().x_label_formatter(&name).draw()?;
    }
    let mut layers: Vec<&Series> = panel.series.iter().collect();
    layers.sort_by_key(|series| layer(series));
    let floor = if panel.y.is_log { panel.y.range[0] } else { f64::NEG_INFINITY };
    layers.into_iter().try_for_each(|series| draw_series(&mut chart, series, floor))
}

/// Layer of the marks: areas below, then lines, broad ones first.
fn layer(series: &Series) -> (u8, Reverse<u32>) {
    match series.marks {
        Marks::Band { .. } | Marks::Strip { .. } | Marks::Box { .. } => (0, Reverse(0)),
        Marks::Dots { .. } => (1, Reverse(0)),
        Marks::Line { .. } => (2, Reverse(series.colour.line().stroke_width)),
        Marks::Circle { .. } => (3, Reverse(0)),
    }
}

/// Ranges of both axes; of a shape, grown so that a millimetre is as long on both.
fn ranges(area: &Area, panel: &Panel) -> ([f64; 2], [f64; 2]) {
    let (x, y) = (panel.x.range, panel.y.range);
    if !matches!(panel.size, Size::Quarter | Size::Square) {
        return (x, y);
    }
    let (width, height) = area.dim_in_pixel();
    let inside = [width as i32 - (MARGIN_PX + RIGHT_PX) * PX, height as i32 - 2 * MARGIN_PX * PX];
    let [width, height] = [inside[0] - LABELS_PX[0] * PX, inside[1] - LABELS_PX[1] * PX].map(f64::from);
    let per_unit = ((x[1] - x[0]) / width).max((y[1] - y[0]) / height);
    let grown = |[from, to]: [f64; 2], units: f64| {
        let (middle, half) = (f64::midpoint(from, to), per_unit * units / 2.0);
        [middle - half, middle + half]
    };
    (grown(x, width), grown(y, height))
}

/// Draws the marks; of lines and areas nothing below `floor`, which a logarithmic axis cannot show.
fn draw_series<Y: Ranged<ValueType = f64>>(chart: &mut Chart<'_, '_, Y>, series: &Series, floor: f64) -> Drawn {
    let colour = series.colour;
    match &series.marks {
        Marks::Line { points, .. } => {
            let style = colour.line();
            for run in runs(points) {
                let run: Vec<_> = run.into_iter().map(|(x, y)| (x, y.max(floor))).collect();
                chart.draw_series([PathElement::new(run, style)])?;
            }
        }
        Marks::Band { points, .. } => {
            for run in runs(points) {
                let low = run.iter().map(|(x, [low, _])| (*x, low.max(floor)));
                let high = run.iter().rev().map(|(x, [_, high])| (*x, high.max(floor)));
                chart.draw_series([Polygon::new(low.chain(high).collect::<Vec<_>>(), colour.drawn().mix(0.22))])?;
            }
        }
        Marks::Strip { row, points, .. } => {
            let colour = colour.drawn().mix(0.7).filled();
            for run in runs(points).filter(|run| run.len() > 1) {
                let (first, last) = (run[0].0, run[run.len() - 1].0);
                let top = run.into_iter().map(|(x, percent)| (x, row + percent / 100.0 * STRIP));
                let outline = [(first, *row)].into_iter().chain(top).chain([(last, *row)]);
                chart.draw_series([Polygon::new(outline.collect::<Vec<_>>(), colour)])?;
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

/// The name at a whole number.
fn name(names: &[&str], value: f64) -> String {
    let place = value.round();
    let name = names.get(place as usize).filter(|_| (value - place).abs() < 1e-6);
    name.map_or_else(String::new, |name| (*name).to_owned())
}

/// A tick's number without trailing zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.replace('-', "\u{2212}") }
}
