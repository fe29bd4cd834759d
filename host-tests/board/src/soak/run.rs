//! The run: an episode after the other, each with one or two faults.

use estimator_core::{ArmConfig, Q};
use rig_twin::{Fault, Scenario};
use telemetry::TICK_HZ;
use virtual_due::{CYCLES_PER_SECOND, Cycles, WiredRig};

use super::checks::{Checks, Excuse};
use super::draw::{Draw, Drawn, kind, loses_messages, restarts};
use super::finding::{Finding, Invariant};
use super::host::{Aim, Host};
use super::known::{OFFSET_TARE, known};
use super::report::{Report, Violation};
use super::truth::{STEP, TruthLog};
use super::venting::Venting;
use crate::board::Board;
use crate::fault_rows::ADDED_MM;
use crate::replay::table;

/// Time of a step, ms.
const STEP_MS: u64 = 2;
/// Steps from one message of the host to the next: 50 ms.
const HOST_STEPS: u64 = 25;
/// Power-on, IMUs, and the first tare, ms.
const START_MS: u64 = 2_500;
/// Swing without a fault, which gives the limit of recovery, ms.
const FAULT_FREE_MS: u64 = 15_000;
/// An episode, ms: 20 s.
const EPISODE_MS: u64 = 20_000;
/// Time of an episode's first fault, ms.
const FAULT_MS: u64 = 7_000;
/// Episodes of a session: then another arm with a board whose power comes up.
const SESSION_EPISODES: u64 = 10;
/// Number of the episode that begins with a tare.
const TARE_EPISODE: u64 = 7;
/// Distance of the tip from that of the straight arm in a tare that counts as off, mm: the least stated deviation of the tip.
const TARE_OFFSET_MM: f64 = 3.0;
/// Episodes with such a zero after which the session ends: the tip's error is then mostly that of the zero.
const OFFSET_EPISODES: u64 = 2;
/// Rest before a tare, and time for its reply, ms.
const REST_MS: u64 = 3_000;
const TARE_MS: u64 = 100;
/// Time after a fault in which its effect is still on the line, cycles: 200 ms.
const AFTERWARDS: Cycles = CYCLES_PER_SECOND / 5;
/// Time after which a frozen IMU is noticed, cycles: 0.52 s.
const FROZEN: Cycles = CYCLES_PER_SECOND * 52 / 100;
/// Longest time without a sample, and time from a restart to the first, s.
const SILENCE_S: f64 = 0.1;
const BOOT_S: f64 = 1.0;

/// Runs the soak of a seed for some seconds of board time, in whole episodes; `progress` gets the time of each, s.
///
/// # Panics
/// If the firmware does not build.
pub fn soak(seed: u64, seconds: u64, mut progress: impl FnMut(f64)) -> Report {
    let compiled = table().compile::<Q>(TICK_HZ).expect("the reference table is valid");
    let config = compiled.config();
    let mut draw = Draw::new(seed);
    let mut report = Report::new(seed);
    for session in 0.. {
        let mut run = Run::new(seed.wrapping_mul(1000).wrapping_add(session), &config, report);
        run.start();
        let mut offset_episodes = 0;
        for number in 0..SESSION_EPISODES {
            if offset_episodes == OFFSET_EPISODES {
                break;
            }
            run.episode(number, &draw.episode());
            offset_episodes += u64::from(run.is_tare_off());
            progress(run.seconds());
            if run.seconds() >= seconds as f64 {
                return run.finish();
            }
        }
        report = run.finish();
    }
    report
}

/// A fault of the episode, while it is there and shortly after.
struct Present {
    fault: Fault,
    since: Cycles,
    until: Cycles,
}

struct Run<'t> {
    board: Board,
    host: Host,
    truth: TruthLog,
    checks: Checks<'t>,
    venting: Venting,
    report: Report,
    /// Board time of the sessions before, s.
    sessions_s: f64,
    steps: u64,
    aim: Aim,
    /// The episode's faults that are still to begin, and those that are still to end.
    waiting: Vec<(Cycles, Drawn)>,
    ending: Vec<(Cycles, Fault)>,
    present: Vec<Present>,
    /// Faults of this episode and the one before.
    faults: Vec<Fault>,
    before: Vec<Fault>,
    resets: usize,
    /// A restart has its reason.
    may_restart: bool,
    restarted_s: f64,
    bad_at: Cycles,
    /// Index of the episode's first violation.
    first_violation: usize,
}

