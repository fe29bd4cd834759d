//! Arguments of the program.

mod arm;
mod force;
mod link;

use std::path::PathBuf;

use clap::builder::Styles;
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use proprio_session::Axis;
use rig_twin::TimedFault;

pub use arm::NewArmArgs;
pub use force::ForceArgs;
pub use link::{
    ConvertArgs, DemoArgs, DriveArgs, FlashArgs, FoxgloveArgs, LinkArgs, MonitorArgs, PortsArgs, RecordArgs,
    RecoverArgs, StatusArgs, TableArgs, TableCommand, TareArgs,
};

/// Colours of help and errors; off where stderr is not a terminal or NO_COLOR is set.
pub const STYLES: Styles = Styles::styled();

/// The shape of a soft robot arm from its bend sensors and IMUs.
#[derive(Debug, Parser)]
#[command(version, styles = STYLES, max_term_width = 100)]
#[command(
    after_help = "Exit status: 0 done, 2 the input or the command cannot be used, 130 interrupted, 1 a finding of `check`, a loss in `recover`, or a fault of proprio itself."
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Show the firmware on an emulated Due with a simulated arm, on a page in the browser
    Demo(DemoArgs),
    /// Make the description of an arm, with the pins of its sensors and regulators; asks for what is not given
    NewArm(NewArmArgs),
    /// Add the truth of a camera with its own clock to a session
    Align(AlignArgs),
    /// Make a table from sessions with camera truth
    Calibrate(CalibrateArgs),
    /// Tune a table's bias filter, or its Kalman filters, on sessions with truth; Ctrl-C keeps the best so far
    Tune(TuneArgs),
    /// Check the sensors and the times of sessions, exit status 1 where something is found; or the wiring of arms
    Check(CheckArgs),
    /// Run sessions through the estimator and compare with truth
    Replay(ReplayArgs),
    /// Make a page of figures of sessions, and their numbers
    Report(ReportArgs),
    /// Record a session of the simulated arm
    Simulate(SimulateArgs),
    /// Flash the firmware onto a board, store its table, and verify both
    Flash(FlashArgs),
    /// Store, read or erase the table on a board
    Table(TableArgs),
    /// List the serial ports and the Dues on them
    Ports(PortsArgs),
    /// Show the status of a board: versions, sensors, rates, losses
    Status(StatusArgs),
    /// Tare a board: its arm rests in the reference pose now, which is refused while the arm moves
    Tare(TareArgs),
    /// Record a board's data to an MCAP file; opening the programming port restarts the board, and the recording has its tare
    Record(RecordArgs),
    /// Drive the arm's pressures, and vent them at the end
    Drive(DriveArgs),
    /// Show a live arm, or a session, on a page in the browser
    Monitor(MonitorArgs),
    /// Convert a session to CSV, a recording or raw bytes
    Convert(ConvertArgs),
    /// Recover the whole parts of a recording that is damaged or was cut
    Recover(RecoverArgs),
    /// Print a completion script for a shell
    Completions(CompletionsArgs),
    /// Write a manual page of each command
    Man(ManArgs),
}

#[derive(Debug, Args)]
pub struct AlignArgs {
    /// Session without truth, as it was recorded
    pub session: PathBuf,
    /// Camera's file: poses of the markers, one row per frame; or the export of OptiTrack Motive, Vicon or Qualisys
    #[arg(long, value_name = "CAMERA.csv")]
    pub camera: PathBuf,
    /// Rigid bodies of an export from the base to the tip, the base's own first where there is one; all of the file by default
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub bodies: Vec<String>,
    /// Axis of an export's capture volume that points from the arm's plane to the viewer; the program's vertical one by default
    #[arg(long, value_name = "AXIS", value_enum)]
    pub up: Option<UpArg>,
    /// Arm description, or table
    #[arg(long, value_name = "ARM.toml")]
    pub arm: PathBuf,
    /// Session with truth to write
    #[arg(short, long, value_name = "ALIGNED.csv")]
    pub output: PathBuf,
    #[command(flatten)]
    pub force: ForceArgs,
}

/// An axis of a capture volume.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum UpArg {
    /// The first
    X,
    /// The second: Motive's vertical axis
    Y,
    /// The third: the vertical axis of Vicon's and Qualisys' programs
    Z,
}

impl From<UpArg> for Axis {
    fn from(up: UpArg) -> Self {
        match up {
            UpArg::X => Self::X,
            UpArg::Y => Self::Y,
            UpArg::Z => Self::Z,
        }
    }
}

