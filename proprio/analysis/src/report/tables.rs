//! Text tables of the page.

use estimator_core::Method;
use maud::{Markup, html};
use serde_json::Value;

use super::comparison::{Comparison, Difference};
use super::page::counted;
use super::{Report, SMOOTHED};
use crate::consistency::ConsistencyMetrics;
use crate::metrics::Metrics;
use crate::session_metrics::ByMethod;

/// Differences of two tables that the page lists.
const LISTED: usize = 60;

/// One estimate's row.
struct Row {
    name: &'static str,
    metrics: Metrics,
    consistency: Option<ConsistencyMetrics>,
}

impl Row {
    /// Rows of the estimates with any figure.
    fn all(of: &ByMethod) -> Vec<Self> {
        let fusion = of.uncertainty;
        let consistency = |method: &Method| fusion.filter(|_| *method == Method::Fusion);
        let methods = Method::ALL.iter().zip(&of.methods);
        let methods = methods.map(|(method, metrics)| Self {
            name: method.name(),
            metrics: *metrics,
            consistency: consistency(method),
        });
        let smoothed = of.smoothed.map(|of| Self { name: SMOOTHED, metrics: of.metrics, consistency: of.uncertainty });
        methods.chain(smoothed).filter(|row| row.cells().iter().any(Option::is_some)).collect()
    }

    fn cells(&self) -> [Option<f64>; 4] {
        let Metrics { tip_rmse_mm, tip_rmse_percent, tip_p75_mm, theta_rmse_deg } = self.metrics;
        [tip_rmse_mm, tip_rmse_percent, tip_p75_mm, theta_rmse_deg]
    }
}

/// Sessions with truth, and all together where there are several.
fn named<'m>(
    sessions: impl Iterator<Item = (&'m str, &'m ByMethod)>,
    all: &'m ByMethod,
) -> Vec<(&'m str, &'m ByMethod)> {
    let mut named: Vec<_> = sessions.filter(|(_, of)| !Row::all(of).is_empty()).collect();
    if named.len() > 1 {
        named.push(("all together", all));
    }
    named
}

impl Report {
    fn named(&self) -> Vec<(&str, &ByMethod)> {
        named(self.numbers.sessions.iter().map(|session| (session.path.as_str(), &session.metrics)), &self.numbers.all)
    }

    /// Errors by session and method, where there is truth.
    pub(super) fn errors(&self) -> Markup {
        let named = self.named();
        let is_shown = |path: &str| named.iter().any(|(name, _)| *name == path);
        let shown = self.numbers.sessions.iter().filter(|session| is_shown(&session.path));
        let samples = shown.map(|session| session.samples).sum();
        let is_stated = self.numbers.all.uncertainty.is_some();
        let is_smoothed = self.numbers.all.smoothed.is_some();
        html! {
            @if !named.is_empty() {
                section #table {
                    h2 { "Table 1. Errors by method" }
                    div.wide {
                        table {
                            thead { tr {
                                th scope="col" { "method" }
                                th scope="col" { "tip RMSE, mm" }
                                th scope="col" { "tip RMSE, % of " (self.table.length_mm) " mm" }
                                th scope="col" { "tip 75th percen\u{ad}tile, mm" }
                                th scope="col" { "bend angle RMSE, deg" }
                                @if is_stated { th scope="col" { "tips in 95 % ellipse, %" } th scope="col" { "NEES" } }
                            } }
                            @for (name, of) in &named { (block(name, of, is_stated)) }
                        }
                    }
                    p.caption {
                        "Against the truth, where it is known, over " (counted(samples, "sample")) ". bend: bend sensors alone; imu_o: raw IMUs; imu_c: IMUs whose drift bend \
                         sensors correct; fusion: Kalman filters over both"
                        @if is_smoothed { "; smoothed: fusion by the readings after each sample, too" }
                        ". The best one is bold."
                        @if is_stated {
                            " The last columns compare the error of the tip with the deviation that the estimate states: the share of true tips \
                             inside the 95 % ellipse, and the normalised estimation error squared (NEES), the mean squared error over the stated \
                             variance, for each coordinate: 1 is consistent, above 1 overconfident, below 1 cautious."
                        }
                    }
                }
            }
        }
    }

    /// The comparison with another table, where there is one.
    pub(super) fn compared(&self) -> Markup {
        let Some(other) = &self.comparison else { return html! {} };
        let tables = [("A", &self.table), ("B", &other.table)];
        let of_b = other.sessions.iter().map(|session| (session.path.as_str(), &session.metrics));
        let (a, b) = (self.named(), named(of_b, &other.all));
        html! {
            section #tables {
                h2 { "Table 2. Fusion by two tables" }
                ul.plain { @for (letter, table) in tables { li { (letter) ": " (table.path) ", CRC-32 " code { (table.crc32) } (table.text_of_history()) } } }
                div.wide {
                    table {
                        thead { tr {
                            th scope="col" { "figure" }
                            th scope="col" { "A" } th scope="col" { "B" } th scope="col" { "B against A" }
                        } }
                        @for (name, a) in &a { @if let Some((_, b)) = b.iter().find(|(other, _)| other == name) { (pair(name, a, b)) } }
                    }
                }
                (differences(other))
            }
        }
    }
}

