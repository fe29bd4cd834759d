//! Commands of other programs: in the syntax of a shell, and run.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fmt, io};

use super::FlashError;

/// A command of another program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ToolCommand {
    /// Folder that it runs in; `None`: the current one.
    folder: Option<PathBuf>,
    program: String,
    arguments: Vec<String>,
}

impl ToolCommand {
    /// A command in the current folder.
    #[must_use]
    pub fn new(program: &str, arguments: &[&str]) -> Self {
        let arguments = arguments.iter().map(|argument| (*argument).to_owned()).collect();
        Self { folder: None, program: program.to_owned(), arguments }
    }

    /// The same in another folder.
    #[must_use]
    pub fn in_folder(self, folder: &Path) -> Self {
        Self { folder: Some(folder.to_owned()), ..self }
    }

    /// Runs it; its output goes to standard error.
    ///
    /// # Errors
    /// [`FlashError::Missing`], [`FlashError::Start`] and [`FlashError::Failed`].
    pub fn run(&self) -> Result<(), FlashError> {
        let status = self.command().stdout(io::stderr()).status().map_err(|source| self.start_error(source))?;
        if status.success() { Ok(()) } else { Err(self.failed(status)) }
    }

    /// Runs it and returns its standard output.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn output(&self) -> Result<String, FlashError> {
        let output = self.command().stderr(Stdio::inherit()).output().map_err(|source| self.start_error(source))?;
        if output.status.success() {
            Ok(String::from_utf8_lossy(&output.stdout).into_owned())
        } else {
            Err(self.failed(output.status))
        }
    }

    fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.args(&self.arguments).stdin(Stdio::null());
        if let Some(folder) = &self.folder {
            command.current_dir(folder);
        }
        command
    }

    fn start_error(&self, source: io::Error) -> FlashError {
        match source.kind() {
            io::ErrorKind::NotFound => FlashError::Missing(self.program.clone()),
            _ => FlashError::Start { program: self.program.clone(), source },
        }
    }

    fn failed(&self, status: std::process::ExitStatus) -> FlashError {
        FlashError::Failed { program: self.program.clone(), command: self.to_string(), status }
    }
}

/// In the syntax of a shell.
impl fmt::Display for ToolCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(folder) = &self.folder {
            write!(f, "(cd {} && ", quoted(&folder.to_string_lossy()))?;
        }
        f.write_str(&quoted(&self.program))?;
        self.arguments.iter().try_for_each(|argument| write!(f, " {}", quoted(argument)))?;
        if self.folder.is_some() { f.write_str(")") } else { Ok(()) }
    }
}

/// A word in the syntax of a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/\\._-+:=,".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}
