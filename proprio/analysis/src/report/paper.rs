//! Figures as single SVG files for a paper: as wide as a column or a page of two, with text of 8 pt.

use super::draw;
use super::plot::{Figure, Panel, Size};

/// Length of a pixel in print, mm: text of 13 px is 8 pt high.
const MM_PER_PX: f64 = 8.0 / 13.0 * 25.4 / 72.0;
/// Fonts that publishers take.
const FONTS: &str = "Arial, Helvetica, sans-serif";

/// A file of one figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PaperFigure {
    /// Its name: figure, session and panel.
    pub name: String,
    /// The drawing.
    pub svg: String,
}

/// The panels of the page's figures, each as a drawing of its own. Names differ.
pub fn figures(figures: &[Figure]) -> Vec<PaperFigure> {
    let mut files: Vec<PaperFigure> = Vec::new();
    for figure in figures.iter().filter(|figure| figure.is_drawn) {
        for panel in &figure.panels {
            let session = panel.session.as_deref().map_or("all", stem);
            let parts = [figure.name, session, &panel.name].into_iter().filter(|part| !part.is_empty());
            let name = parts.map(plain).collect::<Vec<_>>().join("-");
            let is_taken = files.iter().any(|file| file.name == format!("{name}.svg"));
            let name = if is_taken { format!("{name}-{}", files.len() + 1) } else { name };
            files.push(PaperFigure { name: format!("{name}.svg"), svg: svg(panel) });
        }
    }
    files
}

/// The drawing of a panel in a size for print: curves over time across the page, other plots in a column.
fn svg(panel: &Panel) -> String {
    let size = match panel.size {
        Size::Half if panel.x.names.is_empty() => Size::Page,
        size @ (Size::Quarter | Size::Square) => size,
        _ => Size::Column,
    };
    let drawing = draw::svg(&Panel { size, ..panel.clone() });
    let [width, height] = size.px().map(|px| f64::from(px) * MM_PER_PX);
    let fonts = drawing.replace("font-family=\"sans-serif\"", &format!("font-family=\"{FONTS}\""));
    // The drawing's own size, in units, ends before its box of units.
    let rest = fonts.split_once("viewBox").map_or("", |(_, rest)| rest);
    format!("<svg width=\"{width:.1}mm\" height=\"{height:.1}mm\" viewBox{rest}")
}

/// The name of a session's file without its folder and ending.
fn stem(session: &str) -> &str {
    std::path::Path::new(session).file_stem().and_then(|stem| stem.to_str()).unwrap_or(session)
}

/// A part of a file's name: letters, digits and underscores, others become hyphens.
fn plain(part: &str) -> String {
    part.chars().map(|letter| if letter.is_ascii_alphanumeric() || letter == '_' { letter } else { '-' }).collect()
}
