//! `proprio drive`.

use std::path::Path;
use std::time::{Duration, Instant};

use board_table::MAX_FULL_SCALE_PA;
use proprio_link::drive::{DriveError, Driver, PERIOD, Profile, Ramp};
use proprio_link::{EventKind, FileRecorder, Subscription};
use proprio_session::check_seconds;
use telemetry::Message;

use super::link;
use crate::args::DriveArgs;
use crate::error::Error;
use crate::interrupt::ShutdownGuard;
use crate::status_line::{StatusLine, time};
use crate::terminal;

/// Longest step of the ramp: after a pause of this program the pressures do not jump.
const LONGEST_STEP: Duration = PERIOD.saturating_mul(2);

pub fn run(args: &DriveArgs) -> Result<(), Error> {
    // Check all arguments before the board is driven.
    let profile = profile(args)?;
    if args.ramp.is_nan() || args.ramp <= 0.0 {
        return Err(Error::Ramp(args.ramp));
    }
    args.output.as_deref().map_or(Ok(()), check_new)?;
    if let (Some(path), Some((pa_per_s, row))) = (&args.profile, profile.steepest())
        && pa_per_s > args.ramp * 1e3
    {
        warn_of_slope(path, pa_per_s / 1e3, row, args.ramp);
    }
    let board = link::open_shared(&args.link, args.output.is_some())?;
    let shutdown = ShutdownGuard::new();
    let status = link::status(&board.link, &board.link.subscribe(), board.table.is_some())?;
    // The recording begins only with an armed board, which stays vented until the first set-points.
    let mut driver = Driver::arm(&board.link, &status, profile.regulators())?;
    let recorder = args.output.as_deref().map(|path| link::recorder(path, &board)).transpose()?;
    let mut drive = Session { recorder, events: &board.events, screen: StatusLine::new(), board_kpa: None };
    drive.catch_up()?;
    let driven = drive.follow(&mut driver, &profile, Ramp::new(profile.regulators(), args.ramp * 1e3), &shutdown);
    // Vent first, also after an error.
    let vented = driver.vent();
    drop(board.link);
    let driven = drive.finish(driven)?;
    vented.map_err(DriveError::from)?;
    let early = if driven.is_whole { "" } else { ", interrupted before the end" };
    terminal::eprint_line(&format_args!("driven for {}, vented{early}", time(driven.passed)));
    Ok(())
}

fn profile(args: &DriveArgs) -> Result<Profile, Error> {
    args.seconds.map_or(Ok(()), check_seconds)?;
    match (&args.profile, &args.kpa) {
        (Some(path), _) => Ok(Profile::read(path)?),
        (None, kpa) => {
            let pressures_pa: Vec<f64> = kpa.iter().flat_map(|kpa| &kpa.0).map(|kpa| kpa * 1e3).collect();
            match pressures_pa.iter().find(|pa| !(0.0..=f64::from(MAX_FULL_SCALE_PA)).contains(*pa)) {
                Some(pa) => Err(Error::Pressure(pa / 1e3)),
                None => Ok(Profile::constant(pressures_pa, args.seconds.unwrap_or(f64::INFINITY))),
            }
        }
    }
}

fn warn_of_slope(path: &Path, steepest: f64, row: usize, ramp: f64) {
    let steepest = if steepest.is_finite() { format!("by {steepest:.0} kPa/s") } else { "in a step".to_owned() };
    terminal::warn(&format_args!(
        "{}: the pressures change {steepest} before row {row}; they follow by {ramp} kPa/s, which --ramp allows",
        path.display()
    ));
}

/// Refuses the name of a file that exists, before the board is touched.
fn check_new(path: &Path) -> Result<(), Error> {
    if path.is_file() { Err(proprio_session::Error::RecordingExists(path.to_owned()).into()) } else { Ok(()) }
}

/// A running drive.
struct Session<'b> {
    recorder: Option<FileRecorder>,
    events: &'b Subscription,
    screen: StatusLine,
    /// The board's last reported set-points.
    board_kpa: Option<String>,
}

/// Result of a drive.
struct Driven {
    passed: Duration,
    is_whole: bool,
}

impl Session<'_> {
    /// Takes the events until the board's status was known: they are recorded, and were checked already.
    fn catch_up(&mut self) -> Result<(), Error> {
        if let Some(recorder) = &mut self.recorder {
            return Ok(recorder.remaining_events(self.events)?);
        }
        while self.events.next(Duration::ZERO).is_some() {}
        Ok(())
    }

    /// Follows the profile, and ramps down to 0 at its end.
    fn follow(
        &mut self,
        driver: &mut Driver,
        profile: &Profile,
        mut ramp: Ramp,
        shutdown: &ShutdownGuard,
    ) -> Result<Driven, Error> {
        let (start, mut last) = (Instant::now(), Instant::now());
        loop {
            let passed = start.elapsed();
            let is_whole = passed.as_secs_f64() >= profile.end_s() && ramp.is_vented();
            if is_whole || shutdown.is_requested() {
                return Ok(Driven { passed, is_whole: is_whole || profile.end_s().is_infinite() });
            }
            let now = Instant::now();
            let step = (now - last).min(LONGEST_STEP);
            last = now;
            let pressures_pa = ramp.step(&profile.at(passed.as_secs_f64()), step.as_secs_f64());
            let requested = driver.set(pressures_pa)?;
            self.show(passed, profile.end_s(), &requested.pressures_pa);
            self.receive(driver, now + PERIOD)?;
        }
    }

    /// Handles the board's messages until the next set-points are due.
    fn receive(&mut self, driver: &Driver, until: Instant) -> Result<(), Error> {
        loop {
            let Some(event) = self.events.next(until.saturating_duration_since(Instant::now())) else { return Ok(()) };
            if let Some(recorder) = &mut self.recorder {
                recorder.event(&event)?;
            }
            match event.kind {
                EventKind::Message(Message::Health(health)) => {
                    self.board_kpa = Some(kpa(&health.pressures_pa));
                    driver.check(&health)?;
                }
                EventKind::Lost(reason) | EventKind::Ended(reason) => return Err(DriveError::Lost(reason).into()),
                EventKind::Restarted => return Err(DriveError::Restarted.into()),
                kind => self.screen.warn_of(&kind),
            }
        }
    }

    fn show(&self, passed: Duration, end_s: f64, requested_pa: &[u32]) {
        let end =
            if end_s.is_finite() { format!(" of {}", time(Duration::from_secs_f64(end_s))) } else { String::new() };
        let board = self.board_kpa.as_deref().unwrap_or("–");
        self.screen.show(format!("{}{end}  requested {}  board {board} kPa", time(passed), kpa(requested_pa)));
    }

    /// Clears the status line and completes the recording, also of a drive that failed.
    fn finish(self, driven: Result<Driven, Error>) -> Result<Driven, Error> {
        drop(self.screen);
        if let Some(mut recorder) = self.recorder {
            let path = recorder.path().to_owned();
            let written = recorder.remaining_events(self.events).and_then(|()| {
                let samples = recorder.samples();
                recorder.finish().map(|()| samples)
            });
            match (written, &driven) {
                (Ok(samples), _) => terminal::eprint_line(&format_args!("{}: {samples} samples", path.display())),
                (Err(error), Ok(_)) => return Err(error.into()),
                // The first error is the one to report.
                (Err(_), Err(_)) => {}
            }
        }
        driven
    }
}

fn kpa(pressures_pa: &[u32]) -> String {
    pressures_pa.iter().map(|pa| format!("{:.1}", f64::from(*pa) / 1e3)).collect::<Vec<_>>().join(" ")
}
