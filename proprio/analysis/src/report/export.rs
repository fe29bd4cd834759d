//! Export of a report's numbers: nested as JSON, one row per number as CSV.

use csv::Writer;
use estimator_core::Method;

use super::Report;
use super::plot::{Figure, Marks, Panel, SMOOTHED};
use crate::metrics::Metrics;
use crate::session_metrics::ByMethod;

/// The CSV's columns.
const COLUMNS: [&str; 8] = ["figure", "session", "panel", "series", "x_quantity", "x", "y_quantity", "y"];

/// The first cells of a row.
type Place<'p> = [&'p str; 4];

impl Report {
    /// All numbers as JSON, with a line end.
    ///
    /// # Panics
    /// Never: numbers and names have a form in JSON.
    #[must_use]
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("numbers and names have a form in JSON") + "\n"
    }

    /// All numbers as CSV. The session's name is empty in rows of all sessions together.
    ///
    /// # Panics
    /// Never: a table in memory does not fail.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut rows = Rows(Writer::from_writer(Vec::new()));
        rows.write(COLUMNS);
        for session in &self.numbers.sessions {
            rows.figures("table", &session.path, &session.metrics);
        }
        rows.figures("table", "", &self.numbers.all);
        if let Some(other) = &self.comparison {
            for session in &other.sessions {
                rows.figures("other_table", &session.path, &session.metrics);
            }
            rows.figures("other_table", "", &other.all);
        }
        for figure in &self.figures {
            figure.panels.iter().for_each(|panel| rows.panel(figure, panel));
        }
        let bytes = rows.0.into_inner().expect("a table in memory does not fail");
        String::from_utf8(bytes).expect("names and numbers are UTF-8")
    }
}

struct Rows(Writer<Vec<u8>>);

impl Rows {
    fn write(&mut self, cells: [&str; COLUMNS.len()]) {
        self.0.write_record(cells).expect("a table in memory does not fail");
    }

    /// One point.
    fn point(&mut self, [figure, session, panel, series]: Place, (x_name, x): (&str, f64), (y_name, y): (&str, f64)) {
        self.write([figure, session, panel, series, x_name, &x.to_string(), y_name, &y.to_string()]);
    }

    /// One number without an x value.
    fn number(&mut self, [figure, session, panel, series]: Place, name: &str, value: f64) {
        self.write([figure, session, panel, series, "", "", name, &value.to_string()]);
    }

    fn figures(&mut self, figure: &str, session: &str, figures: &ByMethod) {
        for (method, of) in Method::ALL.iter().zip(&figures.methods) {
            self.errors([figure, session, "", method.name()], of);
        }
        if let Some(smoothed) = &figures.smoothed {
            let place = [figure, session, "", SMOOTHED];
            self.errors(place, &smoothed.metrics);
            if let Some(inside_percent) = smoothed.uncertainty.and_then(|uncertainty| uncertainty.tip_inside_percent) {
                self.number(place, "tip_inside_percent", inside_percent);
            }
        }
        if let Some(inside_percent) = figures.uncertainty.and_then(|uncertainty| uncertainty.tip_inside_percent) {
            self.number([figure, session, "", Method::Fusion.name()], "tip_inside_percent", inside_percent);
        }
    }

    fn errors(&mut self, place: Place, of: &Metrics) {
        let numbers = [
            ("tip_rmse_mm", of.tip_rmse_mm),
            ("tip_rmse_percent", of.tip_rmse_percent),
            ("tip_p75_mm", of.tip_p75_mm),
            ("theta_rmse_deg", of.theta_rmse_deg),
        ];
        for (name, value) in numbers {
            if let Some(value) = value {
                self.number(place, name, value);
            }
        }
    }

    fn panel(&mut self, figure: &Figure, panel: &Panel) {
        let session = panel.session.as_deref().unwrap_or_default();
        for (name, value) in &panel.facts {
            self.number([figure.name, session, &panel.name, ""], name, *value);
        }
        for series in &panel.series {
            self.marks([figure.name, session, &panel.name, &series.name], &series.marks);
        }
    }

    fn marks(&mut self, place: Place, marks: &Marks) {
        match marks {
            Marks::Line { x, y, points } | Marks::Strip { x, y, points, .. } => {
                for (at, value) in points.iter().copied() {
                    if let Some(value) = value {
                        self.point(place, (x, at), (y, value));
                    }
                }
            }
            Marks::Band { x, low, high, points } => {
                for (at, range) in points {
                    if let Some([least, largest]) = *range {
                        self.point(place, (x, *at), (low, least));
                        self.point(place, (x, *at), (high, largest));
                    }
                }
            }
            Marks::Dots { x, y, points } => points.iter().for_each(|(px, py)| self.point(place, (x, *px), (y, *py))),
            Marks::Circle { center_x_mm, center_y_mm, radius_mm } => {
                self.point(place, ("center_x_mm", *center_x_mm), ("center_y_mm", *center_y_mm));
                self.number(place, "radius_mm", *radius_mm);
            }
            Marks::Box {
                samples, low_mm, quartile1_mm, median_mm, quartile3_mm, high_mm, largest_mm, rmse_mm, ..
            } => {
                self.number(place, "samples", *samples as f64);
                let numbers = [
                    ("low_mm", low_mm),
                    ("quartile1_mm", quartile1_mm),
                    ("median_mm", median_mm),
                    ("quartile3_mm", quartile3_mm),
                    ("high_mm", high_mm),
                    ("largest_mm", largest_mm),
                    ("rmse_mm", rmse_mm),
                ];
                for (name, value) in numbers {
                    self.number(place, name, *value);
                }
            }
        }
    }
}
