//! The steps that flash a board, as in docs/how-to/flashing.md.

use std::path::{Path, PathBuf};
use std::{env, fmt, fs};

use firmware_image::{FLASH, image, is_elf};
use proprio_link::built_firmware;

use super::tools::is_on_path;
use super::touch::{TOUCH_BD, touch};
use super::{FlashError, Flasher, ToolCommand};

const CHIP: &str = "ATSAM3X8E";

/// The firmware to flash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Firmware {
    /// An ELF file or a plain image.
    File(PathBuf),
    /// The one that is built from this project's source in a folder.
    Source(PathBuf),
}

/// A step of flashing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// Runs another program.
    Run(ToolCommand),
    /// Writes the plain image of a firmware's ELF file.
    WriteImage {
        /// The ELF file.
        elf: PathBuf,
        /// The file to write.
        image: PathBuf,
    },
    /// Resets the board on this port into its boot loader.
    Touch(String),
}

/// The steps that flash `firmware`: through probe-rs if a probe is found, else with bossac over `port`, for which a plain image
/// is written to `image`. A prebuilt firmware is checked.
///
/// # Errors
/// [`FlashError`] if the firmware or a program is missing or cannot be used.
pub fn plan(firmware: &Firmware, port: &str, image: &Path) -> Result<Vec<Step>, FlashError> {
    let (mut steps, path, is_plain) = match firmware {
        Firmware::File(path) => (Vec::new(), path.clone(), is_plain(path)?),
        Firmware::Source(folder) => {
            let (build, elf) = build(folder)?;
            (vec![Step::Run(build)], elf, false)
        }
    };
    let flasher = Flasher::find()?;
    let plain = if is_plain { &path } else { image };
    if !is_plain && flasher != Flasher::Probe {
        steps.push(Step::WriteImage { elf: path.clone(), image: image.to_owned() });
    }
    match flasher {
        Flasher::Probe => steps.extend(by_probe(&path, is_plain).map(Step::Run)),
        Flasher::Bossac => steps.push(Step::Run(by_bossac(port, plain))),
        Flasher::ArduinoBossac(program) => {
            steps.extend([Step::Touch(port.to_owned()), Step::Run(by_arduino_bossac(&program, port, plain))]);
        }
    }
    Ok(steps)
}

/// Checks a prebuilt firmware; true for a plain image.
fn is_plain(path: &Path) -> Result<bool, FlashError> {
    let file = read(path)?;
    image(&file).map_err(|source| FlashError::Image { path: path.to_owned(), source })?;
    Ok(!is_elf(&file))
}

fn read(path: &Path) -> Result<Vec<u8>, FlashError> {
    fs::read(path).map_err(|source| FlashError::Firmware { path: path.to_owned(), source })
}

/// The command that builds the firmware, and the path of its ELF file.
fn build(folder: &Path) -> Result<(ToolCommand, PathBuf), FlashError> {
    if !folder.join("firmware").join("Cargo.toml").is_file() {
        return Err(FlashError::NoSource(folder.to_owned()));
    }
    if !is_on_path("cargo") {
        return Err(FlashError::Missing("cargo".to_owned()));
    }
    let arguments = ["build", "--profile", "firmware", "-p", "firmware", "--target", "thumbv7m-none-eabi"];
    // Cargo takes a relative path from the folder that it runs in.
    let target = env::var("CARGO_TARGET_DIR").unwrap_or_else(|_| "target".to_owned());
    let elf = built_firmware(folder.join(target));
    Ok((ToolCommand::new("cargo", &arguments).in_folder(folder), elf))
}

/// The commands of probe-rs. A plain image has no addresses of its own.
fn by_probe(firmware: &Path, is_plain: bool) -> [ToolCommand; 2] {
    let (file, address) = (firmware.to_string_lossy(), format!("{:#x}", FLASH.start));
    let format = ["--binary-format", "bin", "--base-address", &address];
    let format = if is_plain { &format[..] } else { &[] };
    let download = [&["download", "--chip", CHIP, "--verify"], format, &[&file]].concat();
    [ToolCommand::new("probe-rs", &download), ToolCommand::new("probe-rs", &["reset", "--chip", CHIP])]
}

/// The command of bossac 1.9, which touches the port at 1200 Bd itself (`-a`). Without `-R`: its reset comes before the chip has
/// stored that it boots from flash, which leaves the board in its boot loader (BOSSA, issue 125 and pull request 111). The
/// board is reset when the port is opened after it.
fn by_bossac(port: &str, image: &Path) -> ToolCommand {
    let arguments = ["-a", "-p", port_name(port), "-U0", "-e", "-w", "-v", "-b", &image.to_string_lossy()];
    ToolCommand::new("bossac", &arguments)
}

/// The command of an Arduino IDE's bossac, with the arguments of `tools.bossac.upload.pattern` in `platform.txt` of the SAM core,
/// version 1.6.12, and `upload.native_usb=false` of its `boards.txt`.
fn by_arduino_bossac(program: &Path, port: &str, image: &Path) -> ToolCommand {
    let port = format!("--port={}", port_name(port));
    let arguments = [&port, "-U", "false", "-e", "-w", "-v", "-b", &image.to_string_lossy(), "-R"];
    ToolCommand::new(&program.to_string_lossy(), &arguments)
}

/// The name of a port for bossac, which adds the folder itself.
fn port_name(port: &str) -> &str {
    port.strip_prefix("/dev/").unwrap_or(port)
}

impl Step {
    /// Does the step; the output of other programs goes to standard error.
    ///
    /// # Errors
    /// [`FlashError`].
    pub fn run(&self) -> Result<(), FlashError> {
        match self {
            Self::Run(command) => command.run(),
            Self::WriteImage { elf, image: path } => {
                let image = image(&read(elf)?).map_err(|source| FlashError::Image { path: elf.clone(), source })?;
                fs::write(path, image).map_err(FlashError::Temporary)
            }
            Self::Touch(port) => touch(port),
        }
    }
}

/// In the syntax of a shell; the steps of this program itself are comments.
impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Run(command) => command.fmt(f),
            Self::WriteImage { elf, image } => {
                write!(f, "# proprio writes the plain image of {} to {}", elf.display(), image.display())
            }
            Self::Touch(port) => write!(f, "# proprio opens {port} at {TOUCH_BD} Bd with DTR off, and closes it"),
        }
    }
}
