//! The legend above a panel's plot: a sign and a name for each colour.

use plotters::prelude::{Circle, EmptyElement, PathElement, Polygon};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{Area, Drawn, MARGIN_PX, PX, rectangle, star, text};
use super::plot::{Colour, Marks, Panel};

/// Room for a character of a name, px, which is wide enough for any usual sans-serif font.
const CHARACTER_PX: f64 = 7.2;
/// Height of a row, px.
pub const ROW_PX: i32 = 20;
/// Length of a sign, px.
const SIGN_PX: i32 = 22;

/// One entry of the legend.
pub struct Key<'p> {
    name: &'p str,
    colour: Colour,
    sign: Sign,
    left_px: i32,
    /// Row of the legend, from 0.
    pub row: i32,
}

#[derive(Clone, Copy, PartialEq)]
enum Sign {
    Line,
    Dot,
    Ring,
    Box,
    Star,
}

/// A key for each name; boxes have stars too.
pub fn legend(panel: &Panel) -> Vec<Key<'_>> {
    let first_px = MARGIN_PX;
    let mut keys: Vec<Key> = Vec::new();
    let mut next = (first_px, 0);
    // Rows have their names on the axis.
    let named = panel.series.iter().filter(|series| !matches!(series.marks, Marks::Strip { .. }));
    let signs = named.map(|series| (series.name.as_str(), series.colour, sign(&series.marks)));
    let star = panel.series.iter().any(|series| sign(&series.marks) == Sign::Box);
    for (name, colour, sign) in signs.chain(star.then_some(("RMSE", Colour::Ink, Sign::Star))) {
        if keys.iter().any(|key| key.name == name) {
            continue;
        }
        let room_px = SIGN_PX + (name.chars().count() as f64 * CHARACTER_PX) as i32 + 14;
        if next.0 + room_px > panel.size.px()[0] && next.0 > first_px {
            next = (first_px, next.1 + 1);
        }
        keys.push(Key { name, colour, sign, left_px: next.0, row: next.1 });
        next.0 += room_px;
    }
    keys
}

const fn sign(marks: &Marks) -> Sign {
    match marks {
        Marks::Line { .. } | Marks::Band { .. } | Marks::Strip { .. } => Sign::Line,
        Marks::Dots { .. } => Sign::Dot,
        Marks::Circle { .. } => Sign::Ring,
        Marks::Box { .. } => Sign::Box,
    }
}

impl Key<'_> {
    pub fn draw(&self, area: &Area) -> Drawn {
        let (left, y) = (self.left_px * PX, (MARGIN_PX / 2 + self.row * ROW_PX + ROW_PX / 2) * PX);
        let (right, middle) = (left + SIGN_PX * PX, left + SIGN_PX * PX / 2);
        let colour = self.colour;
        match self.sign {
            Sign::Line => area.draw(&PathElement::new(vec![(left, y), (right, y)], colour.line()))?,
            Sign::Dot => area.draw(&Circle::new((middle, y), 3 * PX, colour.drawn().filled()))?,
            Sign::Ring => area.draw(&Circle::new((middle, y), 7 * PX, colour.stroke(15)))?,
            Sign::Box => {
                let (from, to) = ((middle - 8 * PX, y - 6 * PX), (middle + 8 * PX, y + 6 * PX));
                area.draw(&Polygon::new(rectangle(from, to), colour.drawn().mix(0.3)))?;
                area.draw(&PathElement::new(rectangle(from, to), colour.stroke(15)))?;
            }
            Sign::Star => area.draw(&(EmptyElement::at((middle, y)) + star(colour)))?,
        }
        Ok(area.draw_text(self.name, &text(HPos::Left, VPos::Center), (right + 5 * PX, y))?)
    }
}
