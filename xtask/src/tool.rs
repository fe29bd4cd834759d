//! Runs the `proprio` that was built from this workspace.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The tool, and the folder that it works in.
pub struct Tool {
    /// The folder of the built programs.
    programs: PathBuf,
    folder: PathBuf,
}

/// The workspace's folder.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_owned).unwrap_or_default()
}

/// The folder that cargo builds in.
pub fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |path| root().join(path))
}

impl Tool {
    /// Builds the tool, and makes its folder `name` below `target`.
    pub fn build(name: &str) -> Result<Self, String> {
        cargo(&["build", "--package", "proprio"], &[])?;
        Self::built(name)
    }

    /// The tool as it was built, with its folder `name` below `target`.
    pub fn built(name: &str) -> Result<Self, String> {
        let target = target();
        let tool = Self { programs: target.join("debug"), folder: target.join(name) };
        fs::create_dir_all(&tool.folder).map_err(|error| format!("{}: {error}", tool.folder.display()))?;
        Ok(tool)
    }

    /// Runs the tool with arguments as they are typed, and shows them.
    pub fn run(&self, arguments: &str) -> Result<(), String> {
        println!("\n$ proprio {arguments}");
        let arguments: Vec<&str> = arguments.split_whitespace().collect();
        self.run_other("proprio", &arguments)
    }

    /// Runs another program of this workspace in the folder.
    pub fn run_other(&self, program: &str, arguments: &[&str]) -> Result<(), String> {
        let program = self.programs.join(format!("{program}{}", env::consts::EXE_SUFFIX));
        check(Command::new(program).current_dir(&self.folder).args(arguments))
    }

    /// A file of the folder.
    pub fn path(&self, name: &str) -> String {
        self.folder.join(name).display().to_string()
    }

    /// Copies a file of the workspace into the folder.
    pub fn take(&self, from: &str, to: &str) -> Result<(), String> {
        copy(&root().join(from), &self.folder.join(to))
    }

    /// Copies a file of the folder into the workspace.
    pub fn give(&self, from: &str, to: &str) -> Result<(), String> {
        copy(&self.folder.join(from), &root().join(to))
    }
}

/// Runs cargo in the workspace, with additional variables.
pub fn cargo(arguments: &[&str], variables: &[(&str, &str)]) -> Result<(), String> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    check(Command::new(cargo).current_dir(root()).args(arguments).envs(variables.iter().copied()))
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    let done = to.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::copy(from, to));
    done.map(|_| ()).map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))
}

/// Runs a command that must succeed, and returns what it prints.
pub fn output(command: &mut Command) -> Result<Vec<u8>, String> {
    match command.stderr(Stdio::inherit()).output() {
        Ok(output) if output.status.success() => Ok(output.stdout),
        Ok(output) => Err(format!("{}: {}", command.get_program().display(), output.status)),
        Err(error) => Err(format!("{}: {error}", command.get_program().display())),
    }
}

/// Runs a command that must succeed.
pub fn check(command: &mut Command) -> Result<(), String> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{}: {status}", command.get_program().display())),
        Err(error) => Err(format!("{}: {error}", command.get_program().display())),
    }
}
