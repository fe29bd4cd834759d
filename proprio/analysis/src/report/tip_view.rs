//! The neighbourhood of the tip, magnified: lines cut at its border, and the 95 % ellipse.

use proprio_session::Ellipse;

use super::plot::{Marks, Series, rounded};

/// Points of a drawn ellipse.
const ELLIPSE_POINTS: u32 = 48;

/// A square about the tip, mm.
#[derive(Debug, Clone, Copy)]
pub struct View {
    pub center_mm: (f64, f64),
    /// Half of its side.
    pub half_mm: f64,
}

impl View {
    pub fn ranges(&self) -> [[f64; 2]; 2] {
        let range = |middle: f64| [middle - self.half_mm, middle + self.half_mm];
        [range(self.center_mm.0), range(self.center_mm.1)]
    }

    fn has(&self, (x, y): (f64, f64)) -> bool {
        (x - self.center_mm.0).abs() <= self.half_mm && (y - self.center_mm.1).abs() <= self.half_mm
    }

    /// The parts of the series that are inside. Circles are left out.
    pub fn cut(&self, series: &Series) -> Option<Series> {
        let marks = match &series.marks {
            Marks::Line { x, y, points } => {
                let points = self.cut_line(points);
                (!points.is_empty()).then_some(Marks::Line { x, y, points })
            }
            Marks::Dots { x, y, points } => {
                let points: Vec<_> = points.iter().copied().filter(|point| self.has(*point)).collect();
                (!points.is_empty()).then_some(Marks::Dots { x, y, points })
            }
            Marks::Band { .. } | Marks::Strip { .. } | Marks::Circle { .. } | Marks::Box { .. } => None,
        };
        marks.map(|marks| Series { name: series.name.clone(), colour: series.colour, marks })
    }

    /// A line's parts inside, with a gap between two of them.
    fn cut_line(&self, points: &[(f64, Option<f64>)]) -> Vec<(f64, Option<f64>)> {
        let mut cut: Vec<(f64, Option<f64>)> = Vec::new();
        for pair in points.windows(2) {
            let [(x0, Some(y0)), (x1, Some(y1))] = pair else { continue };
            let Some([from, to]) = self.cut_segment((*x0, *y0), (*x1, *y1)) else { continue };
            let [from, to] = [from, to].map(|(x, y)| (rounded(x), Some(rounded(y))));
            if cut.last() != Some(&from) {
                cut.extend((!cut.is_empty()).then_some((from.0, None)));
                cut.push(from);
            }
            cut.push(to);
        }
        cut
    }

    /// The part of a straight line that is inside (Liang–Barsky).
    fn cut_segment(&self, from: (f64, f64), to: (f64, f64)) -> Option<[(f64, f64); 2]> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let [[left, right], [bottom, top]] = self.ranges();
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (step, room) in [(-dx, from.0 - left), (dx, right - from.0), (-dy, from.1 - bottom), (dy, top - from.1)] {
            if step == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if step < 0.0 {
                enter = enter.max(room / step);
            } else {
                leave = leave.min(room / step);
            }
        }
        let at = |t: f64| (from.0 + t * dx, from.1 + t * dy);
        (enter < leave).then(|| [at(enter), at(leave)])
    }
}

/// The ellipse about a point of this covariance, m², in which the true one is with a probability of 95 %.
pub fn ellipse((x_mm, y_mm): (f64, f64), covariance_m2: [f64; 3]) -> Marks {
    let Ellipse { major_mm, minor_mm } = Ellipse::of(covariance_m2);
    let (sin, cos) = Ellipse::turn_rad(covariance_m2).sin_cos();
    let point = |k: u32| {
        let (across, along) = (std::f64::consts::TAU * f64::from(k) / f64::from(ELLIPSE_POINTS)).sin_cos();
        let (along, across) = (along * major_mm, across * minor_mm);
        (rounded(x_mm + cos * along - sin * across), Some(rounded(y_mm + sin * along + cos * across)))
    };
    Marks::Line { x: "x_mm", y: "y_mm", points: (0..=ELLIPSE_POINTS).map(point).collect() }
}

#[cfg(test)]
mod tests {
    use super::View;

    const VIEW: View = View { center_mm: (10.0, 20.0), half_mm: 5.0 };

    #[test]
    fn a_line_through_the_view_is_cut_at_its_border() {
        let line = [(0.0, Some(20.0)), (30.0, Some(20.0))];
        assert_eq!(VIEW.cut_line(&line), [(5.0, Some(20.0)), (15.0, Some(20.0))]);
        assert_eq!(VIEW.cut_line(&[(0.0, Some(0.0)), (30.0, Some(0.0))]), []);
    }

    #[test]
    fn a_line_that_comes_back_has_a_gap() {
        let line = [(10.0, Some(20.0)), (10.0, Some(40.0)), (12.0, Some(40.0)), (12.0, Some(20.0))];
        let cut = VIEW.cut_line(&line);
        assert_eq!(cut, [(10.0, Some(20.0)), (10.0, Some(25.0)), (12.0, None), (12.0, Some(25.0)), (12.0, Some(20.0))]);
    }
}
