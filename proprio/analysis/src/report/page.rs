//! The page: one HTML file that needs nothing else, no network and no script.

use estimator_core::Method;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::plot::{Colour, ESTIMATES, Figure, Panel, SMOOTHED, Size};
use super::{Report, draw};
use crate::consistency::ConsistencyMetrics;
use crate::metrics::Metrics;
use crate::session_metrics::ByMethod;

const STYLE: &str = include_str!("style.css");

/// A group of the table's columns: its head and its metric.
type Group = (String, fn(&Metrics) -> Option<f64>);

impl Report {
    /// The page.
    #[must_use]
    pub fn html(&self) -> String {
        let title = format!("Report: {}", self.table.arm);
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (title) }
                    style { (PreEscaped(STYLE)) (PreEscaped(colours())) }
                }
                body {
                    (self.header(&title))
                    main {
                        (self.findings())
                        (self.table())
                        (self.covariances())
                        @for (number, figure) in (1..).zip(self.figures.iter().filter(|figure| figure.is_drawn)) { (section(number, figure)) }
                    }
                    footer { "proprio " (self.proprio) }
                }
            }
        };
        page.into_string() + "\n"
    }

    fn header(&self, title: &str) -> Markup {
        let table = &self.table;
        html! {
            header {
                h1 { (title) }
                dl {
                    dt { "Table" }
                    dd { (table.path) ", parameters at " (table.rate_hz) " Hz with CRC-32 " code { (table.crc32) } }
                    dt { "Arm" }
                    dd { (table.arm) ", " (counted(table.segments as u64, "segment")) ", " (table.length_mm) " mm" }
                    dt { "Sessions" }
                    dd {
                        ul {
                            @for session in &self.numbers.sessions {
                                li { (session.path) ": " (counted(session.samples, "sample")) ", " (format!("{:.1}", session.seconds)) " s" }
                            }
                        }
                    }
                    dt { "Made by" }
                    dd { "proprio " (self.proprio) ", in the board's fixed point" }
                    @if !self.missing.is_empty() {
                        dt { "Missing" }
                        dd { ul { @for missing in &self.missing { li { (missing) } } } }
                    }
                }
            }
        }
    }

    /// Faults of the sessions' sensors and times, where there are any.
    fn findings(&self) -> Markup {
        html! {
            @if !self.findings.is_empty() {
                section #findings {
                    h2 { "Findings of the session check" }
                    ul {
                        @for finding in &self.findings { li { (finding.session) ": " (finding.text) } }
                    }
                    p.caption { "The errors and figures below include these rows. " code { "proprio check" } " gives the remedies." }
                }
            }
        }
    }

    /// The table of the paper: one row per session, one column per method, and one of the smoothed shape where there is any.
    fn table(&self) -> Markup {
        let groups: [Group; 4] = [
            ("tip RMSE, mm".to_owned(), |figures| figures.tip_rmse_mm),
            (format!("tip RMSE, % of {} mm", self.table.length_mm), |figures| figures.tip_rmse_percent),
            ("tip 75th percentile, mm".to_owned(), |figures| figures.tip_p75_mm),
            ("bend angle RMSE, deg".to_owned(), |figures| figures.theta_rmse_deg),
        ];
        let samples = self.numbers.sessions.iter().map(|session| session.samples).sum();
        let count = if self.numbers.all.smoothed.is_some() { ESTIMATES.len() } else { Method::ALL.len() };
        let row = |name: &str, figures: &ByMethod| table_row(name, figures, &groups, count);
        html! {
            section #table {
                h2 { "Table 1. Errors by method" }
                div.wide {
                    table {
                        thead {
                            tr { th rowspan="2" scope="col" { "session" } @for (head, _) in &groups { th colspan=(count) scope="colgroup" { (head) } } }
                            tr { @for _ in &groups { @for (k, (name, _)) in ESTIMATES[..count].iter().enumerate() { th.(*name).first[k == 0] scope="col" { (name) } } } }
                        }
                        tbody {
                            @for session in &self.numbers.sessions { (row(&session.path, &session.metrics)) }
                        }
                        @if self.numbers.sessions.len() > 1 { tfoot { (row("all together", &self.numbers.all)) } }
                    }
                }
                p.caption {
                    "Against the truth, where it is known, over " (counted(samples, "sample")) ". bend: bend sensors alone; imu_o: raw IMUs; imu_c: IMUs whose drift bend \
                     sensors correct; fusion: Kalman filters over both"
                    @if count > Method::ALL.len() { "; smoothed: fusion by the readings after each sample, too" }
                    ". The best one is bold; a dash is what is not known."
                }
            }
        }
    }

    /// Consistency of the covariances, where there are any.
    fn covariances(&self) -> Markup {
        let of = |figures: &ByMethod| [figures.uncertainty, figures.smoothed.and_then(|smoothed| smoothed.uncertainty)];
        let heads: Vec<&str> = ["fusion", SMOOTHED]
            .into_iter()
            .zip(of(&self.numbers.all))
            .filter_map(|(head, all)| all.map(|_| head))
            .collect();
        let row = |name: &str, figures: &ByMethod| {
            html! {
                tr {
                    th scope="row" { (name) }
                    @for consistency in of(figures).iter().take(heads.len()) { (honesty_cells(consistency.as_ref())) }
                }
            }
        };
        html! {
            @if !heads.is_empty() {
                section #covariances {
                    h2 { "Table 2. Errors of the tip over what its covariances expect" }
                    div.wide {
                        table {
                            thead {
                                tr { th rowspan="2" scope="col" { "session" } @for head in &heads { th colspan="2" scope="colgroup" { (head) } } }
                                tr { @for _ in &heads { th.first scope="col" { "in 95 % ellipse" } th scope="col" { "NEES" } } }
                            }
                            tbody { @for session in &self.numbers.sessions { (row(&session.path, &session.metrics)) } }
                            @if self.numbers.sessions.len() > 1 { tfoot { (row("all together", &self.numbers.all)) } }
                        }
                    }
                    p.caption {
                        "Share of true tips inside the 95 % ellipse of their estimates, and mean normalised square error for each coordinate: \
                         1 is consistent, more is overconfident."
                    }
                }
            }
        }
    }
}