#[derive(Debug, Args)]
pub struct CalibrateArgs {
    /// Sessions with truth: slow sweeps of every segment through its whole range, of one day or of several
    #[arg(required = true, value_name = "SESSION")]
    pub sessions: Vec<PathBuf>,
    /// Arm description: its geometry
    #[arg(long, value_name = "ARM.toml")]
    pub arm: PathBuf,
    /// Table to write
    #[arg(short, long, value_name = "TABLE.toml")]
    pub output: PathBuf,
    #[command(flatten)]
    pub force: ForceArgs,
    /// V–Orient maps of the bend sensors
    #[arg(long, value_enum, default_value_t = MapName::Auto)]
    pub map: MapName,
    /// Compensation of the bend sensors' hysteresis and creep
    #[arg(long, value_enum, default_value_t = HysteresisName::Auto)]
    pub hysteresis: HysteresisName,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MapName {
    /// For each sensor a curve where that lowers the held-back error
    Auto,
    /// Monotone curves
    Curve,
    /// The paper's quadratics
    Quadratic,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HysteresisName {
    /// For sensors and segments whose held-back error it lowers
    Auto,
    /// For all
    Always,
    /// For none
    Never,
}

#[derive(Debug, Args)]
pub struct TuneArgs {
    /// Training sessions with truth, all of the same arm
    #[arg(required = true, value_name = "SESSION")]
    pub sessions: Vec<PathBuf>,
    /// Table of the arm
    #[arg(long, value_name = "TABLE.toml")]
    pub table: PathBuf,
    /// Table to write
    #[arg(short, long, value_name = "TABLE.toml")]
    pub output: PathBuf,
    #[command(flatten)]
    pub force: ForceArgs,
}

#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Sessions to check; of an arm description or a table (.toml), wiring and load of the serial line are printed
    #[arg(required = true, value_name = "SESSION|ARM.toml")]
    pub inputs: Vec<PathBuf>,
    /// Table of the sessions' arm; by an arm description only what needs no map is checked
    #[arg(long, value_name = "TABLE.toml")]
    pub table: Option<PathBuf>,
    /// Print the findings as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct ReplayArgs {
    /// Sessions to replay, several at a time
    #[arg(required = true, value_name = "SESSION")]
    pub sessions: Vec<PathBuf>,
    /// Table of the arm
    #[arg(long, value_name = "TABLE.toml")]
    pub table: PathBuf,
    /// Write the estimates of the session: bend angles and world points of all methods as .csv; or samples and fusion's
    /// estimates on the channels of a recording as .mcap
    #[arg(long, value_name = "EST.csv|EST.mcap")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: ForceArgs,
    /// Smooth: use the readings after each sample, too; needs a table with the bias filter
    #[arg(long)]
    pub smooth: bool,
    /// Print the figures as JSON
    #[arg(long)]
    pub json: bool,
    /// Run the 64-bit float reference instead of the board's fixed point
    #[arg(long)]
    pub float: bool,
}

#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Sessions to show, with or without truth
    #[arg(required = true, value_name = "SESSION")]
    pub sessions: Vec<PathBuf>,
    /// Table of the arm
    #[arg(long, value_name = "TABLE.toml")]
    pub table: PathBuf,
    /// Another table, which is compared with that of `--table` on the same sessions
    #[arg(long, value_name = "TABLE.toml")]
    pub compare: Option<PathBuf>,
    /// Page to write
    #[arg(short, long, value_name = "REPORT.html")]
    pub output: PathBuf,
    #[command(flatten)]
    pub force: ForceArgs,
    /// Write the numbers of the figures as JSON
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Write the numbers of the figures as CSV, one row per number
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Write each plot as an SVG file for a paper into this folder, which is made
    #[arg(long, value_name = "FOLDER")]
    pub figures: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// Scenario: contacts of the arm, and size of its swings
    #[arg(long, value_enum)]
    pub scenario: ScenarioName,
    /// Motion of the arm
    #[arg(long, value_enum, default_value_t = MotionName::Swings)]
    pub motion: MotionName,
    /// Duration, s
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub seconds: f64,
    /// Seed of the motion, the pushes and all noise of the session
    #[arg(long, value_name = "K")]
    pub seed: u64,
    /// Arm description or table of the arm: its segments, their lengths and their sensors; the reference arm by default
    #[arg(long, value_name = "ARM.toml")]
    pub arm: Option<PathBuf>,
    /// Seed of the arm's tolerances and its sensors' flaws; 0: those of the reference arm
    #[arg(long, value_name = "K", default_value_t = 0)]
    pub arm_seed: u64,
    /// Samples per second, 1 to 1000
    #[arg(long, value_name = "HZ", default_value_t = 10.0, allow_negative_numbers = true)]
    pub rate: f64,
    /// Form of the IMU readings
    #[arg(long, value_enum, default_value_t = ImuName::Deg)]
    pub imu: ImuName,
    /// Write the truth as a camera above the arm sees it, into a file of its own and by its own clock
    #[arg(long, value_name = "CAMERA.csv")]
    pub camera: Option<PathBuf>,
    /// Faults of the sensors: their names, each with its begin in s and, after a plus sign, its duration, such as
    /// imu3:reset@12.5,imu2:jump=30@20+0.05; the reference has all names
    #[arg(long, value_name = "FAULT@S", value_delimiter = ',')]
    pub fault: Vec<TimedFault>,
    /// Session to write
    #[arg(short, long, value_name = "SESSION.csv")]
    pub output: PathBuf,
    #[command(flatten)]
    pub force: ForceArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ImuName {
    /// The heading, imuK_deg
    Deg,
    /// The quaternion as the BNO055 gives it, imuK_qw to imuK_qz
    Quaternion,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ScenarioName {
    /// Free swings
    #[value(name = "1")]
    One,
    /// A stick pushes at random times
    #[value(name = "2")]
    Two,
    /// An obstacle that the arm wraps around
    #[value(name = "3")]
    Three,
    /// A slow sweep of every module, for calibration
    Sweep,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MotionName {
    /// All modules swing without a pause, after 5 s at rest
    Swings,
    /// The same, twelve times as slow
    Slow,
    /// The same, four times as fast
    Fast,
    /// One module swings alone
    OneModule,
    /// Rests of two minutes to two hours between spells of swings
    Rests,
    /// Leans of two to ten minutes between spells of swings
    Lean,
    /// The arm starts bent, with scenario 3 in contact
    BentStart,
    /// The arm starts in motion
    MovingStart,
}

#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell
    pub shell: Shell,
}

#[derive(Debug, Args)]
pub struct ManArgs {
    /// Folder of the pages, which is made
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    #[command(flatten)]
    pub force: ForceArgs,
}
