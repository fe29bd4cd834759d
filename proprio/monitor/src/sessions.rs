//! Sessions that the page opens: files of one folder, or files that the browser sends.

use std::collections::BTreeMap;
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use estimator_core::Q;
use proprio_check::{Finding, SessionCheck};
use proprio_link::table::StoredTable;
use proprio_session::{LoadedTable, Mark, Row, SessionError, SessionReader, recorded_table};
use serde::Serialize;
use telemetry::Uncertainty;
use tempfile::TempPath;

use super::feed::ArmDescription;
use super::history::History;
use super::host_replica::HostReplica;
use super::page_row::{self, ArmSize, ColumnGroup, PageRow};
use super::table::OwnedTable;
use crate::error::Error;

/// Sessions that can be opened.
#[derive(Debug)]
pub(super) struct Sessions {
    /// Folder of recordings and sessions.
    pub folder: PathBuf,
    /// The given one, or the board's; a given one is used for every session.
    table: Mutex<Option<Arc<OwnedTable>>>,
    is_given: bool,
    /// The session that the command was given.
    given: Option<PathBuf>,
    /// Returns the text of a finding, with its remedy.
    pub finding_text: fn(&Finding) -> String,
    /// Files that browsers have sent, by name.
    sent: Mutex<BTreeMap<String, TempPath>>,
}

/// A file that can be opened.
#[derive(Debug, Serialize)]
pub(super) struct SessionEntry {
    name: String,
    bytes: u64,
}

/// Description of a session before its rows.
#[derive(Debug, Serialize)]
struct About {
    arm: ArmDescription,
    /// Samples in the requested part.
    samples: u64,
    /// Decimation: one of this number of samples is sent.
    every: u64,
    /// Marks in it.
    marks: Vec<PageMark>,
    /// Defects of the file and findings of the session check, in the whole session.
    findings: Vec<String>,
}

/// A mark, in the units of the page.
#[derive(Debug, Serialize)]
struct PageMark {
    time_s: f64,
    text: String,
}

impl From<&Mark> for PageMark {
    fn from(mark: &Mark) -> Self {
        Self { time_s: mark.time_us as f64 / 1e6, text: mark.text.clone() }
    }
}

impl Sessions {
    pub fn new(
        folder: PathBuf,
        table: Option<&LoadedTable>,
        given: Option<PathBuf>,
        finding_text: fn(&Finding) -> String,
    ) -> Self {
        let is_given = table.is_some();
        let table = Mutex::new(table.map(|table| Arc::new(OwnedTable::given(table))));
        Self { folder, table, is_given, given, finding_text, sent: Mutex::default() }
    }

