//! Output files that are complete or absent, and replace no other file unasked.

use std::fmt;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

use crate::Error;

/// Treatment of a file that has the name of an output already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// It stays, and the output is refused, unless the file is empty.
    Keep,
    /// The complete output replaces it.
    Replace,
}

/// True for the name of an output that stands for standard output: `-`.
#[must_use]
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// An output file that is written under a temporary name and renamed when it is complete.
///
/// A pipe or device of that name is written to directly, and so is standard output.
pub struct OutputFile {
    path: PathBuf,
    existing: Existing,
    sink: Sink,
    bytes: u64,
}

/// A complete output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrittenFile {
    /// Its name.
    pub path: PathBuf,
    /// Its length, bytes.
    pub bytes: u64,
}

impl fmt::Display for WrittenFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} bytes written", self.path.display(), self.bytes)
    }
}

enum Sink {
    Aside(BufWriter<NamedTempFile>),
    Direct(BufWriter<fs::File>),
    Stdout(BufWriter<io::Stdout>),
}

impl OutputFile {
    /// Begins a file that is to be named `path`, or standard output for `-`. It must not be one of the `inputs` that it is
    /// made from: a recording cannot be made again.
    ///
    /// # Errors
    /// [`Error::Overwrite`], [`Error::Exists`], and [`Error::Output`] where the folder does not exist or cannot be written to.
    pub fn create(path: &Path, inputs: &[&Path], existing: Existing) -> Result<Self, Error> {
        if is_stdout(path) {
            let sink = Sink::Stdout(BufWriter::new(io::stdout()));
            return Ok(Self { path: PathBuf::from("standard output"), existing, sink, bytes: 0 });
        }
        let same =
            |input: &&Path| fs::canonicalize(input).is_ok_and(|input| fs::canonicalize(path).is_ok_and(|p| p == input));
        if inputs.iter().any(same) {
            return Err(Error::Overwrite(path.to_owned()));
        }
        existing.check(path)?;
        // A file that is there may be replaced from here on, also one that this command's own standard output fills.
        let existing = if path.exists() { Existing::Replace } else { existing };
        let target = target(path);
        let sink = Sink::open(&target).map_err(|source| Error::Output { path: path.to_owned(), source })?;
        Ok(Self { path: target, existing, sink, bytes: 0 })
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// [`Error::Output`] where the disk is full or the file cannot be renamed, [`Error::Exists`] where another program has
    /// made a file of this name meanwhile; no temporary file is left.
    pub fn finish(self) -> Result<WrittenFile, Error> {
        let Self { path, existing, sink, bytes } = self;
        if let Sink::Aside(_) = &sink {
            existing.check(&path)?;
        }
        match sink.finish(&path) {
            Ok(()) => Ok(WrittenFile { path, bytes }),
            Err(source) => Err(Error::Output { path, source }),
        }
    }

    /// An [`Error::Output`] of this file.
    #[must_use]
    pub fn error(&self, source: io::Error) -> Error {
        Error::Output { path: self.path.clone(), source }
    }
}

impl Existing {
    /// Refuses a file that would be replaced unasked.
    fn check(self, path: &Path) -> Result<(), Error> {
        let is_filled = fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() > 0);
        if self == Self::Keep && is_filled { Err(Error::Exists(path.to_owned())) } else { Ok(()) }
    }
}

/// Temporary files of unfinished outputs.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of unfinished outputs, for a program that is interrupted.
pub fn discard_unfinished() {
    for path in unfinished().drain(..) {
        // A file that was renamed meanwhile no longer has this name.
        let _ = fs::remove_file(path);
    }
}

/// The file that a link points to, so that the link stays; a pipe or device keeps the name that it was given by.
fn target(path: &Path) -> PathBuf {
    let is_link = fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink());
    match fs::metadata(path) {
        Ok(found) if is_link && found.is_file() => fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()),
        Err(_) if is_link => {
            let folder = path.parent().unwrap_or(Path::new(""));
            fs::read_link(path).map_or_else(|_| path.to_owned(), |to| folder.join(to))
        }
        _ => path.to_owned(),
    }
}

impl Sink {
    fn open(path: &Path) -> io::Result<Self> {
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if found.permissions().readonly() => return Err(io::ErrorKind::PermissionDenied.into()),
            Ok(found) if !found.is_file() => {
                return Ok(Self::Direct(BufWriter::new(fs::OpenOptions::new().write(true).open(path)?)));
            }
            _ => {}
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        fs::metadata(folder)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".proprio-").suffix(".part");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder)?;
        unfinished().push(file.path().to_owned());
        Ok(Self::Aside(BufWriter::new(file)))
    }

    fn finish(self, path: &Path) -> io::Result<()> {
        match self {
            Self::Direct(mut file) => file.flush(),
            Self::Stdout(mut stdout) => ignore_closed_reader(stdout.flush()),
            Self::Aside(file) => {
                let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
                file.as_file().sync_all()?;
                file.persist(path).map(|_| ()).map_err(|error| error.error)
            }
        }
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = match &mut self.sink {
            Sink::Aside(file) => file.write(bytes),
            Sink::Direct(file) => file.write(bytes),
            Sink::Stdout(stdout) => ignore_closed_reader(stdout.write_all(bytes)).map(|()| bytes.len()),
        }?;
        self.bytes += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.sink {
            Sink::Aside(file) => file.flush(),
            Sink::Direct(file) => file.flush(),
            Sink::Stdout(stdout) => ignore_closed_reader(stdout.flush()),
        }
    }
}

/// The result of a write to standard output, whose reader may close it early, as `head` does.
fn ignore_closed_reader(written: io::Result<()>) -> io::Result<()> {
    match written {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}
