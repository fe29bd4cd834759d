//! Runs the tool in a folder of its own, and edits sessions cell by cell.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::{fmt, fs};

use serde_json::Value;
use tempfile::TempDir;

/// Output of a run of the tool.
#[derive(Debug)]
pub struct Run {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("the tool writes UTF-8");
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

impl Run {
    /// The lines on stderr other than those that name a written file.
    pub fn warnings(&self) -> Vec<&str> {
        self.stderr.lines().filter(|line| !line.ends_with(" bytes written")).collect()
    }
}

/// A folder that the tool runs in.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("there is room for a temporary folder"))
    }

    /// A folder with one file.
    pub fn with(name: &str, contents: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        folder.write(name, contents);
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.path(name), contents).expect("a temporary folder can be written to");
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub fn csv(&self, name: &str) -> Csv {
        Csv::parse(&self.read(name))
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_proprio"));
        command.current_dir(self.0.path()).args(args).stdin(Stdio::null());
        for variable in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
            command.env_remove(variable);
        }
        command
    }

    pub fn run(&self, args: &[&str]) -> Run {
        self.command(args).output().expect("the tool starts").into()
    }

    /// A run that must succeed.
    pub fn done(&self, args: &[&str]) -> Run {
        let run = self.run(args);
        assert_eq!(run.code, Some(0), "{args:?}: {}", run.stderr);
        run
    }

    /// A run that must be refused as bad input is: exit status 2, one error and its help on stderr, nothing on stdout,
    /// and the folder as it was. Returns the error without its `error: `.
    pub fn refused(&self, args: &[&str]) -> String {
        let before = self.contents();
        let run = self.run(args);
        assert_eq!(run.code, Some(2), "{args:?}: {}{}", run.stdout, run.stderr);
        assert_eq!(run.stdout, "", "{args:?}: nothing on stdout");
        let error = error_of(&run.stderr);
        assert!(before == self.contents(), "{args:?}: no file came, went or changed");
        error
    }

    /// Every file, hidden ones as well.
    fn contents(&self) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
        let entries = fs::read_dir(self.0.path()).expect("the folder is there");
        let paths = entries.map(|entry| entry.expect("the folder can be listed").path());
        paths.map(|path| (path.clone(), fs::read(&path).ok())).collect()
    }
}

/// The one error in `stderr`, which has a help line below it, and nothing but warnings above it.
pub fn error_of(stderr: &str) -> String {
    let lines: Vec<&str> = stderr.lines().skip_while(|line| line.starts_with("warning: ")).collect();
    let [error @ .., help] = &lines[..] else { panic!("nothing on stderr") };
    let help = help.strip_prefix("  help: ").unwrap_or_else(|| panic!("the last line is no help: {stderr}"));
    assert!(!help.trim().is_empty(), "{stderr}");
    assert_eq!(stderr.matches("error:").count(), 1, "{stderr}");
    error
        .join("\n")
        .strip_prefix("error: ")
        .unwrap_or_else(|| panic!("the first line is no error: {stderr}"))
        .to_owned()
}

/// A session or an estimate: names and cells as text.
#[derive(Debug, Clone, PartialEq)]
pub struct Csv {
    pub names: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Csv {
    pub fn parse(text: &str) -> Self {
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect());
        let names = lines.next().expect("a header");
        Self { names, rows: lines.collect() }
    }

    pub fn has(&self, name: &str) -> bool {
        self.names.iter().any(|other| other == name)
    }

    pub fn column(&self, name: &str) -> usize {
        self.names.iter().position(|other| other == name).unwrap_or_else(|| panic!("there is no column {name}"))
    }

    pub fn cell(&self, row: usize, name: &str) -> &str {
        &self.rows[row][self.column(name)]
    }

    pub fn set(&mut self, row: usize, name: &str, value: &str) {
        let column = self.column(name);
        value.clone_into(&mut self.rows[row][column]);
    }