fn honesty_cells(consistency: Option<&ConsistencyMetrics>) -> Markup {
    let inside = consistency
        .and_then(|consistency| consistency.tip_inside_percent)
        .map_or("–".to_owned(), |share| format!("{share:.1} %"));
    let nees =
        consistency.and_then(|consistency| consistency.tip_nees).map_or("–".to_owned(), |nees| format!("{nees:.2}"));
    html! { td.first { (inside) } td { (nees) } }
}

fn table_row(name: &str, figures: &ByMethod, groups: &[Group], count: usize) -> Markup {
    html! {
        tr {
            th scope="row" { (name) }
            @for (_, figure) in groups {
                @let smoothed = figures.smoothed.and_then(|smoothed| figure(&smoothed.metrics));
                @let values: Vec<Option<f64>> = figures.methods.iter().map(figure).chain([smoothed]).take(count).collect();
                @let best = values.iter().flatten().copied().reduce(f64::min);
                @for (k, value) in values.iter().copied().enumerate() {
                    td.first[k == 0].best[value.is_some() && value == best] { (value.map_or("–".to_owned(), |value| format!("{value:.2}"))) }
                }
            }
        }
    }
}

fn section(number: usize, figure: &Figure) -> Markup {
    html! {
        section id=(figure.name) {
            h2 { "Figure " (number) ". " (figure.title) }
            @if figure.panels.is_empty() { p { "There is nothing to show: see what is missing, at the top." } }
            @for group in figure.panels.chunk_by(|a, b| a.name.is_empty() && b.name.is_empty() || a.session == b.session) {
                @if let [Panel { session: Some(session), name, .. }, ..] = group { @if !name.is_empty() { h3 { (session) } } }
                @for row in group.chunk_by(|a, b| a.size == b.size) {
                    div.plots.(class(row)) { @for panel in row { (plot(panel)) } }
                }
            }
            @if !figure.panels.is_empty() { p.caption { (figure.caption) } }
        }
    }
}

fn plot(panel: &Panel) -> Markup {
    html! {
        figure role="img" aria-label=(panel.title) {
            figcaption { (panel.title) }
            (PreEscaped(draw::svg(panel)))
        }
    }
}

/// CSS class of a row by its number of panels.
fn class(row: &[Panel]) -> &'static str {
    match row.first().map(|panel| panel.size) {
        Some(Size::Quarter) => "four",
        Some(Size::Third) => "three",
        _ => "two",
    }
}

/// CSS rules that map the colours of the drawings to their meanings.
fn colours() -> String {
    let rule = |colour: Colour| {
        let [r, g, b] = colour.rgb();
        let hex = format!("#{r:02X}{g:02X}{b:02X}");
        let name = match colour {
            Colour::Of(method) => method.name(),
            Colour::Smoothed => SMOOTHED,
            Colour::Truth | Colour::Ink => "ink",
            Colour::Grid => "grid",
        };
        format!("svg [fill=\"{hex}\"]{{fill:var(--{name})}}svg [stroke=\"{hex}\"]{{stroke:var(--{name})}}\n")
    };
    Colour::ALL.map(rule).concat()
}

fn counted(number: u64, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}
