//! Findings about truth, as `align`, `calibrate` and `tune` print them.

use proprio_calibration::JudgedTruth;

use crate::help::Help;
use crate::terminal;

/// Warns of the findings about the truth of a file.
pub fn warn(truth: &JudgedTruth) {
    for finding in &truth.findings {
        let (path, text) = (truth.path.display(), truth.text(finding));
        terminal::warn(&format_args!("{path}: {text}; {}", finding.help()));
    }
}

/// Lengths and clock of the truth of a file, as a line.
pub fn line(truth: &JudgedTruth) -> String {
    let lengths = truth.lengths.map_or_else(
        || "lengths not known".to_owned(),
        |lengths| format!("markers fit {:.4} times the arm's lengths", lengths.scale),
    );
    let clock = truth.lag_s.map_or_else(
        || "clock not compared".to_owned(),
        |lag_s| {
            let order = if lag_s < 0.0 { "earlier" } else { "later" };
            format!("{:.0} ms {order} than the IMUs", (lag_s * 1e3).abs())
        },
    );
    format!("truth of {}: {lengths}; {clock}\n", truth.path.display())
}
