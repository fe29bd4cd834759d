//! Rows of the last minutes, for a page that is opened later, or of a session.

use std::collections::VecDeque;

use serde::Serialize;

use super::page_row::PageRow;

/// Rows that a page holds: ten minutes at 100 Hz.
pub(super) const ROOM: usize = 60_000;

/// Rows in columns, the oldest dropped.
#[derive(Debug)]
pub(super) struct History {
    times_s: VecDeque<f64>,
    columns: Vec<VecDeque<f32>>,
}

/// Header in front of the rows of a [`History`].
#[derive(Debug, Serialize)]
struct Head<'a, T> {
    rows: usize,
    columns: usize,
    #[serde(flatten)]
    about: &'a T,
}

impl History {
    pub fn new(columns: usize) -> Self {
        Self { times_s: VecDeque::new(), columns: vec![VecDeque::new(); columns] }
    }

    /// Adds a row; returns false for one with other columns.
    pub fn push(&mut self, row: &PageRow) -> bool {
        if row.values.len() != self.columns.len() {
            return false;
        }
        if self.times_s.len() == ROOM {
            self.times_s.pop_front();
            for column in &mut self.columns {
                column.pop_front();
            }
        }
        self.times_s.push_back(row.time_s);
        self.columns.iter_mut().zip(&row.values).for_each(|(column, value)| column.push_back(*value));
        true
    }

    pub fn is_full(&self) -> bool {
        self.times_s.len() == ROOM
    }

    /// Adds columns without values behind the others, up to this number; returns false where there are more.
    pub fn widen(&mut self, columns: usize) -> bool {
        let rows = self.times_s.len();
        let is_wider = self.columns.len() <= columns;
        if is_wider {
            self.columns.resize_with(columns, || VecDeque::from(vec![f32::NAN; rows]));
        }
        is_wider
    }

    /// Leaves out every second row.
    pub fn halve(&mut self) {
        self.times_s = self.times_s.iter().copied().step_by(2).collect();
        for column in &mut self.columns {
            *column = column.iter().copied().step_by(2).collect();
        }
    }

    /// One line of JSON with the numbers of rows and columns and `about`, padded to eight bytes; then the times as f64, then
    /// each column as f32, little-endian.
    pub fn to_bytes(&self, about: &impl Serialize) -> Vec<u8> {
        let (rows, columns) = (self.times_s.len(), self.columns.len());
        let head = Head { rows, columns, about };
        let mut bytes = serde_json::to_vec(&head).expect("numbers and names have a form in JSON");
        bytes.resize((bytes.len() + 1).next_multiple_of(8) - 1, b' ');
        bytes.push(b'\n');
        bytes.reserve(rows * (8 + 4 * columns));
        self.times_s.iter().for_each(|time_s| bytes.extend(time_s.to_le_bytes()));
        self.columns.iter().flatten().for_each(|value| bytes.extend(value.to_le_bytes()));
        bytes
    }
}