    /// The numbers of a column that has no empty cell.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        let column = self.column(name);
        let number = |text: &String| text.parse().unwrap_or_else(|_| panic!("column {name}: {text:?} is no number"));
        self.rows.iter().map(|row| number(&row[column])).collect()
    }

    /// Replaces every cell of a column by a function of its row's number and its text.
    pub fn map(&mut self, name: &str, mut cell: impl FnMut(usize, &str) -> String) {
        let column = self.column(name);
        for (i, row) in self.rows.iter_mut().enumerate() {
            row[column] = cell(i, &row[column]);
        }
    }

    /// Sets the truth of an arm of six segments to the fused `estimates`, from a row on.
    pub fn follow(&mut self, estimates: &Self, from: usize) {
        let mut heading = vec![0.0; self.rows.len()];
        for i in 1..=6 {
            let thetas = estimates.numbers(&format!("fusion{i}_theta_deg"));
            heading.iter_mut().zip(thetas).for_each(|(heading, theta)| *heading += theta);
            let [x, y] = ["x", "y"].map(|axis| estimates.numbers(&format!("fusion{i}_{axis}_mm")));
            for (part, values) in [("x_mm", &x), ("y_mm", &y), ("heading_deg", &heading)] {
                let name = format!("truth{i}_{part}");
                self.map(&name, |row, cell| if row < from { cell.to_owned() } else { values[row].to_string() });
            }
        }
    }

    pub fn rename(&mut self, from: &str, to: &str) {
        let column = self.column(from);
        to.clone_into(&mut self.names[column]);
    }

    pub fn swap(&mut self, one: &str, other: &str) {
        let columns = (self.column(one), self.column(other));
        self.rows.iter_mut().for_each(|row| row.swap(columns.0, columns.1));
    }

    pub fn push(&mut self, name: &str, value: &str) {
        self.names.push(name.to_owned());
        self.rows.iter_mut().for_each(|row| row.push(value.to_owned()));
    }

    /// Removes all columns whose name begins so.
    pub fn remove(&mut self, prefix: &str) {
        let keep: Vec<bool> = self.names.iter().map(|name| !name.starts_with(prefix)).collect();
        assert!(keep.contains(&false), "there is no column {prefix}");
        for row in std::iter::once(&mut self.names).chain(&mut self.rows) {
            let mut keep = keep.iter();
            row.retain(|_| *keep.next().expect("a cell a column"));
        }
    }
}

impl fmt::Display for Csv {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        std::iter::once(&self.names).chain(&self.rows).try_for_each(|row| writeln!(f, "{}", row.join(",")))
    }
}

pub fn text(path: &Path) -> &str {
    path.to_str().expect("the repository's path is UTF-8")
}

fn tables() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration-tables")
}

/// The reference arm's description.
pub fn arm() -> &'static str {
    static ARM: OnceLock<PathBuf> = OnceLock::new();
    text(ARM.get_or_init(|| tables().join("arms/planar-6.toml")))
}

/// The text of the same with the paper's anchor.
pub fn anchored() -> String {
    let text = fs::read_to_string(arm()).expect("the reference arm's description");
    text.replacen("[[segment]]", "[drift]\nkind = \"anchor\"\n\n[[segment]]", 1)
}

/// The reference arm's committed table.
pub fn table() -> &'static str {
    static TABLE: OnceLock<PathBuf> = OnceLock::new();
    text(TABLE.get_or_init(|| tables().join("planar-6.toml")))
}

/// The session that `simulate` writes with these arguments.
pub fn simulate(args: &str) -> Csv {
    let folder = Folder::new();
    let mut all = vec!["simulate", "-o", "session.csv"];
    all.extend(args.split(' '));
    folder.done(&all);
    folder.csv("session.csv")
}

/// 15 s of free swings at 10 Hz: the arm rests for 5 s, and the tool has left the rows that it reads ahead behind it.
pub fn session() -> Csv {
    static SESSION: OnceLock<Csv> = OnceLock::new();
    SESSION.get_or_init(|| simulate("--scenario 1 --seconds 15 --seed 51")).clone()
}

/// The same run with quaternions.
pub fn quaternion_session() -> Csv {
    static SESSION: OnceLock<Csv> = OnceLock::new();
    SESSION.get_or_init(|| simulate("--scenario 1 --seconds 15 --seed 51 --imu quaternion")).clone()
}

/// 600 s of calibration sweep at 10 Hz.
pub fn sweep() -> Csv {
    static SWEEP: OnceLock<Csv> = OnceLock::new();
    SWEEP.get_or_init(|| simulate("--scenario sweep --seconds 600 --seed 41")).clone()
}

/// Replays `session.csv` of `folder` with the reference table and gives the estimates.
pub fn estimates(session: impl fmt::Display) -> Csv {
    let folder = Folder::with("session.csv", session.to_string());
    folder.done(&["replay", "session.csv", "--table", table(), "--out", "est.csv"]);
    folder.csv("est.csv")
}

/// Report of `replay --json` for one session.
pub fn report(session: impl fmt::Display) -> Value {
    let folder = Folder::with("session.csv", session.to_string());
    json(&folder.done(&["replay", "session.csv", "--table", table(), "--json"]))
}

pub fn json(run: &Run) -> Value {
    serde_json::from_str(&run.stdout).unwrap_or_else(|error| panic!("stdout is no JSON: {error}: {}", run.stdout))
}

/// One figure of one method over all sessions.
pub fn figure(report: &Value, method: &str, name: &str) -> f64 {
    let value = &report["all"]["methods"][method][name];
    value.as_f64().unwrap_or_else(|| panic!("{method} {name} is {value}"))
}

/// A calibration of the sweep after `edit`.
pub struct Calibration {
    pub folder: Folder,
    pub run: Run,
}

impl Calibration {
    pub fn of(session: &Csv) -> Self {
        let folder = Folder::with("sweep.csv", session.to_string());
        let run = folder.done(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "table.toml"]);
        Self { folder, run }
    }

    pub fn table(&self) -> calibration_tables::ArmFile {
        calibration_tables::ArmFile::load(&self.folder.path("table.toml")).expect("a calibration makes a valid table")
    }
}
