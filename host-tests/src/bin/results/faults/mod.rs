//! Faults of sensors, recordings and motion, put into sessions of test arms.

mod catalogue;
mod page;
mod trace;

use std::ops::Range;

use catalogue::{Course, FAST_HZ, FAULTS, Fault, REST_S, SLOW_HZ};
use host_tests::faults::Spoiler;
use host_tests::parallel::in_parallel;
use host_tests::twin::TwinSession;
use proprio_simulation::Simulation;
use rig_twin::{Motion, Scenario, Setup};
use trace::Trace;

use crate::arm::{Problem, SESSION_S, Tables, setup};
use crate::family::{Family, SCENARIOS};

/// Some of the test arms.
const ARMS: [u64; 3] = [105, 106, 107];
/// Length of the sessions at 100 Hz.
const FAST_SESSION_S: f64 = 300.0;
/// The estimate has this time to recover.
const RECOVERY_S: f64 = 60.0;
/// The first part of it, which is reported.
const FIRST_S: f64 = 10.0;
/// A flag counts as immediate within this time.
const AT_ONCE_S: f64 = 1.0;
/// A contact bends a segment by more than this.
const CONTACT_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// An estimate has recovered within this multiple of the error without the fault.
const RECOVERED: f64 = 1.5;
/// Share inside the ellipse from which an estimate counts as inside.
const INSIDE_PERCENT: f64 = 88.0;

/// Errors of one session with one fault.
pub struct FaultFigures {
    name: &'static str,
    scenario: &'static str,
    arm: u64,
    /// RMSE before the fault, mm.
    before_mm: Option<f64>,
    /// RMSE of the session without the fault, in the time in which that with it is evaluated.
    clean_mm: f64,
    first_mm: f64,
    after_mm: f64,
    /// Share inside the ellipse in the same time.
    inside_percent: f64,
    /// Time to the first condition that is reported.
    flagged_s: Option<f64>,
}

/// State of an estimate one minute after a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Recovered,
    FlaggedAndInside,
    InsideAlone,
    FlaggedAlone,
    Broken,
}

