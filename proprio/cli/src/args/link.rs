//! Arguments for a board and its line.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use proprio_link::Baud;
use telemetry::MAX_REGULATORS;

use super::force::ForceArgs;

/// Selection of a board.
#[derive(Debug, Args)]
pub struct LinkArgs {
    /// Serial port [default: that of the one Due that is plugged in]
    #[arg(long, value_name = "PORT", conflicts_with = "emulated")]
    pub port: Option<String>,
    /// Speed of the line
    #[arg(long, value_name = "BD", default_value_t, conflicts_with = "emulated")]
    pub baud: Baud,
    /// An emulated Due with a simulated arm instead of a real one
    #[arg(long = "virtual")]
    pub emulated: bool,
    /// Firmware of the emulated Due [default: firmware.elf in the program's folder, or where cargo leaves it]
    #[arg(long, value_name = "ELF", requires = "emulated")]
    pub firmware: Option<PathBuf>,
    /// File of the emulated Due's flash, kept between runs [default: one with --table, or with the reference arm's table]
    #[arg(long, value_name = "FILE", requires = "emulated")]
    pub flash: Option<PathBuf>,
    /// Scenario of the simulated arm: 1 free swings, 2 pushes, 3 an obstacle
    #[arg(long, value_name = "1|2|3", requires = "emulated", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=3))]
    pub scenario: u8,
    /// Seed of the simulated arm's motion and noise
    #[arg(long, value_name = "K", requires = "emulated", default_value_t = 1)]
    pub seed: u64,
    /// Arm description or table of the simulated arm [default: that of --table, or the reference arm]
    #[arg(long, value_name = "ARM.toml", requires = "emulated")]
    pub arm: Option<PathBuf>,
    /// Table that the board should have
    #[arg(long, value_name = "TABLE.toml")]
    pub table: Option<PathBuf>,
}

/// Access to the table on a board.
#[derive(Debug, Args)]
pub struct TableArgs {
    #[command(subcommand)]
    pub command: TableCommand,
}

#[derive(Debug, Subcommand)]
pub enum TableCommand {
    /// Store a table on the board, which restarts and uses it
    Push {
        /// Table to store; or an arm description, by whose wiring the board sends the samples of a calibration
        #[arg(value_name = "TABLE.toml")]
        file: PathBuf,
        #[command(flatten)]
        link: LinkArgs,
    },
    /// Read the board's table into a file, as it was written
    Pull {
        /// File to write; -: standard output
        #[arg(short, long, value_name = "TABLE.toml")]
        output: PathBuf,
        #[command(flatten)]
        force: ForceArgs,
        #[command(flatten)]
        link: LinkArgs,
    },
    /// Show the board's table: arm, checksum, number, size
    Show {
        #[command(flatten)]
        link: LinkArgs,
    },
    /// Erase the board's table; the board restarts and sends samples alone
    Erase {
        #[command(flatten)]
        link: LinkArgs,
    },
}

#[derive(Debug, Args)]
pub struct FlashArgs {
    /// Table of the arm, or its description before the calibration
    #[arg(long, value_name = "TABLE.toml")]
    pub table: PathBuf,
    /// The board's programming port [default: that of the one Due that is plugged in]
    #[arg(long, value_name = "PORT")]
    pub port: Option<String>,
    /// Firmware: ELF file or plain image [default: firmware.elf in the program's folder, or where cargo leaves it]
    #[arg(long, value_name = "FILE")]
    pub firmware: Option<PathBuf>,
    /// Build the firmware first, from the source of proprio in this folder
    #[arg(long, alias = "source", value_name = "FOLDER", conflicts_with = "firmware")]
    pub from_source: Option<PathBuf>,
    /// Print the commands without running them; needs no board
    #[arg(long)]
    pub dry_run: bool,
}

#[derive(Debug, Args)]
pub struct PortsArgs {
    /// Print the list as JSON
    #[arg(long)]
    pub json: bool,
    /// Print a udev rule file for the Due on Linux instead
    #[arg(long, conflicts_with = "json")]
    pub udev: bool,
}

#[derive(Debug, Args)]
pub struct StatusArgs {
    #[command(flatten)]
    pub link: LinkArgs,
    /// Print it as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct TareArgs {
    /// Tare an arm that moves, too
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    pub link: LinkArgs,
}

