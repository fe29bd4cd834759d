//! Output files that are complete or absent.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

use crate::Error;

/// An output file that is written under a temporary name and renamed when it is complete.
///
/// A pipe or device of that name is written to directly.
pub struct OutputFile {
    path: PathBuf,
    sink: Sink,
}

enum Sink {
    Aside(BufWriter<NamedTempFile>),
    Direct(BufWriter<fs::File>),
}

impl OutputFile {
    /// Begins a file that is to be named `path`; an existing file of that name stays until [`OutputFile::finish`]. It must
    /// not be one of the `inputs` that it is made from: a recording cannot be made again.
    ///
    /// # Errors
    /// [`Error::Overwrite`], and [`Error::Output`] where the folder does not exist or cannot be written to.
    pub fn create(path: &Path, inputs: &[&Path]) -> Result<Self, Error> {
        let same =
            |input: &&Path| fs::canonicalize(input).is_ok_and(|input| fs::canonicalize(path).is_ok_and(|p| p == input));
        if inputs.iter().any(same) {
            return Err(Error::Overwrite(path.to_owned()));
        }
        let target = target(path);
        let sink = Sink::open(&target).map_err(|source| Error::Output { path: path.to_owned(), source })?;
        Ok(Self { path: target, sink })
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// [`Error::Output`] where the disk is full or the file cannot be renamed; no temporary file is left.
    pub fn finish(self) -> Result<(), Error> {
        let path = self.path;
        self.sink.finish(&path).map_err(|source| Error::Output { path, source })
    }

    /// An [`Error::Output`] of this file.
    #[must_use]
    pub fn error(&self, source: io::Error) -> Error {
        Error::Output { path: self.path.clone(), source }
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
        match &mut self.sink {
            Sink::Aside(file) => file.write(bytes),
            Sink::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.sink {
            Sink::Aside(file) => file.flush(),
            Sink::Direct(file) => file.flush(),
        }
    }
}
