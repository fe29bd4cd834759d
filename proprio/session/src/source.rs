//! A session's file: its format, and its bytes from the first on.

use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::foreign_file::ForeignFile;
use crate::output::is_stdout;
use crate::recording::{ReadError, Summary, is_damaged_begin, is_recording};
use crate::{SessionError, SessionProblem};

/// Bytes at the start by which the format is detected.
const BEGIN: u64 = 32;

/// Format of a session's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileFormat {
    /// Text, one row per sample.
    Csv,
    /// A board's recording.
    Recording,
    /// The received bytes of a board.
    Raw,
}

impl FileFormat {
    /// Detects the format by the first bytes; raw bytes have no signature and are recognised by the name, `.bin`.
    fn of(path: &Path, begin: &[u8]) -> Self {
        if is_recording(begin) {
            Self::Recording
        } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("bin")) {
            Self::Raw
        } else {
            Self::Csv
        }
    }

    /// The format that the name of an output selects: that of its ending, CSV on standard output.
    #[must_use]
    pub fn of_output(path: &Path) -> Option<Self> {
        if is_stdout(path) {
            return Some(Self::Csv);
        }
        match path.extension().unwrap_or_default().to_ascii_lowercase().to_str() {
            Some("csv") => Some(Self::Csv),
            Some("mcap") => Some(Self::Recording),
            Some("bin") => Some(Self::Raw),
            _ => None,
        }
    }
}

/// A session's file that was opened, with its format.
pub(crate) struct SessionFile {
    pub path: PathBuf,
    pub kind: FileFormat,
    pub size_bytes: u64,
    /// Neither a pipe nor a device.
    pub is_regular_file: bool,
    begin: Vec<u8>,
    file: File,
}

impl SessionFile {
    pub fn open(path: &Path) -> Result<Self, SessionError> {
        let fail = |problem| SessionError { path: path.to_owned(), line: None, column: None, problem };
        let mut file = File::open(path).map_err(|error| fail(SessionProblem::Read(error)))?;
        let metadata = file.metadata().map_err(|error| fail(SessionProblem::Read(error)))?;
        if metadata.is_dir() {
            return Err(fail(SessionProblem::Directory));
        }
        let mut begin = Vec::new();
        file.by_ref().take(BEGIN).read_to_end(&mut begin).map_err(|error| fail(SessionProblem::Read(error)))?;
        if is_damaged_begin(&begin) {
            let problem = ReadError::Damaged("its first bytes are not those of an MCAP file".to_owned());
            return Err(fail(SessionProblem::Recording(problem)));
        }
        let kind = FileFormat::of(path, &begin);
        if let Some(foreign) = ForeignFile::of(path, &begin).filter(|_| kind == FileFormat::Csv) {
            return Err(fail(SessionProblem::Foreign(foreign)));
        }
        Ok(Self {
            path: path.to_owned(),
            kind,
            size_bytes: metadata.len(),
            is_regular_file: metadata.is_file(),
            begin,
            file,
        })
    }

    /// The first bytes, by which the format is detected.
    pub fn begin(&self) -> &[u8] {
        &self.begin
    }

    /// True where the last byte is a line end; also for a pipe, whose last byte is not known before it is read.
    pub fn ends_with_line(&mut self) -> Result<bool, SessionError> {
        let mut last = [b'\n'];
        if self.is_regular_file && self.file.seek(SeekFrom::End(-1)).is_ok() {
            self.file.read_exact(&mut last).map_err(|error| self.error(SessionProblem::Read(error)))?;
        }
        Ok(last == [b'\n'])
    }

    /// The index of a recording; empty for other files and for a pipe.
    pub fn summary(&mut self) -> Result<Summary, SessionError> {
        if self.kind != FileFormat::Recording || !self.is_regular_file {
            return Ok(Summary::default());
        }
        Summary::of(&mut self.file).map_err(|error| self.error(SessionProblem::Read(error)))
    }

    /// The bytes from the first on.
    pub fn into_bytes(mut self) -> Result<Box<dyn Read>, SessionError> {
        if !self.is_regular_file {
            // A pipe cannot go back.
            return Ok(Box::new(Cursor::new(self.begin).chain(self.file)));
        }
        self.file.rewind().map_err(|error| self.error(SessionProblem::Read(error)))?;
        Ok(Box::new(self.file))
    }

    /// The bytes from the first on, and the counter of those that were read.
    pub fn into_counted(self) -> Result<(BufReader<Counted>, Arc<AtomicU64>), SessionError> {
        let position = Arc::new(AtomicU64::new(0));
        let counted = Counted { bytes: self.into_bytes()?, position: Arc::clone(&position) };
        Ok((BufReader::with_capacity(1 << 16, counted), position))
    }

    /// A problem of the whole file.
    pub fn error(&self, problem: SessionProblem) -> SessionError {
        SessionError { path: self.path.clone(), line: None, column: None, problem }
    }
}

/// Counts the bytes that are read.
pub(crate) struct Counted {
    bytes: Box<dyn Read>,
    position: Arc<AtomicU64>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.bytes.read(buffer)?;
        self.position.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}
