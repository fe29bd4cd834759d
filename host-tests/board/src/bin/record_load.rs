//! Processor load of `proprio record` while the virtual Due sends all that it can, over a pseudo-terminal and in a process of its
//! own. There is no limit: the figure depends on the machine as much as on the recorder.

#[cfg(target_os = "linux")]
mod figure {
    use std::path::Path;
    use std::process::{Command, Stdio};
    use std::thread::sleep;
    use std::time::{Duration, Instant};
    use std::{env, fs};

    use board_tests::due::{DueProcess, tool};

    /// Time before the measurement, s: start and tare.
    const BEFORE_S: u64 = 5;
    const MEASURED_S: u64 = 60;
    /// The system counts a process's time in hundredths of a second.
    const TICKS_A_SECOND: f64 = 100.0;

    pub fn print() {
        let folder = tempfile::tempdir().expect("there is room for a temporary folder");
        let due = DueProcess::start(folder.path());
        let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration-tables/planar-6.toml");
        let mut command = Command::new(tool("proprio"));
        command.current_dir(folder.path()).args(["record", "--port", &due.port, "-o", "session.mcap", "--table"]);
        let mut recorder = command.arg(table).stderr(Stdio::null()).spawn().expect("the tool starts");
        sleep(Duration::from_secs(BEFORE_S));
        let (began, then, bytes_then) = (Instant::now(), cpu_s(recorder.id()), size(folder.path()));
        sleep(Duration::from_secs(MEASURED_S));
        let seconds = began.elapsed().as_secs_f64();
        let share = (cpu_s(recorder.id()) - then) / seconds;
        let rate = (size(folder.path()) - bytes_then) as f64 / seconds;
        println!(
            "proprio record: {:.2} % of a core, user and system, over {MEASURED_S} s; {:.0} kB/s written",
            share * 100.0,
            rate / 1e3
        );
        recorder.kill().expect("it runs");
        recorder.wait().expect("it ends");
    }

    /// Processor time of all threads of a process, s.
    fn cpu_s(process: u32) -> f64 {
        let stat = fs::read_to_string(format!("/proc/{process}/stat")).expect("it runs");
        // Behind the name, which may have spaces: the 14th and 15th field of all.
        let (_, fields) = stat.rsplit_once(')').expect("a name");
        let ticks = fields.split_whitespace().skip(11).take(2).map(|ticks| ticks.parse::<f64>().expect("a number"));
        ticks.sum::<f64>() / TICKS_A_SECOND
    }

    fn size(folder: &Path) -> u64 {
        fs::metadata(folder.join("session.mcap")).expect("it records").len()
    }
}

fn main() {
    #[cfg(target_os = "linux")]
    figure::print();
}