/// A live stream for other viewers.
#[derive(Debug, Args)]
pub struct FoxgloveArgs {
    /// Stream to Foxglove, Lichtblick and PlotJuggler on 127.0.0.1, port 8765 or this one; 0: any free one
    #[arg(long, value_name = "PORT", num_args = 0..=1, require_equals = true, default_missing_value = "8765")]
    pub foxglove: Option<u16>,
}

#[derive(Debug, Args)]
pub struct RecordArgs {
    #[command(flatten)]
    pub link: LinkArgs,
    #[command(flatten)]
    pub foxglove: FoxgloveArgs,
    /// Recording to write
    #[arg(short, long, value_name = "FILE.mcap")]
    pub output: PathBuf,
    /// Duration, s [default: until Ctrl-C]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub seconds: Option<f64>,
}

#[derive(Debug, Args)]
pub struct DriveArgs {
    /// Profile: pressures over time, columns time_s and pressure1_kpa, pressure2_kpa, … for all regulators of the board
    #[arg(value_name = "PROFILE.csv", required_unless_present = "kpa", conflicts_with = "kpa")]
    pub profile: Option<PathBuf>,
    /// Pressures to hold instead, one for each regulator of the board: module 1 right, left, module 2 right, left, …
    #[arg(long, value_name = "KPA,KPA,…", value_parser = pressures_kpa, allow_negative_numbers = true)]
    pub kpa: Option<Pressures>,
    /// Time to hold them, s [default: until Ctrl-C]
    #[arg(long, value_name = "S", requires = "kpa", allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Largest rate of change of a pressure, kPa/s
    #[arg(long, value_name = "KPA/S", default_value_t = 100.0, allow_negative_numbers = true)]
    pub ramp: f64,
    /// Recording to write meanwhile
    #[arg(short, long, value_name = "FILE.mcap")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub link: LinkArgs,
}

/// Pressures of all regulators, kPa. A type of its own: of a `Vec`, clap would take the option several times.
#[derive(Debug, Clone)]
pub struct Pressures(pub Vec<f64>);

fn pressures_kpa(text: &str) -> Result<Pressures, String> {
    let pressures = text.split(',').map(|part| part.trim().parse().map_err(|_| format!("\"{part}\" is not a number")));
    let pressures = pressures.collect::<Result<Vec<f64>, _>>()?;
    if pressures.len() > MAX_REGULATORS {
        return Err(format!("{} pressures, a board has {MAX_REGULATORS} regulators at most", pressures.len()));
    }
    Ok(Pressures(pressures))
}

#[derive(Debug, Args)]
pub struct MonitorArgs {
    /// Session to show instead of a board; a recording has its table, any other needs one
    #[arg(conflicts_with_all = ["port", "emulated", "allow_control", "plain", "foxglove"])]
    pub session: Option<PathBuf>,
    #[command(flatten)]
    pub link: LinkArgs,
    /// Port of the page on 127.0.0.1; 0: any free one
    #[arg(long, value_name = "PORT", default_value_t = 8642)]
    pub listen: u16,
    #[command(flatten)]
    pub foxglove: FoxgloveArgs,
    /// Folder of recordings and sessions
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub folder: PathBuf,
    /// Allow control from the page (prints an access token); without it, an emulated Due's arm moves by its scenario
    #[arg(long)]
    pub allow_control: bool,
    /// Print one line per second instead
    #[arg(long, conflicts_with_all = ["listen", "folder", "allow_control"])]
    pub plain: bool,
}

#[derive(Debug, Args)]
pub struct DemoArgs {
    /// Port of the page on 127.0.0.1; 0: any free one
    #[arg(long, value_name = "PORT", default_value_t = 8642)]
    pub listen: u16,
}

#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// Session: CSV, recording or raw bytes (.bin)
    pub input: PathBuf,
    /// File to write: .csv, .mcap or .bin; - writes CSV to standard output
    pub output: PathBuf,
    /// Table of the arm: adds the estimates of a replay to the recording (.mcap) that is made of a CSV
    #[arg(long, value_name = "TABLE.toml")]
    pub table: Option<PathBuf>,
    #[command(flatten)]
    pub force: ForceArgs,
}

#[derive(Debug, Args)]
pub struct RecoverArgs {
    /// Recording that is damaged or was cut
    pub input: PathBuf,
    /// Recording to write
    #[arg(short, long, value_name = "WHOLE.mcap")]
    pub output: PathBuf,
    #[command(flatten)]
    pub force: ForceArgs,
}
