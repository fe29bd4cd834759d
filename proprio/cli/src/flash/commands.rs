//! Commands that flash a board, as in docs/how-to/flashing.md.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fmt, io};

use super::FlashError;

const TARGET: &str = "thumbv7m-none-eabi";
const CHIP: &str = "ATSAM3X8E";

/// Environment variable with the folders of libraries.
const LIBRARY_PATH: Option<&str> = if cfg!(target_os = "macos") {
    Some("DYLD_LIBRARY_PATH")
} else if cfg!(unix) {
    Some("LD_LIBRARY_PATH")
} else {
    None
};

/// A command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FlashCommand {
    /// Environment variable of the command.
    variable: Option<(&'static str, String)>,
    program: String,
    arguments: Vec<String>,
}

/// The commands that flash a board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Flashing {
    source: PathBuf,
    steps: Vec<FlashCommand>,
}

impl Flashing {
    /// The commands that flash the firmware in `source` with `table`: through probe-rs if a probe is found, else with bossac
    /// over `port`, for which `image` is written.
    ///
    /// # Errors
    /// [`FlashError::NoSource`], and errors of `probe-rs list` and the toolchain.
    pub fn plan(source: &Path, table: &Path, port: &str, image: &Path) -> Result<Self, FlashError> {
        if !source.join("firmware/Cargo.toml").is_file() {
            return Err(FlashError::NoSource(source.to_owned()));
        }
        let source = absolute(source);
        // Cargo takes a relative path from the folder that it runs in.
        let target = env::var("CARGO_TARGET_DIR").unwrap_or_else(|_| "target".to_owned());
        let elf = format!("{target}/{TARGET}/firmware/firmware");
        let build = FlashCommand {
            variable: Some(("PROPRIO_TABLE", text(&absolute(table)))),
            ..FlashCommand::new("cargo", &["build", "--profile", "firmware", "-p", "firmware", "--target", TARGET])
        };
        let mut steps = vec![build];
        if is_probe_found()? {
            steps.push(FlashCommand::new("probe-rs", &["download", "--chip", CHIP, "--verify", &elf]));
            steps.push(FlashCommand::new("probe-rs", &["reset", "--chip", CHIP]));
        } else {
            let image = text(image);
            // bossac adds the folder itself.
            let port = port.strip_prefix("/dev/").unwrap_or(port);
            steps.push(objcopy(&source, &elf, &image)?);
            steps.push(FlashCommand::new("bossac", &["-a", "-p", port, "-U0", "-e", "-w", "-v", "-b", "-R", &image]));
        }
        Ok(Self { source, steps })
    }

    /// Checks that all programs exist, before the first one runs.
    ///
    /// # Errors
    /// [`FlashError::Missing`] and [`FlashError::NoObjcopy`].
    pub fn check(&self) -> Result<(), FlashError> {
        self.steps.iter().try_for_each(|step| {
            let path = Path::new(&step.program);
            match (path.is_absolute(), is_on_path(&step.program)) {
                (true, _) if !path.is_file() => Err(FlashError::NoObjcopy(path.to_owned())),
                (false, false) => Err(FlashError::Missing(step.program.clone())),
                _ => Ok(()),
            }
        })
    }

    /// The commands, in their order.
    #[must_use]
    pub fn steps(&self) -> &[FlashCommand] {
        &self.steps
    }

    /// Runs one of the commands; its output goes to standard error.
    ///
    /// # Errors
    /// [`FlashError::Start`] and [`FlashError::Failed`].
    pub fn run(&self, step: &FlashCommand) -> Result<(), FlashError> {
        let mut command = Command::new(&step.program);
        command.args(&step.arguments).envs(step.variable.clone()).current_dir(&self.source);
        command.stdin(Stdio::null()).stdout(io::stderr());
        let status = command.status().map_err(|source| start(&step.program, source))?;
        if status.success() {
            return Ok(());
        }
        Err(FlashError::Failed { program: step.program.clone(), command: step.to_string(), status })
    }
}

/// In the syntax of a shell.
impl fmt::Display for Flashing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "cd {}", quoted(&text(&self.source)))?;
        self.steps.iter().try_for_each(|step| writeln!(f, "{step}"))
    }
}

impl FlashCommand {
    fn new(program: &str, arguments: &[&str]) -> Self {
        let arguments = arguments.iter().map(|argument| (*argument).to_owned()).collect();
        Self { variable: None, program: program.to_owned(), arguments }
    }
}

/// In the syntax of a shell.
impl fmt::Display for FlashCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, value)) = &self.variable {
            write!(f, "{name}={} ", quoted(value))?;
        }
        f.write_str(&quoted(&self.program))?;
        self.arguments.iter().try_for_each(|argument| write!(f, " {}", quoted(argument)))
    }
}

fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/\\._-+:=,".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

fn absolute(path: &Path) -> PathBuf {
    // It fails for an empty path only.
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

fn start(program: &str, source: io::Error) -> FlashError {
    match source.kind() {
        io::ErrorKind::NotFound => FlashError::Missing(program.to_owned()),
        _ => FlashError::Start { program: program.to_owned(), source },
    }
}

/// Output of a program that runs in `folder`.
fn output(program: &str, arguments: &[&str], folder: &Path) -> Result<String, FlashError> {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).stderr(Stdio::inherit());
    let output = command.output().map_err(|source| start(program, source))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let command = FlashCommand::new(program, arguments).to_string();
    Err(FlashError::Failed { program: program.to_owned(), command, status: output.status })
}

/// True where probe-rs is installed and finds a probe: it lists each in a line that begins with its number in brackets.
fn is_probe_found() -> Result<bool, FlashError> {
    match output("probe-rs", &["list"], Path::new(".")) {
        Ok(list) => Ok(list.lines().any(|line| line.trim_start().starts_with('['))),
        Err(FlashError::Missing(_)) => Ok(false),
        Err(error) => Err(error),
    }
}

/// The objcopy of the pinned toolchain, which is that of the source's folder.
fn objcopy(source: &Path, elf: &str, image: &str) -> Result<FlashCommand, FlashError> {
    let printed = |what| output("rustc", &["--print", what], source).map(|line| line.trim().to_owned());
    let (sysroot, host) = (printed("sysroot")?, printed("host-tuple")?);
    let program = format!("{sysroot}/lib/rustlib/{host}/bin/rust-objcopy{}", env::consts::EXE_SUFFIX);
    // By default it does not search the folder of the toolchain's LLVM.
    let variable = LIBRARY_PATH.map(|name| (name, format!("{sysroot}/lib")));
    Ok(FlashCommand { variable, ..FlashCommand::new(&program, &["-O", "binary", elf, image]) })
}

fn is_on_path(program: &str) -> bool {
    let file = format!("{program}{}", env::consts::EXE_SUFFIX);
    let path = env::var_os("PATH");
    env::split_paths(path.as_deref().unwrap_or(OsStr::new(""))).any(|folder| folder.join(&file).is_file())
}
