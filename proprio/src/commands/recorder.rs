//! A recording under way: its file, and what goes into it.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter};
use std::path::Path;

use proprio::error::Error;
use proprio::link::{Event, HostClock, HostNs, Link, Subscription};
use proprio::recording::Recorder;
use proprio::replay::NamedTable;
use telemetry::SetPressures;

type Output = Recorder<BufWriter<File>>;

/// A recording that is being made of a link.
pub struct FileRecorder<'p> {
    recorder: Output,
    path: &'p Path,
    clock: HostClock,
}

impl<'p> FileRecorder<'p> {
    /// Begins a file of this name, where there was none.
    pub fn create(path: &'p Path, link: &Link, table: Option<&NamedTable>) -> Result<Self, Error> {
        let (clock, failed) = (HostClock::new(), |source| Error::Output { path: path.to_owned(), source });
        let line = link.state().port.unwrap_or_default();
        let mut recorder = Recorder::new(BufWriter::new(create(path)?), clock.now(), &line).map_err(failed)?;
        if let Some(table) = table {
            recorder.attach_table(clock.now(), &table.toml()?).map_err(failed)?;
        }
        Ok(Self { recorder, path, clock })
    }

    /// Its file.
    pub fn path(&self) -> &'p Path {
        self.path
    }

    /// Samples so far.
    pub fn samples(&self) -> u64 {
        self.recorder.samples()
    }

    /// Writes what came, if it is of those that are recorded.
    pub fn take(&mut self, event: &Event) -> Result<(), Error> {
        self.written(|recorder, _| recorder.event(event))
    }

    /// Writes what was asked of the pressures.
    pub fn set_points(&mut self, asked: &SetPressures) -> Result<(), Error> {
        self.written(|recorder, now| recorder.set_points(now, asked))
    }

    /// Nothing came.
    pub fn wait(&mut self) -> Result<(), Error> {
        self.written(Recorder::flush_if_due)
    }

    fn written(&mut self, write: impl FnOnce(&mut Output, HostNs) -> io::Result<()>) -> Result<(), Error> {
        let now = self.clock.now();
        write(&mut self.recorder, now).map_err(|source| Error::Output { path: self.path.to_owned(), source })
    }

    /// Takes what has come until now.
    pub fn take_rest(&mut self, events: &Subscription) -> Result<(), Error> {
        self.written(|recorder, _| recorder.rest(events))
    }

    /// Completes the file.
    pub fn finish(self) -> Result<(), Error> {
        let failed = |source| Error::Output { path: self.path.to_owned(), source };
        self.recorder.finish().map(drop).map_err(failed)
    }
}

/// Whether a recording of this name can be begun, as far as that can be seen before.
pub fn check(path: &Path) -> Result<(), Error> {
    if path.is_file() { Err(Error::Exists(path.to_owned())) } else { Ok(()) }
}

/// A recording cannot be had again, and none is replaced. A pipe or device is written to.
fn create(path: &Path) -> Result<File, Error> {
    let is_other = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    let mut options = OpenOptions::new();
    let options = if is_other { options.write(true) } else { options.write(true).create_new(true) };
    options.open(path).map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => Error::Exists(path.to_owned()),
        _ => Error::Output { path: path.to_owned(), source },
    })
}
