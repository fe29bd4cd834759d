//! Box plots of the tip's error by method, for each session and for all together.

use estimator_core::Method;

use super::plot::{Axis, ESTIMATES, Figure, Marks, Panel, SMOOTHED, Series, Size, extent, rounded};
use crate::error_histogram::ErrorHistogram;
use crate::metrics::ErrorMetrics;

/// Names below the boxes.
const NAMES: [&str; ESTIMATES.len()] = ["bend", "imu_o", "imu_c", "fusion", SMOOTHED];

/// The figure of the sessions' names and errors, and of all sessions together where there are several.
pub fn figure<'s>(sessions: impl Iterator<Item = (&'s str, &'s ErrorMetrics)>, all: &ErrorMetrics) -> Figure {
    let mut panels: Vec<Panel> = sessions.map(|(name, errors)| panel(Some(name.to_owned()), errors)).collect();
    if panels.len() > 1 {
        panels.push(panel(None, all));
    }
    panels.retain(|panel| !panel.series.is_empty());
    let [_, [_, largest]] = extent(panels.iter().flat_map(|panel| &panel.series));
    for panel in &mut panels {
        panel.y.range = [0.0, 1.05 * largest];
    }
    let samples: Vec<String> = tips(all).zip(NAMES).map(|(tips, name)| format!("{name} {}", tips.count())).collect();
    Figure {
        name: "boxes",
        title: "Tip error by method",
        caption: format!(
            "Distance of the tip from its true place. Box: quartiles and median; whiskers: the last sample within 1.5 \
             box heights of the box; star: RMSE. Larger errors are not drawn. All panels have one scale. Samples with \
             truth, all together: {}.",
            samples.join(", ")
        ),
        is_drawn: !panels.is_empty(),
        panels,
    }
}

/// Tip errors of all methods, and of the smoothed shape where there are any.
fn tips(errors: &ErrorMetrics) -> impl Iterator<Item = &ErrorHistogram> {
    let smoothed = Some(errors.smoothed_tips()).filter(|tips| tips.count() > 0);
    Method::ALL.into_iter().map(|method| errors.tips(method)).chain(smoothed)
}

fn panel(session: Option<String>, errors: &ErrorMetrics) -> Panel {
    let series = tips(errors).zip(ESTIMATES).enumerate().filter_map(|(place, (tips, (name, colour)))| {
        let (spread, rmse_m) = tips.box_stats().zip(tips.rms_m())?;
        let mm = |m: f64| rounded(m * 1e3);
        let [quartile1_mm, median_mm, quartile3_mm] = spread.quartiles_m.map(mm);
        let (low_mm, high_mm, largest_mm) = (mm(spread.low_m), mm(spread.high_m), mm(spread.largest_m));
        let (place, samples, rmse_mm) = (place as f64, tips.count(), mm(rmse_m));
        let marks =
            Marks::Box { place, samples, low_mm, quartile1_mm, median_mm, quartile3_mm, high_mm, largest_mm, rmse_mm };
        Some(Series { name: name.to_owned(), colour, marks })
    });
    let count = tips(errors).count();
    let x = Axis { title: "method", range: [-0.6, count as f64 - 0.4], names: &NAMES[..count], is_log: false };
    Panel {
        name: String::new(),
        title: session.clone().unwrap_or_else(|| "all sessions together".to_owned()),
        session,
        facts: Vec::new(),
        size: Size::Third,
        x,
        y: Axis::new("tip error, mm", [0.0, 1.0]),
        series: series.collect(),
    }
}
