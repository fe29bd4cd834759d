//! Trials of faults: an arm that swings under the board's own pressures, a fault, and the board's estimates.

use estimator_core::Q;
use rig_twin::{MotionProgram, Scenario};
use telemetry::{Command, Estimate, Event, Message, RequestOutcome};
use virtual_due::{CYCLES_PER_SECOND, Cycles, WiredRig};

use crate::board::Board;

/// Longest time between two set-points, ms.
const SET_POINT_MS: u64 = 50;

/// A board whose arm swings, and the time of its fault.
pub struct Trial {
    /// The board.
    pub board: Board,
    program: MotionProgram,
    /// Speed of the motion over that of the session's swings.
    pace: f64,
    start_s: f64,
    fault_at: Cycles,
}

impl Trial {
    /// A board that has swung its arm for some seconds, in a session of this seed.
    ///
    /// # Panics
    /// If the board does not arm.
    #[must_use]
    pub fn swinging(seed: u64, seconds: u64) -> Self {
        Self::at_pace(seed, seconds, 1.0)
    }

    /// The same with another speed of the motion: 1 is that of the session's swings.
    ///
    /// # Panics
    /// As [`Trial::swinging`].
    #[must_use]
    pub fn at_pace(seed: u64, seconds: u64, pace: f64) -> Self {
        let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, seed));
        board.run_ms(2500);
        assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
        let start_s = board.machine.seconds();
        let program = MotionProgram::new(Scenario::FreeSwing, seed);
        let mut trial = Self { board, program, pace, start_s, fault_at: 0 };
        trial.run_ms(seconds * 1000);
        trial
    }

    /// Lets the arm swing on, with set-points as long as the board takes them.
    pub fn run_ms(&mut self, ms: u64) {
        let mut left_ms = ms;
        while left_ms > 0 {
            let step_ms = left_ms.min(SET_POINT_MS);
            let time_s = self.board.machine.seconds() - self.start_s;
            self.board.set_pressures(&self.program.duties(time_s * self.pace));
            self.board.run_ms(step_ms);
            left_ms -= step_ms;
        }
    }

    /// Begins a fault, by its name, and counts times from now on.
    ///
    /// # Panics
    /// If there is no such fault, or the board cannot have it.
    pub fn inject(&mut self, fault: &str) {
        self.mark();
        self.board.inject(fault);
    }

    /// Time after the fault, ms.
    fn after_ms(&self, at: Cycles) -> f64 {
        (at as f64 - self.fault_at as f64) * 1e3 / CYCLES_PER_SECOND as f64
    }

    /// Time from the fault to the first event of a kind, ms.
    #[must_use]
    pub fn noticed_ms(&self, is_so: impl Fn(Event) -> bool) -> Option<f64> {
        self.timed(0.0, f64::INFINITY).find_map(|(ms, message)| match message {
            Message::Event(event) if is_so(*event) => Some(ms),
            _ => None,
        })
    }

    /// Counts times from now on.
    pub(crate) fn mark(&mut self) {
        self.fault_at = self.board.machine.now();
    }

    /// Messages from one time after the fault to another, each with its time, ms.
    pub(crate) fn timed(&self, from_ms: f64, to_ms: f64) -> impl Iterator<Item = (f64, &Message)> {
        let timed = self.board.received().iter().map(|received| (self.after_ms(received.at), &received.message));
        timed.filter(move |(ms, _)| (from_ms..to_ms).contains(ms))
    }

    /// Messages from one time after the fault to another.
    pub(crate) fn received(&self, from_ms: f64, to_ms: f64) -> impl Iterator<Item = &Message> {
        self.timed(from_ms, to_ms).map(|(_, message)| message)
    }

    /// Estimates from one time after the fault to another.
    fn estimates(&self, from_ms: f64, to_ms: f64) -> impl Iterator<Item = &Estimate> {
        self.received(from_ms, to_ms).filter_map(|message| match message {
            Message::Estimate(estimate) => Some(estimate),
            _ => None,
        })
    }

    /// Distance of the tip from the truth of the same tick, mm; infinite where there is no estimate of the tip.
    fn tip_error_mm(&self, estimate: &Estimate) -> f64 {
        let truth = self.board.truths().get(estimate.tick as usize).and_then(|truth| truth.last());
        let (Some(truth), Some(tip)) = (truth, tip_m(estimate)) else { return f64::INFINITY };
        1e3 * (tip[0] - truth.x_m).hypot(tip[1] - truth.y_m)
    }

    /// Largest distance of the tip from the truth between two times after the fault, mm.
    ///
    /// # Panics
    /// If there is no estimate in this time.
    #[must_use]
    pub fn largest_tip_error_mm(&self, from_ms: f64, to_ms: f64) -> f64 {
        let errors = self.estimates(from_ms, to_ms).map(|estimate| self.tip_error_mm(estimate));
        errors.reduce(f64::max).expect("estimates come")
    }

    /// Largest change of the tip's error from one estimate to the next, mm, between two times after the fault.
    #[must_use]
    pub fn largest_step_mm(&self, from_ms: f64, to_ms: f64) -> f64 {
        let errors: Vec<[f64; 2]> =
            self.estimates(from_ms, to_ms).filter_map(|estimate| self.tip_offset_mm(estimate)).collect();
        let steps = errors.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        steps.fold(0.0, f64::max)
    }

    /// Offset of the tip from the truth of the same tick, mm.
    fn tip_offset_mm(&self, estimate: &Estimate) -> Option<[f64; 2]> {
        let truth = self.board.truths().get(estimate.tick as usize)?.last()?;
        let tip = tip_m(estimate)?;
        Some([1e3 * (tip[0] - truth.x_m), 1e3 * (tip[1] - truth.y_m)])
    }
}

/// The estimated tip, m.
fn tip_m(estimate: &Estimate) -> Option<[f64; 2]> {
    let tip = estimate.segments.last().copied().flatten()?;
    Some(tip.end.map(|bits| Q::from_bits(bits).to_f64()))
}