/// All sessions with faults.
pub struct Faults {
    sessions: Vec<FaultFigures>,
    /// Share of time with a condition in the sessions without a fault.
    clean: Vec<(&'static str, u64, f64)>,
}

/// A session without a fault.
struct Clean {
    session: TwinSession,
    trace: Trace,
}

impl Faults {
    /// Replays all of them.
    pub fn measure(family: &Family) -> Result<Self, Problem> {
        let jobs: Vec<(usize, u64)> = [0, 1].into_iter().flat_map(|k| ARMS.map(|seed| (k, seed))).collect();
        let done = in_parallel(&jobs, |(k, seed)| {
            let (name, scenario) = SCENARIOS[*k];
            eprintln!("arm {seed}, faults in scenario {name}");
            measure_arm(family.tables(*seed)?, *seed, (name, scenario))
        });
        let mut all = Self { sessions: Vec::new(), clean: Vec::new() };
        for job in done {
            let (sessions, clean) = job?;
            all.sessions.extend(sessions);
            all.clean.push(clean);
        }
        Ok(all)
    }
}

type ArmFaults = (Vec<FaultFigures>, (&'static str, u64, f64));

fn measure_arm(tables: &Tables, seed: u64, (name, scenario): (&'static str, Scenario)) -> Result<ArmFaults, Problem> {
    let slow = Clean::new(tables, &setup(seed, scenario, Motion::Swings), SESSION_S, SLOW_HZ)?;
    let fast = Clean::new(tables, &setup(seed, scenario, Motion::Swings), FAST_SESSION_S, FAST_HZ)?;
    let mut sessions = Vec::new();
    for fault in FAULTS.iter().filter(|fault| fault.course.is_in(scenario)) {
        let clean = if fault.rate_hz > SLOW_HZ { &fast } else { &slow };
        let Some(spoiled) = Spoiled::new(fault, clean, &setup(seed, scenario, Motion::Swings))? else { continue };
        let trace = Trace::of(&spoiled.session, &tables.own)?;
        sessions.push(spoiled.figures(&trace, clean, (fault.name, name, seed)));
    }
    Ok((sessions, (name, seed, slow.trace.flagged_percent())))
}

impl Clean {
    fn new(tables: &Tables, setup: &Setup, seconds: f64, rate_hz: f64) -> Result<Self, Problem> {
        let session = TwinSession::new(setup, seconds, rate_hz)?;
        let trace = Trace::of(&session, &tables.own)?;
        Ok(Self { session, trace })
    }

    /// Index of the first sample after `time_s` in which contact has just bent a segment by over 10°.
    fn contact_after(&self, time_s: f64) -> Option<usize> {
        let is_strong = |bends: &[f64]| bends.iter().any(|bend| bend.abs() > CONTACT_RAD);
        let bends = &self.session.contact_bends_rad;
        (self.session.index(time_s).max(1)..bends.len()).find(|k| is_strong(&bends[*k]) && !is_strong(&bends[k - 1]))
    }
}

/// A session with a fault.
struct Spoiled {
    session: TwinSession,
    /// Time in which it is evaluated.
    judged_s: Range<f64>,
    /// The same moment of the session without the fault.
    clean_s: f64,
}

impl Spoiled {
    /// The session with the fault; `None` where the session has no moment for it.
    fn new(fault: &Fault, clean: &Clean, setup: &Setup) -> Result<Option<Self>, Problem> {
        let Fault { at_s, rate_hz, course, .. } = *fault;
        let simulated = |setup: &Setup| Simulation::of(setup, SESSION_S, rate_hz);
        let from =
            |session: TwinSession, at_s: f64| Some(Self { session, judged_s: at_s..f64::INFINITY, clean_s: at_s });
        Ok(match course {
            Course::Spoiled(spoil) => from(clean.spoiled(clean.session.index(at_s), spoil), at_s),
            Course::SpoiledInContact(spoil) => clean
                .contact_after(at_s)
                .and_then(|k| from(clean.spoiled(k, spoil), clean.session.samples[k].time_us as f64 / 1e6)),
            Course::Moves(motion) => {
                from(TwinSession::of(simulated(&Setup { motion, ..setup.clone() })?, rate_hz), at_s)
            }
            Course::Rest | Course::AfterRest => {
                let simulation = Simulation::of(setup, SESSION_S + REST_S, rate_hz)?.with_rest(at_s, REST_S);
                let session = TwinSession::of(simulation, rate_hz);
                let end_s = at_s + REST_S;
                let judged_s = if matches!(course, Course::Rest) { at_s..end_s } else { end_s..f64::INFINITY };
                Some(Self { session, judged_s, clean_s: at_s })
            }
        })
    }

    fn figures(
        &self,
        trace: &Trace,
        clean: &Clean,
        (name, scenario, arm): (&'static str, &'static str, u64),
    ) -> FaultFigures {
        let Range { start, end } = self.judged_s;
        let after_s = start + RECOVERY_S..end;
        let rmse_mm = |seconds| trace.rmse_mm(seconds).unwrap_or(f64::NAN);
        FaultFigures {
            name,
            scenario,
            arm,
            before_mm: trace.rmse_mm(0.0..start).filter(|_| start > FIRST_S),
            clean_mm: clean.trace.rmse_mm(self.clean_s + RECOVERY_S..f64::INFINITY).unwrap_or(f64::NAN),
            first_mm: rmse_mm(start..start + FIRST_S),
            after_mm: rmse_mm(after_s.clone()),
            inside_percent: trace.inside_percent(after_s),
            flagged_s: trace.flagged_after_s(start..start + RECOVERY_S),
        }
    }
}

impl Clean {
    /// The session with samples spoiled from an index on.
    fn spoiled(&self, from: usize, spoil: fn(&mut Spoiler)) -> TwinSession {
        let mut session = self.session.clone();
        spoil(&mut Spoiler { samples: &mut session.samples, from, rate_hz: session.rate_hz });
        session
    }
}

impl FaultFigures {
    fn verdict(&self) -> Verdict {
        let is_inside = self.inside_percent >= INSIDE_PERCENT;
        match (self.after_mm <= RECOVERED * self.clean_mm, self.flagged_s.is_some(), is_inside) {
            (true, ..) => Verdict::Recovered,
            (_, true, true) => Verdict::FlaggedAndInside,
            (_, false, true) => Verdict::InsideAlone,
            (_, true, false) => Verdict::FlaggedAlone,
            (_, false, false) => Verdict::Broken,
        }
    }
}
