//! Recording of a link to a file.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use proprio_session::recording::Recorder;
use proprio_session::{Error, HostClock, HostNs, is_stdout};

use crate::event::{EventKind, LinkEvent};
use crate::handle::Link;
use crate::history::ReceivedBytes;
use crate::shared::Subscription;

/// Recording of a link to a new file, or to standard output.
pub struct FileRecorder {
    recorder: Recorder<BufWriter<Box<dyn Write + Send>>>,
    path: PathBuf,
    clock: HostClock,
}

impl FileRecorder {
    /// Creates the file, with the table of the board attached as its TOML stands.
    ///
    /// # Errors
    /// [`Error::RecordingExists`] where there is a file of this name, which is never replaced; [`Error::Output`].
    pub fn create(path: &Path, link: &Link, clock: HostClock, table_toml: Option<&[u8]>) -> Result<Self, Error> {
        let failed = |source| Error::Output { path: path.to_owned(), source };
        let line = link.state().port.unwrap_or_default();
        let mut recorder = Recorder::new(BufWriter::new(create(path)?), clock.now(), &line).map_err(failed)?;
        if let Some(toml) = table_toml {
            recorder.attach_table(clock.now(), toml).map_err(failed)?;
        }
        Ok(Self { recorder, path: path.to_owned(), clock })
    }

    /// Writes the bytes that were received before the first event, so that a replay begins with the state of the board's
    /// estimator.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn history(&mut self, history: &[ReceivedBytes]) -> Result<(), Error> {
        let written = history.iter().try_for_each(|(at, bytes)| self.recorder.history(*at, bytes));
        self.named(written)
    }

    /// Its file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Samples so far.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.recorder.samples()
    }

    /// Writes an event, if it is of the kinds that are recorded: bytes, messages, and requested pressures.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn event(&mut self, event: &LinkEvent) -> Result<(), Error> {
        let written = match &event.kind {
            EventKind::Bytes(bytes) => self.recorder.bytes(event.at, bytes),
            EventKind::Message(message) => self.recorder.message(event.at, message),
            EventKind::SetPoints(requested) => self.recorder.set_points(event.at, requested),
            _ => Ok(()),
        };
        self.named(written)
    }

    /// Writes all events that are waiting.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn remaining_events(&mut self, events: &Subscription) -> Result<(), Error> {
        while let Some(event) = events.next(Duration::ZERO) {
            self.event(&event)?;
        }
        Ok(())
    }

    /// Writes a mark that a person has set.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn mark(&mut self, at: HostNs, text: &str) -> Result<(), Error> {
        let written = self.recorder.mark(at, text);
        self.named(written)
    }

    /// Writes to the file what has waited for a second; called where no event came.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn flush_if_due(&mut self) -> Result<(), Error> {
        let written = self.recorder.flush_if_due(self.clock.now());
        self.named(written)
    }

    /// Completes the file.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn finish(self) -> Result<(), Error> {
        let Self { recorder, path, .. } = self;
        recorder.finish().map(drop).map_err(|source| Error::Output { path, source })
    }

    /// Removes the file, of a board that has sent nothing. What a pipe or device has got stays there.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn discard(self) -> Result<(), Error> {
        let Self { recorder, path, .. } = self;
        drop(recorder);
        let removed = if !is_stdout(&path) && path.is_file() { fs::remove_file(&path) } else { Ok(()) };
        removed.map_err(|source| Error::Output { path, source })
    }

    /// Names the file in an error.
    fn named(&self, written: io::Result<()>) -> Result<(), Error> {
        written.map_err(|source| Error::Output { path: self.path.clone(), source })
    }
}

/// Creates a file that did not exist: a recording cannot be made again, and none is replaced. A pipe or device is written to.
fn create(path: &Path) -> Result<Box<dyn Write + Send>, Error> {
    if is_stdout(path) {
        return Ok(Box::new(io::stdout()));
    }
    let is_other = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    let mut options = OpenOptions::new();
    let options = if is_other { options.write(true) } else { options.write(true).create_new(true) };
    match options.open(path) {
        Ok(file) => Ok(Box::new(file)),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(Error::RecordingExists(path.to_owned())),
        Err(source) => Err(Error::Output { path: path.to_owned(), source }),
    }
}
