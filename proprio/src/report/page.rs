//! The page: one HTML file that needs nothing else, no network and no script.

use estimator_core::Method;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::plot::{Colour, Figure, Panel, Size};
use super::{Report, draw};
use crate::figures::ByMethod;
use crate::score::Figures;

const STYLE: &str = include_str!("style.css");

/// A group of the table's columns: its head and its figure.
type Group = (String, fn(&Figures) -> Option<f64>);

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
                        (self.table())
                        @for (number, figure) in (1..).zip(&self.figures) { (section(number, figure)) }
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

    /// The table of the paper: a row a session, a column a method.
    fn table(&self) -> Markup {
        let groups: [Group; 4] = [
            ("tip RMSE, mm".to_owned(), |figures| figures.tip_rmse_mm),
            (format!("tip RMSE, % of {} mm", self.table.length_mm), |figures| figures.tip_rmse_percent),
            ("tip 75th percentile, mm".to_owned(), |figures| figures.tip_p75_mm),
            ("bend angle RMSE, deg".to_owned(), |figures| figures.theta_rmse_deg),
        ];
        let samples = self.numbers.sessions.iter().map(|session| session.samples).sum();
        html! {
            section #table {
                h2 { "Table 1. Errors of the four methods" }
                div.wide {
                    table {
                        thead {
                            tr { th rowspan="2" scope="col" { "session" } @for (head, _) in &groups { th colspan="4" scope="colgroup" { (head) } } }
                            tr { @for _ in &groups { @for method in Method::ALL { th.(method.name()) scope="col" { (method.name()) } } } }
                        }
                        tbody {
                            @for session in &self.numbers.sessions { (table_row(&session.path, &session.figures, &groups)) }
                        }
                        tfoot { (table_row("all together", &self.numbers.all, &groups)) }
                    }
                }
                p.caption {
                    "Against the truth, as far as it is known, over " (counted(samples, "sample")) ". bend: bend sensors alone; imu_o: raw IMUs; imu_c: IMUs whose drift bend \
                     sensors correct; fusion: Kalman filters over both. The best method is bold; a dash is what is not known."
                }
            }
        }
    }
}

fn table_row(name: &str, figures: &ByMethod, groups: &[Group]) -> Markup {
    html! {
        tr {
            th scope="row" { (name) }
            @for (_, figure) in groups {
                @let values = figures.methods.each_ref().map(figure);
                @let best = values.iter().flatten().copied().reduce(f64::min);
                @for value in values {
                    td.best[value.is_some() && value == best] { (value.map_or("–".to_owned(), |value| format!("{value:.2}"))) }
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

/// How many panels stand side by side.
fn class(row: &[Panel]) -> &'static str {
    match row.first().map(|panel| panel.size) {
        Some(Size::Quarter) => "four",
        Some(Size::Third) => "three",
        _ => "two",
    }
}

/// The rules that give every colour of the drawings its meaning.
fn colours() -> String {
    let rule = |colour: Colour| {
        let [r, g, b] = colour.rgb();
        let hex = format!("#{r:02X}{g:02X}{b:02X}");
        let name = match colour {
            Colour::Of(method) => method.name(),
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
