//! Recording of a link to a file.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::time::Duration;

use proprio_session::recording::Recorder;
use proprio_session::{Error, HostClock, HostNs};
use telemetry::SetPressures;

use crate::event::{Event, What};
use crate::handle::{Link, Subscription};

type FileSink = Recorder<BufWriter<File>>;

/// Recording of a link to a new file.
pub struct FileRecorder {
    recorder: FileSink,
    path: PathBuf,
    clock: HostClock,
}

impl FileRecorder {
    /// Creates the file, with the table of the board attached as its TOML stands.
    ///
    /// # Errors
    /// [`Error::Exists`] where there is a file of this name, which is never replaced; [`Error::Output`].
    pub fn create(path: &Path, link: &Link, clock: HostClock, table_toml: Option<&[u8]>) -> Result<Self, Error> {
        let failed = |source| Error::Output { path: path.to_owned(), source };
        let line = link.state().port.unwrap_or_default();
        let mut recorder = Recorder::new(BufWriter::new(create(path)?), clock.now(), &line).map_err(failed)?;
        if let Some(toml) = table_toml {
            recorder.attach_table(clock.now(), toml).map_err(failed)?;
        }
        Ok(Self { recorder, path: path.to_owned(), clock })
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

    /// Writes an event, if it is of the kinds that are recorded: bytes and messages.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn event(&mut self, event: &Event) -> Result<(), Error> {
        self.write(|recorder, _| match &event.what {
            What::Bytes(bytes) => recorder.bytes(event.at, bytes),
            What::Message(message) => recorder.message(event.at, message),
            _ => Ok(()),
        })
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

    /// Writes the pressures that the host has requested.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn set_points(&mut self, requested: &SetPressures) -> Result<(), Error> {
        self.write(|recorder, now| recorder.set_points(now, requested))
    }

    /// Writes a mark that a person has set.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn mark(&mut self, at: HostNs, text: &str) -> Result<(), Error> {
        self.write(|recorder, _| recorder.mark(at, text))
    }

    /// Writes to the file what has waited for a second; called where no event came.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn flush_if_due(&mut self) -> Result<(), Error> {
        self.write(Recorder::flush_if_due)
    }

    /// Completes the file.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn finish(self) -> Result<(), Error> {
        let Self { recorder, path, .. } = self;
        recorder.finish().map(drop).map_err(|source| Error::Output { path, source })
    }

    fn write(&mut self, write: impl FnOnce(&mut FileSink, HostNs) -> io::Result<()>) -> Result<(), Error> {
        let now = self.clock.now();
        write(&mut self.recorder, now).map_err(|source| Error::Output { path: self.path.clone(), source })
    }
}

/// Creates a file that did not exist: a recording cannot be made again, and none is replaced. A pipe or device is written to.
fn create(path: &Path) -> Result<File, Error> {
    let is_other = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    let mut options = OpenOptions::new();
    let options = if is_other { options.write(true) } else { options.write(true).create_new(true) };
    options.open(path).map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => Error::Exists(path.to_owned()),
        _ => Error::Output { path: path.to_owned(), source },
    })
}
