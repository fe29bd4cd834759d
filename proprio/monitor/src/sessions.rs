//! Sessions that the page opens: files of one folder, or files that the browser sends.

use std::collections::BTreeMap;
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use calibration_tables::ArmFile;
use estimator_core::Q;
use proprio_check::{Finding, SessionCheck};
use proprio_link::table::StoredTable;
use proprio_session::{LoadedTable, Mark, SessionError, SessionReader};
use serde::Serialize;
use tempfile::TempPath;

use super::feed::ArmDescription;
use super::history::History;
use super::host_replica::HostReplica;
use super::page_row::{self, PageRow};
use crate::error::Error;

/// Sessions that can be opened.
#[derive(Debug)]
pub(super) struct Sessions {
    /// Folder of recordings and sessions.
    pub folder: PathBuf,
    table: Option<(PathBuf, ArmFile)>,
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
        let table = table.map(|table| (table.path.to_owned(), table.file.clone()));
        Self { folder, table, given, finding_text, sent: Mutex::default() }
    }

    /// Name of the session that the command was given.
    pub fn given(&self) -> Option<String> {
        self.given.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned())
    }

    /// The text of the table's file.
    pub fn table_toml(&self) -> Result<Option<Vec<u8>>, Error> {
        Ok(self.table().map(|table| table.toml()).transpose()?)
    }

    /// The table as a board stores it; `None` without a table.
    pub fn stored_table(&self) -> Result<Option<StoredTable>, Error> {
        let Some(table) = self.table() else { return Ok(None) };
        Ok(Some(StoredTable::new(&table.file, &table.toml()?)?))
    }

    /// A session check with the table; `None` without a table.
    pub fn check(&self) -> Option<SessionCheck> {
        self.table().and_then(|table| SessionCheck::new(&table).ok())
    }

    /// The arm of the table, if it has so many segments.
    pub fn arm(&self, segments: usize) -> Option<&ArmFile> {
        self.table.as_ref().map(|(_, file)| file).filter(|file| file.segments.len() == segments)
    }

    fn table(&self) -> Option<LoadedTable<'_>> {
        self.table.as_ref().map(|(path, file)| LoadedTable { file: file.clone(), path })
    }

    /// The files of the folder, by name.
    pub fn list(&self) -> Vec<SessionEntry> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let file = |entry: fs::DirEntry| {
            let name = entry.file_name().into_string().ok().filter(|name| is_session(name))?;
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
        let is_plain = Path::new(name).file_name().is_some_and(|plain| plain == name);
        Some(self.folder.join(name)).filter(|path| is_plain && is_session(name) && path.is_file())
    }

    /// Replays a session and returns its rows between two times, decimated to as many as a page holds. Errors have its name in
    /// place of its path, which is that of a copy where a browser has sent it.
    pub fn rows(&self, name: &str, path: &Path, times_s: RangeInclusive<f64>) -> Result<Vec<u8>, Error> {
        self.rows_of(path, &times_s).map_err(|error| match error {
            Error::File(proprio_session::Error::Session(error)) => SessionError { path: name.into(), ..error }.into(),
            other => other,
        })
    }

    fn rows_of(&self, path: &Path, times_s: &RangeInclusive<f64>) -> Result<Vec<u8>, Error> {
        let Some(table) = self.table() else { return Ok(Vec::new()) };
        let file = &table.file;
        let segments = file.segments.len();
        let mut reader = SessionReader::open(path, &table.required_columns()?)?;
        let compiled = table.compile::<Q>(reader.rate_hz(file.rate_hz)?)?;
        let compiled = compiled.config();
        let mut replica = HostReplica::new(&compiled);
        let mut check = SessionCheck::new(&table)?;
        let mut history = History::new(page_row::names(segments).len());
        let (mut samples, mut every) = (0, 1);
        while let Some(read) = reader.next_row()? {
            let mut row = PageRow::new(read.sample.time_us as f64 / 1e6, segments);
            if read.starts {
                replica.start();
            }
            if read.is_comparable() {
                replica.step(&read.sample, &mut row);
            }
            if !read.is_recorded() {
                continue;
            }
            check.update(&read);
            if let Some(estimate) = read.board.as_ref().and_then(|board| board.estimate.as_ref()) {
                row.set_estimate(&estimate.segments);
            }
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
        let arm = ArmDescription::new(segments, Some(file));
        Ok(history.to_bytes(&About { arm, samples, every, marks, findings }))
    }
}

/// True for a name with the ending of a session.
fn is_session(name: &str) -> bool {
    let extension = Path::new(name).extension();
    ["csv", "mcap", "bin"]
        .iter()
        .any(|ending| extension.is_some_and(|extension| extension.eq_ignore_ascii_case(ending)))
}