impl<'t> Run<'t> {
    fn new(seed: u64, config: &'t ArmConfig<'t, Q>, report: Report) -> Self {
        Self {
            board: Board::new(WiredRig::new(Scenario::FreeSwing, seed)),
            host: Host::new(seed),
            truth: TruthLog::default(),
            checks: Checks::new(config),
            venting: Venting::default(),
            sessions_s: report.seconds,
            report,
            steps: 0,
            aim: Aim::Silence,
            waiting: Vec::new(),
            ending: Vec::new(),
            present: Vec::new(),
            faults: Vec::new(),
            before: Vec::new(),
            resets: 0,
            may_restart: false,
            restarted_s: 0.0,
            bad_at: 0,
            first_violation: 0,
        }
    }

    /// Board time of all sessions, s.
    fn seconds(&self) -> f64 {
        self.sessions_s + self.board.machine.seconds()
    }

    fn finish(mut self) -> Report {
        self.report.seconds = self.seconds();
        self.report.replays += self.checks.replays;
        self.report
    }

    /// Power-on and a swing without a fault.
    fn start(&mut self) {
        self.advance(START_MS);
        // Before the first tare the shape is not known well.
        self.checks.take_tip();
        self.aim = Aim::Swing;
        self.advance(FAULT_FREE_MS);
        self.report.limit_mm = self.checks.take_tip().worst_mm + ADDED_MM;
    }

    fn episode(&mut self, number: u64, faults: &[Drawn]) {
        self.first_violation = self.report.violations.len();
        self.before = std::mem::replace(&mut self.faults, faults.iter().map(|drawn| drawn.fault).collect());
        self.may_restart = false;
        let start = self.board.machine.now();
        let time = |ms: u64| start + ms * CYCLES_PER_SECOND / 1000;
        self.waiting = faults.iter().map(|drawn| (time(FAULT_MS + drawn.begin_ms), *drawn)).collect();
        if number == TARE_EPISODE {
            self.tare();
        }
        self.advance_to(time(FAULT_MS));
        let before = self.checks.take_tip();
        if !self.is_tare_off() {
            self.report.add("(7 s before each fault)".to_owned(), before, Some(0.0));
        }
        self.bad_at = 0;
        self.advance_to(time(EPISODE_MS));

        let ends = faults.iter().map(|drawn| if drawn.fault.is_instant() { drawn.begin_ms } else { drawn.end_ms });
        let ended = time(FAULT_MS + ends.max().unwrap_or(0));
        let end = self.board.machine.now();
        let is_recovered = self.bad_at + STEP * HOST_STEPS < end;
        let recovery_s = self.bad_at.saturating_sub(ended) as f64 / CYCLES_PER_SECOND as f64;
        let name = match faults {
            _ if self.is_tare_off() => format!("any after a {OFFSET_TARE}"),
            [one] => kind(one.fault),
            _ => "two at once".to_owned(),
        };
        self.report.add(name, self.checks.take_tip(), is_recovered.then_some(recovery_s));
    }

    /// Lets the arm rest, and sets its zero.
    fn tare(&mut self) {
        self.aim = Aim::Rest;
        self.venting.vent(self.board.machine.now());
        self.advance(REST_MS);
        self.host.tare(&mut self.board);
        self.advance(TARE_MS);
        self.aim = Aim::Swing;
    }

    fn is_tare_off(&self) -> bool {
        self.checks.tare_offset_mm > TARE_OFFSET_MM
    }

    fn advance(&mut self, ms: u64) {
        self.advance_to(self.board.machine.now() + ms / STEP_MS * STEP);
    }

    fn advance_to(&mut self, end: Cycles) {
        while self.board.machine.now() < end {
            self.begin_and_end();
            if self.steps.is_multiple_of(HOST_STEPS) {
                self.host_turn();
            }
            self.steps += 1;
            // To a multiple of the step, also after a fault that took time.
            self.board.run_until((self.board.machine.now() / STEP + 1) * STEP);
            self.receive();
            let finding = self.venting.check(&self.board);
            self.note(finding.into_iter().collect());
        }
    }

