//! Faults of a camera's truth, put into a good session.

use super::common::Csv;

/// Columns of one segment's truth.
pub fn parts(segment: usize) -> [String; 3] {
    ["x_mm", "y_mm", "heading_deg"].map(|part| format!("truth{segment}_{part}"))
}

/// All columns of truth.
pub fn columns() -> Vec<String> {
    (1..=6).flat_map(parts).collect()
}

pub fn number(cell: &str) -> f64 {
    cell.parse().expect("a number")
}

/// A lost marker, written as zeros.
pub fn zeros(session: &mut Csv, segment: usize, rows: impl IntoIterator<Item = usize>) {
    for row in rows {
        for name in parts(segment) {
            session.set(row, &name, "0.0000");
        }
    }
}

/// Repeats the pose of row `from` in the `count` rows after it.
pub fn hold(session: &mut Csv, names: &[String], from: usize, count: usize) {
    for name in names {
        let cell = session.cell(from, name).to_owned();
        (from + 1..=from + count).for_each(|row| session.set(row, name, &cell));
    }
}

/// Truth that is updated every `period` rows and held between.
pub fn staircase(session: &mut Csv, period: usize) {
    for from in (0..session.rows.len()).step_by(period) {
        let count = (period - 1).min(session.rows.len() - 1 - from);
        hold(session, &columns(), from, count);
    }
}

/// A heading in the middle of 1° and 359°, as a resampler makes it that knows no whole turns.
pub fn half_turns(session: &mut Csv, segment: usize, rows: impl IntoIterator<Item = usize>) {
    let [.., name] = parts(segment);
    for row in rows {
        let turned = number(session.cell(row, &name)) + 180.0;
        session.set(row, &name, &turned.to_string());
    }
}

/// Adds a distance along y.
pub fn shift(session: &mut Csv, segment: usize, rows: impl IntoIterator<Item = usize>, mm: f64) {
    let [_, name, _] = parts(segment);
    for row in rows {
        let shifted = number(session.cell(row, &name)) + mm;
        session.set(row, &name, &shifted.to_string());
    }
}

/// Exchanges the poses of two segments.
pub fn exchange(session: &mut Csv, [one, other]: [usize; 2], rows: impl IntoIterator<Item = usize>) {
    for row in rows {
        for (one, other) in parts(one).iter().zip(&parts(other)) {
            let (one, other) = (session.column(one), session.column(other));
            session.rows[row].swap(one, other);
        }
    }
}

/// Multiplies all columns of truth whose name ends so.
pub fn scale(session: &mut Csv, ending: &str, factor: f64) {
    for name in columns().iter().filter(|name| name.ends_with(ending)) {
        session.map(name, |_, cell| (number(cell) * factor).to_string());
    }
}

/// Gives each row the truth of `rows` rows earlier; the first rows are removed.
pub fn late(session: &mut Csv, rows: usize) {
    for name in columns() {
        let cells: Vec<String> = session.rows.iter().map(|row| row[session.column(&name)].clone()).collect();
        session.map(&name, |row, _| cells[row.saturating_sub(rows)].clone());
    }
    session.rows.drain(..rows);
}
