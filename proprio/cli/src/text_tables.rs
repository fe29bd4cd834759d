//! Text tables for people.

use std::time::Duration;

use calibration_tables::{DriftTuningToml, RmseToml, StopReason, TuningToml};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use estimator_core::Method;
use proprio_calibration::calibrate::{HeldOut, MapKind, SegmentReport, SensorReport};
use proprio_link::Port;

/// One line for each bend sensor.
pub fn sensors(sensors: &[SensorReport]) -> String {
    let mut table = table(&["sensor", "samples", "RMSE deg", "range deg", "range V"]);
    for sensor in sensors {
        let [lo_deg, hi_deg] = sensor.range_deg;
        let [lo_v, hi_v] = sensor.volts;
        table.add_row([
            sensor.name.clone(),
            sensor.samples.to_string(),
            format!("{:.2}", sensor.rmse_deg),
            format!("{lo_deg:.1} to {hi_deg:.1}"),
            format!("{lo_v:.3} to {hi_v:.3}"),
        ]);
    }
    let mean = sensors.iter().map(|sensor| sensor.rmse_deg).sum::<f64>() / sensors.len() as f64;
    format!("{}\nmean RMSE of the V–Orient maps: {mean:.2} deg\n", text(&mut table))
}

/// Expected errors of the segments' bend angles.
pub fn segments(segments: &[SegmentReport]) -> String {
    let mut table = table(&["segment", "expected error deg", "maps", "memory", "IMU scale"]);
    for segment in segments {
        let kind = |(kind, _): &(MapKind, bool)| match kind {
            MapKind::Quadratic => "quadratic",
            MapKind::Curve => "curve",
        };
        let memory = |(_, memory): &(MapKind, bool)| if *memory { "yes" } else { "no" };
        table.add_row([
            segment.segment.to_string(),
            format!("{:.2}", segment.held_back_rmse_deg),
            joined(segment.maps.iter().map(kind)),
            joined(segment.maps.iter().map(memory)),
            segment.imu_scale.map_or_else(|| "-".to_owned(), |scale| format!("{scale:.4}")),
        ]);
    }
    format!("\n{}\n", text(&mut table))
}

/// Errors on the last fifth of the sweep.
pub fn held_out(held_out: &HeldOut) -> String {
    let mut table = table(&["method", "tip RMSE mm"]);
    for (method, tip_rmse_mm) in Method::ALL.iter().zip(held_out.tip_rmse_mm) {
        let cell = tip_rmse_mm.map_or_else(|| "-".to_owned(), |rmse_mm| format!("{rmse_mm:.2}"));
        table.add_row([method.name().to_owned(), cell]);
    }
    format!("\non the last fifth, by a table of the rest:\n{}\n", text(&mut table))
}

/// The words of a segment's sensors, one for both where they agree.
fn joined<'w>(words: impl Iterator<Item = &'w str>) -> String {
    let mut words: Vec<&str> = words.collect();
    words.dedup();
    words.join(", ")
}

/// Result of a tuning, each iteration of which took `iteration_time`.
pub fn tuning(record: &TuningToml, iteration_time: Duration) -> String {
    let mut table = table(&["RMSE", "before", "after", "validation, before", "after"]);
    let parts = [&record.before, &record.after, &record.validation_before, &record.validation_after];
    let mut add = |name: &str, figure: fn(&RmseToml) -> f64| {
        table.add_row([name.to_owned()].into_iter().chain(parts.map(|of| format!("{:.2}", figure(of)))));
    };
    add("tip, mm", |of| of.tip_rmse_mm);
    add("all ends, mm", |of| of.position_rmse_mm);
    add("headings, deg", |of| of.heading_rmse_deg);
    let stopped = match record.stop_reason {
        StopReason::Converged => "converged",
        StopReason::Interrupted => "interrupted",
    };
    let each_s = iteration_time.as_secs_f64();
    let (iterations, best) = (record.iterations, record.best_iteration);
    let filters = format!(
        "{}\n{stopped} after {iterations} iterations of {each_s:.3} s; the table has iteration {best}\n",
        text(&mut table)
    );
    filters + &record.drift.as_ref().map_or_else(String::new, bias_filter) + &variances(record)
}

/// The bias filter's parameters, before and after.
fn bias_filter(of: &DriftTuningToml) -> String {
    let mut table = table(&["bias filter", "before", "after"]);
    let keys = [
        ("rate_deg_per_s", of.rate_deg_per_s),
        ("rate_random_walk_deg_per_s_sqrt_s", of.rate_random_walk_deg_per_s_sqrt_s),
        ("angle_random_walk_deg_per_sqrt_s", of.angle_random_walk_deg_per_sqrt_s),
        ("offset_deg", of.offset_deg),
        ("offset_s", of.offset_s),
    ];
    for (name, values) in keys {
        table.add_row([name.to_owned()].into_iter().chain(values.map(|value| format!("{value:.3e}"))));
    }
    format!("\n{}\nafter {} runs of the estimator\n", text(&mut table), of.runs)
}

/// Inflation of the variances, where the table has any.
fn variances(record: &TuningToml) -> String {
    match record.covariance_inflation {
        None => String::new(),
        Some(factor) if factor > 1.0 => format!("\nvariances are {factor:.2} times as large\n"),
        Some(_) => "\nvariances are unchanged\n".to_owned(),
    }
}

/// One line for each port.
pub fn ports(ports: &[Port]) -> String {
    if ports.is_empty() {
        return "no serial port\n".to_owned();
    }
    let mut table = table(&["port", "what", "USB", "serial number", "product"]);
    for Port { name, kind, usb, serial_number, product } in ports {
        let [usb, serial_number, product] = [usb, serial_number, product].map(|text| text.as_deref().unwrap_or("–"));
        table.add_row([name, kind.name(), usb, serial_number, product]);
    }
    table.trim_fmt() + "\n"
}

/// Lines of names and values.
pub fn pairs(lines: &[(&str, String)]) -> String {
    lines.iter().map(|(name, value)| format!("{name:<13} {value}\n")).collect::<Vec<_>>().concat()
}

/// A table with these column heads.
pub fn table(heads: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(NOTHING).set_header(heads);
    table
}

/// Its text: names in the first column to the left, numbers to the right, no trailing space.
pub fn text(table: &mut Table) -> String {
    text_with_names(table, 1)
}

/// The same of a table with names in its first `names` columns.
pub fn text_with_names(table: &mut Table, names: usize) -> String {
    for column in table.column_iter_mut().skip(names) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}