    /// Begins and ends the faults that are due.
    fn begin_and_end(&mut self) {
        let now = self.board.machine.now();
        for (_, drawn) in self.waiting.extract_if(.., |(at, _)| *at <= now) {
            let fault = drawn.fault;
            self.may_restart |= restarts(fault);
            if matches!(fault, Fault::LineCut) {
                self.venting.gone(now);
            }
            self.board.machine.inject(fault).expect("the reference arm can have it");
            let end = now + (drawn.end_ms - drawn.begin_ms) / STEP_MS * STEP;
            let is_flip = matches!(fault, Fault::FlashFlip(_));
            if !fault.is_instant() || is_flip {
                self.ending.push((end, fault));
            }
            self.present.push(Present { fault, since: now, until: end + AFTERWARDS });
        }
        for (_, fault) in self.ending.extract_if(.., |(at, _)| *at <= now) {
            match fault {
                // The same bit again: whole.
                Fault::FlashFlip(_) => self.board.machine.inject(fault).expect("the chip has the place"),
                _ => self.board.machine.clear(fault),
            }
            if matches!(fault, Fault::LineCut) {
                self.venting.back(now);
            }
        }
        self.present.retain(|present| present.until > now);
    }

    fn host_turn(&mut self) {
        let now = self.board.machine.now();
        if self.host.needs_power_cut && self.ending.is_empty() {
            self.host.needs_power_cut = false;
            self.may_restart = true;
            self.board.inject("power:cut");
        }
        let aim = if self.venting.is_silent(now) { Aim::Silence } else { self.aim };
        if self.host.send(&mut self.board, aim) {
            self.venting.armed();
        }
        self.checks.compare_tips();
        if !self.checks.is_recovered(self.report.limit_mm) {
            self.bad_at = now;
        }
        let time_s = self.board.machine.seconds();
        let silence_s = time_s - self.checks.sampled_s;
        let excuse = self.excuse();
        let is_excused = excuse.lost || excuse.held_up;
        if silence_s > SILENCE_S && time_s > self.restarted_s + BOOT_S && !is_excused {
            let figure = format!("no sample for {silence_s:.2} s");
            self.note(vec![Finding { size: silence_s, ..Finding::new(Invariant::EveryTick, time_s, figure) }]);
        }
    }

    fn excuse(&self) -> Excuse {
        let has = |explains: fn(Fault) -> bool| self.present.iter().any(|present| explains(present.fault));
        let unnoticed = self.present.iter().any(|present| {
            matches!(present.fault, Fault::ImuFrozen(_)) && self.board.machine.now() < present.since + FROZEN
        });
        Excuse { lost: has(loses_messages), held_up: has(|fault| matches!(fault, Fault::IrqMasked(_))), unnoticed }
    }

    /// Takes what the board has sent in a step, and its restarts.
    fn receive(&mut self) {
        let (messages, truths) = self.board.take();
        self.truth.add(&mut self.board, !truths.is_empty());
        let excuse = self.excuse();
        for received in messages {
            self.restarts(received.at);
            self.host.message(&received.message);
            let time_s = received.at as f64 / CYCLES_PER_SECOND as f64;
            self.checks.message(&received.message, time_s, &self.truth, excuse);
        }
        self.restarts(self.board.machine.now());
        let findings = self.checks.take_findings();
        self.note(findings);
    }

    /// Takes the restarts up to a time.
    fn restarts(&mut self, until: Cycles) {
        while let Some(reset) = self.board.machine.resets().get(self.resets).filter(|reset| reset.at <= until) {
            let (at, cause) = (reset.at, format!("{:?}", reset.cause));
            self.resets += 1;
            self.report.restarts += 1;
            self.restarted_s = at as f64 / CYCLES_PER_SECOND as f64;
            self.checks.restart();
            self.host.restart();
            self.venting.restarted(at);
            if !self.may_restart {
                self.note(vec![Finding::new(Invariant::Restart, self.restarted_s, format!("a reset by {cause}"))]);
            }
        }
    }

    /// Notes findings: one violation of each invariant in an episode.
    fn note(&mut self, findings: Vec<Finding>) {
        for mut finding in findings {
            finding.time_s += self.sessions_s;
            let same = self.report.violations[self.first_violation..]
                .iter_mut()
                .find(|violation| violation.finding.invariant == finding.invariant);
            if let Some(same) = same {
                same.count += 1;
                if finding.size > same.finding.size {
                    (same.finding.size, same.finding.figure) = (finding.size, finding.figure);
                }
                continue;
            }
            let off = self.is_tare_off().then(|| OFFSET_TARE.to_owned());
            let kinds: Vec<String> =
                self.faults.iter().chain(&self.before).map(|fault| kind(*fault)).chain(off).collect();
            let known = known(kinds.iter().map(String::as_str), finding.invariant);
            let names = |faults: &[Fault]| faults.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
            let faults = format!("faults {}; before {}", names(&self.faults), names(&self.before));
            self.report.violations.push(Violation { finding, count: 1, faults, known });
        }
    }
}
