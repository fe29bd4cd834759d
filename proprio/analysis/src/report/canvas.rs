//! Units, colours and shapes of the drawings.

use estimator_core::Method;
use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, Polygon, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, RGBColor, ShapeStyle, TextStyle};

use super::plot::{Colour, Size};

/// Units of the drawing in a pixel.
pub const PX: i32 = 10;
/// Text, px.
const TEXT_PX: i32 = 13;
/// Room on all other sides, px.
pub const MARGIN_PX: i32 = 10;
/// A star's corners about its middle, tenths of its radius.
const STAR: [(i32, i32); 10] =
    [(0, -10), (2, -3), (10, -3), (4, 1), (6, 8), (0, 4), (-6, 8), (-4, 1), (-10, -3), (-2, -3)];

/// Area of a drawing.
pub type Area<'s> = DrawingArea<SVGBackend<'s>, Shift>;
/// Result of drawing.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

impl Size {
    /// Width and height, px.
    pub const fn px(self) -> [i32; 2] {
        match self {
            Self::Half => [480, 320],
            Self::Third => [380, 300],
            Self::Quarter => [300, 420],
            Self::Square => [300, 330],
            Self::Column => [391, 300],
            Self::Page => [820, 330],
        }
    }

    /// Fewest rows of the legend, so that plots of one size have the same layout.
    pub const fn legend_rows(self) -> i32 {
        match self {
            Self::Half | Self::Third | Self::Column | Self::Page => 1,
            Self::Quarter | Self::Square => 3,
        }
    }
}

impl Colour {
    /// The colours that differ in their [`Colour::rgb`].
    pub const ALL: [Self; 7] = [
        Self::Of(Method::Bend),
        Self::Of(Method::ImuO),
        Self::Of(Method::ImuC),
        Self::Of(Method::Fusion),
        Self::Smoothed,
        Self::Ink,
        Self::Grid,
    ];

    /// Okabe and Ito's palette, which colour-blind readers can distinguish.
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

pub fn rectangle<T: Copy>((left, top): (T, T), (right, bottom): (T, T)) -> Vec<(T, T)> {
    vec![(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]
}

pub fn star(colour: Colour) -> Polygon<(i32, i32)> {
    Polygon::new(STAR.map(|(x, y)| (x * PX * 7 / 10, y * PX * 7 / 10)), colour.drawn().filled())
}

/// Style of a text. Plotters draws text 1.24 times smaller than requested.
pub fn text(horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    let style = ("sans-serif", f64::from(TEXT_PX * PX) * 1.24).into_font().color(&Colour::Ink.drawn());
    style.pos(Pos::new(horizontal, vertical))
}