    /// Name of the session that the command was given.
    pub fn given(&self) -> Option<String> {
        self.given.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned())
    }

    /// The text of the table's file.
    pub fn table_toml(&self) -> Result<Option<Vec<u8>>, Error> {
        Ok(self.table().map(|table| table.loaded().toml()).transpose()?)
    }

    /// The table as a board stores it; `None` without a table.
    pub fn stored_table(&self) -> Result<Option<StoredTable>, Error> {
        let Some(table) = self.table() else { return Ok(None) };
        Ok(Some(StoredTable::new(&table.file, &table.loaded().toml()?)?))
    }

    /// A session check with the table; `None` without a table.
    pub fn check(&self) -> Option<SessionCheck> {
        self.table().and_then(|table| SessionCheck::new(&table.loaded()).ok())
    }

    pub fn table(&self) -> Option<Arc<OwnedTable>> {
        self.locked_table().clone()
    }

    /// True where a table was given: the board's is not taken then.
    pub const fn is_table_given(&self) -> bool {
        self.is_given
    }

    pub fn set_board_table(&self, table: Option<OwnedTable>) {
        *self.locked_table() = table.map(Arc::new);
    }

    fn locked_table(&self) -> MutexGuard<'_, Option<Arc<OwnedTable>>> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The table of a session: the one of this name in the folder; else the given one, that in the recording, or the board's.
    fn table_of(&self, path: &Path, name: Option<&str>) -> Result<Arc<OwnedTable>, Error> {
        if let Some(name) = name {
            let path = self.in_folder(name, is_table).ok_or_else(|| Error::NoSuchTable(name.to_owned()))?;
            return Ok(Arc::new(OwnedTable::given(&LoadedTable::load(&path)?)));
        }
        let recorded = if self.is_given { None } else { recorded_table(path)? };
        let recorded = recorded.map(|file| Arc::new(OwnedTable::given(&LoadedTable { file, path })));
        recorded.or_else(|| self.table()).ok_or(Error::NoTable)
    }

    /// The sessions and tables of the folder, by name.
    pub fn list(&self) -> Vec<SessionEntry> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let file = |entry: fs::DirEntry| {
            let name = entry.file_name().into_string().ok().filter(|name| is_session(name) || is_table(name))?;
            let bytes = entry.metadata().ok().filter(fs::Metadata::is_file)?.len();
            Some(SessionEntry { name, bytes })
        };
        let mut files: Vec<SessionEntry> = entries.filter_map(file).collect();
        files.sort_by(|a, b| a.name.cmp(&b.name));
        files
    }

    /// Keeps a file that a browser has sent until the monitor ends.
    pub fn keep(&self, name: &str, file: TempPath) {
        self.sent.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), file);
    }

    /// The path of a file that may be opened: one that was sent, the given one, or one of the folder.
    pub fn path(&self, name: &str) -> Option<PathBuf> {
        let sent = self.sent.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(path) = sent.get(name) {
            return Some(path.to_path_buf());
        }
        if self.given().is_some_and(|given| given == name) {
            return self.given.clone();
        }
        self.in_folder(name, is_session)
    }

    /// The path of a file of the folder, by its plain name.
    fn in_folder(&self, name: &str, is_kind: fn(&str) -> bool) -> Option<PathBuf> {
        let is_plain = Path::new(name).file_name().is_some_and(|plain| plain == name);
        Some(self.folder.join(name)).filter(|path| is_plain && is_kind(name) && path.is_file())
    }

    /// Replays a session and returns its rows between two times, decimated to as many as a page holds; with the name of a table, by
    /// that in place of its own. Errors have the session's name in place of its path, which is that of a copy where a browser has
    /// sent it.
    pub fn rows(
        &self,
        name: &str,
        path: &Path,
        table: Option<&str>,
        times_s: RangeInclusive<f64>,
    ) -> Result<Vec<u8>, Error> {
        self.rows_of(path, table, &times_s).map_err(|error| match error {
            Error::File(proprio_session::Error::Session(error)) => SessionError { path: name.into(), ..error }.into(),
            other => other,
        })
    }

    fn rows_of(&self, path: &Path, table: Option<&str>, times_s: &RangeInclusive<f64>) -> Result<Vec<u8>, Error> {
        // The board's own estimates are those of its own table.
        let is_of_board = table.is_none();
        let table = self.table_of(path, table)?;
        let (table, file) = (table.loaded(), &table.file);
        let mut reader = SessionReader::open(path, &table.required_columns()?)?;
        let compiled = table.compile::<Q>(reader.rate_hz(file.rate_hz)?)?;
        let compiled = compiled.config();
        let regulators = reader.hello().map_or(0, |hello| usize::from(hello.regulators));
        let size = ArmSize { segments: file.segments.len(), regulators };
        let mut replica = HostReplica::new(&compiled);
        let mut held = BoardState::default();
        let mut check = SessionCheck::new(&table)?;
        let mut history = History::new(page_row::names(size).len());
        let (mut samples, mut every) = (0, 1);
        while let Some(read) = reader.next_row()? {
            let mut row = PageRow::new(read.sample.time_us as f64 / 1e6, size);
            if read.starts {
                replica.start();
            }
            if read.is_comparable() {
                replica.step(&read.sample, &mut row);
            }
            held.update(&read);
            if !read.is_recorded() {
                continue;
            }
            check.update(&read);
            if is_of_board {
                held.set_estimate(&read, &mut row);
            }
            held.set_pressures(&mut row);
            row.set_sample(&read.sample);
            row.set_truth(&read.truth);
            if !times_s.contains(&row.time_s) {
                continue;
            }
            if samples % every == 0 {
                if history.is_full() {
                    history.halve();
                    every *= 2;
                }
                if samples % every == 0 {
                    history.push(&row);
                }
            }
            samples += 1;
        }
        let marks = reader.marks().iter().map(PageMark::from).filter(|mark| times_s.contains(&mark.time_s));
        let marks = marks.collect();
        let findings = reader.defects().warnings().chain(check.findings().iter().map(self.finding_text)).collect();
        let arm = ArmDescription::new(size, Some(file));
        Ok(history.to_bytes(&About { arm, samples, every, marks, findings }))
    }
}

/// What a board sends less often than samples, held until the next one.
#[derive(Default)]
struct BoardState {
    uncertainty: Option<Uncertainty>,
    requested_pa: Vec<u32>,
    set_pa: Vec<u32>,
}

impl BoardState {
    fn update(&mut self, row: &Row) {
        let Some(board) = &row.board else { return };
        if row.starts {
            *self = Self::default();
        }
        if board.uncertainty.is_some() {
            self.uncertainty.clone_from(&board.uncertainty);
        }
        if let (Some(mask), Some(uncertainty)) = (board.contact, &mut self.uncertainty) {
            let segments = uncertainty.segments.iter_mut().enumerate();
            segments.for_each(|(i, segment)| segment.in_contact = mask >> i & 1 == 1);
        }
        for (held_pa, sent_pa) in [(&mut self.requested_pa, &board.requested_pa), (&mut self.set_pa, &board.set_pa)] {
            if let Some(sent_pa) = sent_pa {
                held_pa.clone_from(sent_pa);
            }
        }
    }

    /// Sets the board's own estimate and its uncertainty in a row, in place of the replica's.
    fn set_estimate(&self, read: &Row, row: &mut PageRow) {
        if let Some(estimate) = read.board.as_ref().and_then(|board| board.estimate.as_ref()) {
            row.set_estimate(&estimate.segments);
        }
        if let Some(uncertainty) = &self.uncertainty {
            row.set_uncertainty(uncertainty);
        }
    }

    fn set_pressures(&self, row: &mut PageRow) {
        row.set_pressures(ColumnGroup::PressureRequested, &self.requested_pa);
        row.set_pressures(ColumnGroup::PressureSet, &self.set_pa);
    }
}

/// True for a name with the ending of a session.
fn is_session(name: &str) -> bool {
    has_ending(name, &["csv", "mcap", "bin"])
}

/// True for a name with the ending of a table.
fn is_table(name: &str) -> bool {
    has_ending(name, &["toml"])
}

fn has_ending(name: &str, endings: &[&str]) -> bool {
    let extension = Path::new(name).extension();
    endings.iter().any(|ending| extension.is_some_and(|extension| extension.eq_ignore_ascii_case(ending)))
}
