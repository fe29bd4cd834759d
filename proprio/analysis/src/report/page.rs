//! The page: one HTML file that needs nothing else, no network and no script.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::plot::{Colour, Figure, Panel, SMOOTHED, Size};
use super::{Report, draw};

const STYLE: &str = include_str!("style.css");

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
                        (self.errors())
                        (self.compared())
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
                    dd { (table.path) ", parameters at " (table.rate_hz) " Hz with CRC-32 " code { (table.crc32) } (table.text_of_history()) }
                    dt { "Arm" }
                    dd { (table.arm) ", " (counted(table.segments as u64, "segment")) ", " (table.length_mm) " mm" }
                    dt { "Sessions" }
                    dd {
                        ul {
                            @for session in &self.numbers.sessions {
                                li { (session.path) ": " (counted(session.samples, "sample")) ", " (format!("{:.1}", session.seconds)) " s" @if let Some(at) = &session.recorded_at { ", recorded " (at) } }
                            }
                        }
                    }
                    dt { "Made by" }
                    dd { "proprio " (self.proprio) ", in the board's fixed point" @if let Some(command) = &self.command { ": " code { (command) } } }
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
}

fn section(number: usize, figure: &Figure) -> Markup {
    html! {
        section id=(figure.name) {
            h2 { "Figure " (number) ". " (figure.title) }
            @for group in figure.panels.chunk_by(|a, b| a.name.is_empty() && b.name.is_empty() || a.session == b.session) {
                @if let [Panel { session: Some(session), name, .. }, ..] = group { @if !name.is_empty() { h3 { (session) } } }
                @for row in group.chunk_by(|a, b| a.size == b.size) {
                    div.plots.(class(row)) { @for panel in row { (plot(panel, row.len() == 1)) } }
                }
            }
            p.caption { (figure.caption) }
        }
    }
}

/// A panel; curves over time alone in their row are as wide as the page.
fn plot(panel: &Panel, is_alone: bool) -> Markup {
    let svg = match panel.size {
        Size::Half if is_alone => draw::svg(&Panel { size: Size::Page, ..panel.clone() }),
        _ => draw::svg(panel),
    };
    html! {
        figure role="img" aria-label=(panel.title) {
            figcaption { (panel.title) }
            (PreEscaped(svg))
        }
    }
}

/// CSS class of a row by its number of panels.
fn class(row: &[Panel]) -> &'static str {
    match row.first().map(|panel| panel.size) {
        Some(Size::Quarter | Size::Square) => "four",
        Some(Size::Third) => "three",
        Some(Size::Half) if row.len() == 1 => "one",
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

pub fn counted(number: u64, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}