fn block(name: &str, of: &ByMethod, is_stated: bool) -> Markup {
    let rows = Row::all(of);
    let best: [Option<f64>; 4] =
        std::array::from_fn(|column| rows.iter().filter_map(|row| row.cells()[column]).reduce(f64::min));
    html! {
        tbody {
            tr.session { th scope="rowgroup" colspan=(if is_stated { 7 } else { 5 }) { (name) } }
            @for row in &rows {
                tr {
                    th.(row.name) scope="row" { (row.name) }
                    @for (value, best) in row.cells().into_iter().zip(best) { td.best[value.is_some() && value == best] { (cell(value, 2)) } }
                    @if is_stated {
                        td { (cell(row.consistency.and_then(|of| of.tip_inside_percent), 1)) }
                        td { (cell(row.consistency.and_then(|of| of.tip_nees), 2)) }
                    }
                }
            }
        }
    }
}

fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(String::new, |value| format!("{value:.digits$}"))
}

/// Figures of fusion by both tables.
fn pair(name: &str, a: &ByMethod, b: &ByMethod) -> Markup {
    let names = ["tip RMSE, mm", "tip 75th percentile, mm", "bend angle RMSE, deg"];
    let errors = [a, b].map(|of| {
        let Metrics { tip_rmse_mm, tip_p75_mm, theta_rmse_deg, .. } = of.methods[Method::Fusion as usize];
        [tip_rmse_mm, tip_p75_mm, theta_rmse_deg]
    });
    let stated = [a, b].map(|of| of.uncertainty);
    let [inside_a, inside_b] = stated.map(|of| cell(of.and_then(|of| of.tip_inside_percent), 1));
    let [nees_a, nees_b] = stated.map(|of| cell(of.and_then(|of| of.tip_nees), 2));
    html! {
        tbody {
            tr.session { th scope="rowgroup" colspan="4" { (name) } }
            @for (k, name) in names.into_iter().enumerate() {
                @let [a, b] = [errors[0][k], errors[1][k]];
                @if a.is_some() || b.is_some() {
                    tr {
                        th scope="row" { (name) }
                        td.best[a < b] { (cell(a, 2)) } td.best[b < a] { (cell(b, 2)) }
                        td { (a.zip(b).map_or_else(String::new, |(a, b)| change(a, b))) }
                    }
                }
            }
            @if stated.iter().any(Option::is_some) {
                tr { th scope="row" { "tips in 95 % ellipse, %" } td { (inside_a) } td { (inside_b) } td {} }
                tr { th scope="row" { "NEES (1 is consistent)" } td { (nees_a) } td { (nees_b) } td {} }
            }
        }
    }
}

/// Change in % of `a`.
fn change(a: f64, b: f64) -> String {
    let percent = (b / a - 1.0) * 100.0;
    let sign = if percent < 0.0 { "\u{2212}" } else { "+" };
    if a > 0.0 { format!("{sign}{:.1} %", percent.abs()) } else { String::new() }
}

fn differences(other: &Comparison) -> Markup {
    let all = &other.differences;
    html! {
        @if all.is_empty() {
            p.caption { "The parameters of both tables are the same." }
        } @else {
            details {
                summary { (counted(all.len() as u64, "parameter")) " of different values" }
                div.wide {
                    table {
                        thead { tr { th scope="col" { "key" } th scope="col" { "A" } th scope="col" { "B" } } }
                        tbody { @for Difference { key, table, other } in all.iter().take(LISTED) { tr { th scope="row" { (key) } td { (shown(table.as_ref())) } td { (shown(other.as_ref())) } } } }
                    }
                }
                @if all.len() > LISTED { p.caption { "The JSON has the " (all.len() - LISTED) " others." } }
            }
        }
    }
}

/// A value, numbers to four digits.
fn shown(value: Option<&Value>) -> String {
    match value {
        None => "none".to_owned(),
        Some(Value::Number(number)) => match number.as_f64() {
            Some(number) if number != 0.0 => {
                let digits = (3.0 - number.abs().log10().floor()).clamp(0.0, 9.0) as usize;
                let text = format!("{number:.digits$}");
                if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
            }
            _ => number.to_string(),
        },
        Some(Value::Array(values)) => values.iter().map(|value| shown(Some(value))).collect::<Vec<_>>().join(", "),
        Some(Value::String(text)) => text.clone(),
        Some(value) => value.to_string(),
    }
}
