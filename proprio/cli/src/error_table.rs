//! The table of errors that `replay` prints.

use estimator_core::Method;
use proprio_analysis::consistency::ConsistencyMetrics;
use proprio_analysis::metrics::Metrics;
use proprio_analysis::session_metrics::{AllMetrics, ByMethod, SessionMetrics};

use crate::text_tables::{table, text_with_names};

/// Explanation of the columns of consistency.
const CONSISTENCY: &str = "\
in 95 % ellipse: share of the true tips inside the ellipse that the estimate states
NEES: mean squared error of the tip over its stated variance, for each coordinate; 1 is consistent, above 1
      overconfident, below 1 cautious
";

/// One table: a line for each method and session with truth, and a sentence for each session without.
pub fn errors(all: &AllMetrics) -> String {
    let known: Vec<&SessionMetrics> = all.sessions.iter().filter(|session| has_errors(&session.metrics)).collect();
    let mut parts = vec![all.sessions.iter().map(sentence).collect::<String>()];
    if !known.is_empty() {
        parts.push(lines(all, &known));
    }
    if all.all.uncertainty.is_some() {
        parts.push(CONSISTENCY.to_owned());
    }
    parts.join("\n")
}

fn has_errors(of: &ByMethod) -> bool {
    of.methods.iter().any(|metrics| cells(metrics).iter().any(Option::is_some))
}

/// Length of a session, and which of its errors are not known.
fn sentence(session: &SessionMetrics) -> String {
    let SessionMetrics { path, samples, seconds, metrics, .. } = session;
    let has = |pick: fn(&Metrics) -> Option<f64>| metrics.methods.iter().any(|of| pick(of).is_some());
    let missing = match (has(|of| of.tip_rmse_mm), has(|of| of.theta_rmse_deg)) {
        (true, true) => "",
        (true, false) => "; without true headings, so that the errors of the bend angles are not known",
        (false, true) => "; without true places of the tip, so that its errors are not known",
        (false, false) => "; without truth, so that the errors are not known",
    };
    format!("{path}: {samples} samples, {seconds:.1} s{missing}\n")
}

fn lines(all: &AllMetrics, known: &[&SessionMetrics]) -> String {
    let is_stated = all.all.uncertainty.is_some();
    let percent = format!("% of {} mm", all.length_mm);
    let mut heads = vec!["session", "method", "tip RMSE mm", &percent, "75th percentile mm", "bend angle RMSE deg"];
    heads.extend(["in 95 % ellipse", "NEES"].into_iter().filter(|_| is_stated));
    let is_single = known.len() == 1;
    let mut table = table(&heads[usize::from(is_single)..]);
    let sessions = known.iter().map(|session| (session.path.as_str(), &session.metrics));
    for (name, of) in sessions.chain((!is_single).then_some(("all", &all.all))) {
        for (method, metrics, consistency) in estimates(of) {
            let errors = cells(metrics).map(|value| value.map_or_else(String::new, |value| format!("{value:.2}")));
            let inside = consistency.and_then(|of| of.tip_inside_percent).map(|percent| format!("{percent:.1} %"));
            let nees = consistency.and_then(|of| of.tip_nees).map(|nees| format!("{nees:.2}"));
            let stated = [inside, nees].map(Option::unwrap_or_default).into_iter().filter(|_| is_stated);
            let names = [name, method].map(str::to_owned).into_iter().skip(usize::from(is_single));
            table.add_row(names.chain(errors).chain(stated));
        }
    }
    text_with_names(&mut table, if is_single { 1 } else { 2 }) + "\n"
}

/// The estimates that have errors: methods, and the smoothed one.
fn estimates(of: &ByMethod) -> impl Iterator<Item = (&'static str, &Metrics, Option<ConsistencyMetrics>)> {
    let methods = Method::ALL.iter().zip(&of.methods);
    let methods =
        methods.map(|(method, metrics)| (method.name(), metrics, of.uncertainty.filter(|_| *method == Method::Fusion)));
    let smoothed = of.smoothed.as_ref().map(|smoothed| ("smoothed", &smoothed.metrics, smoothed.uncertainty));
    methods.chain(smoothed).filter(|(_, metrics, _)| cells(metrics).iter().any(Option::is_some))
}

fn cells(of: &Metrics) -> [Option<f64>; 4] {
    [of.tip_rmse_mm, of.tip_rmse_percent, of.tip_p75_mm, of.theta_rmse_deg]
}
