//! The six pressures: what may move them, and how they end vented when nobody does.
//!
//! Pressures move only while armed, and only for as long as set-points keep coming. Counted from the set-points that
//! were accepted last, with the deadline of `valid_ms` that they bring along:
//!
//! | time | state | pressures |
//! |---|---|---|
//! | up to `valid_ms` | [`Actuation::Armed`] | the set-points |
//! | then for [`HOLD_MS`] | [`Actuation::Holding`] | the set-points, still |
//! | then up to [`VENTED_MS`] | [`Actuation::Ramping`] | straight down to 0 |
//! | from [`VENTED_MS`] on | [`Actuation::Disarmed`] | 0, until armed again |
//!
//! The arm is vented at the same time whatever the deadline was: a longer one leaves less time for the ramp, which
//! takes 1.1 s at most and 0.1 s at the longest deadline of [`VALID_MS_MAX`]. [`VENTED_MS`] stands 100 ms before the
//! 1.5 s within which the arm is to be vented, for a frame's way to the board, the tick, and the regulator's own lag.
//!
//! Set-points that come while holding or ramping are followed again: only a vented arm waits to be armed. An arm that
//! was armed and got no set-points yet has no deadline; it is vented and stays armed. To arm it again while it is not
//! disarmed changes nothing, so that arming cannot stretch a deadline.

use telemetry::{Actuation, Event, REGULATORS, Refusal, SetPressures};

/// Pressure of a regulator at full duty, Pa: the supply's.
pub const FULL_SCALE_PA: u32 = 280_000;

/// Longest time that set-points may stand, ms.
pub const VALID_MS_MAX: u16 = 1000;

/// How long the pressures are held after the deadline, ms.
pub const HOLD_MS: u16 = 300;

/// Time from the last accepted set-points to zero pressure, ms.
pub const VENTED_MS: u16 = 1400;

/// The longest deadline leaves time for a ramp.
const _: () = assert!(VALID_MS_MAX + HOLD_MS < VENTED_MS);

/// The pressures' set-points and who may change them.
///
/// It keeps no clock: each call brings the time since boot in µs, which never goes back.
///
/// ```
/// use board_core::{Actuator, FULL_SCALE_PA};
/// use telemetry::{Actuation, REGULATORS, SetPressures};
///
/// let mut actuator = Actuator::new([FULL_SCALE_PA; REGULATORS]);
/// actuator.arm();
/// let half = SetPressures { pressures_pa: [FULL_SCALE_PA / 2; REGULATORS], valid_ms: 100 };
/// actuator.set(&half, 0)?;
/// assert_eq!(actuator.duties(4200), [2100; REGULATORS]);
///
/// actuator.advance(250_000);
/// assert_eq!((actuator.state(), actuator.pressures_pa()), (Actuation::Holding, half.pressures_pa));
/// actuator.advance(1_400_000);
/// assert_eq!((actuator.state(), actuator.duties(4200)), (Actuation::Disarmed, [0; REGULATORS]));
/// # Ok::<(), telemetry::Refusal>(())
/// ```
#[derive(Debug)]
pub struct Actuator {
    limits_pa: [u32; REGULATORS],
    state: Actuation,
    /// The state that was reported last.
    reported: Actuation,
    pressures_pa: [u32; REGULATORS],
    /// What the set-points ask for, and when they end.
    course: Option<Course>,
    degraded: bool,
}

/// Set-points on their way from acceptance to the vent.
#[derive(Debug, Clone, Copy)]
struct Course {
    pressures_pa: [u32; REGULATORS],
    accepted_us: u64,
    valid_ms: u16,
}

impl Course {
    /// State and pressures at a time.
    fn at(&self, now_us: u64) -> (Actuation, [u32; REGULATORS]) {
        let age_us = now_us.saturating_sub(self.accepted_us);
        let hold_from_us = us(self.valid_ms);
        let ramp_from_us = hold_from_us + us(HOLD_MS);
        if age_us <= hold_from_us {
            return (Actuation::Armed, self.pressures_pa);
        }
        if age_us <= ramp_from_us {
            return (Actuation::Holding, self.pressures_pa);
        }
        let left_us = us(VENTED_MS).saturating_sub(age_us);
        if left_us == 0 {
            return (Actuation::Disarmed, [0; REGULATORS]);
        }
        let ramp_us = us(VENTED_MS) - ramp_from_us;
        (Actuation::Ramping, self.pressures_pa.map(|pressure| share(pressure, left_us, ramp_us)))
    }
}

impl Actuator {
    /// Vented and disarmed. `limits_pa` are the highest set-points that each regulator accepts; [`FULL_SCALE_PA`] at
    /// most.
    pub fn new(limits_pa: [u32; REGULATORS]) -> Self {
        Self {
            limits_pa: limits_pa.map(|limit| limit.min(FULL_SCALE_PA)),
            state: Actuation::Disarmed,
            reported: Actuation::Disarmed,
            pressures_pa: [0; REGULATORS],
            course: None,
            degraded: false,
        }
    }

    /// Lets set-points move the pressures. Nothing moves yet.
    pub fn arm(&mut self) {
        if self.state == Actuation::Disarmed {
            self.state = Actuation::Armed;
        }
    }

    /// Vents at once, and lets nothing move the pressures until armed again.
    pub fn disarm(&mut self) {
        self.state = Actuation::Disarmed;
        self.pressures_pa = [0; REGULATORS];
        self.course = None;
    }

    /// Says whether the shape is known too poorly to push on: all IMUs, or all bend sensors of a segment, are lost.
    ///
    /// While degraded, set-points cannot raise a pressure above what it is at that moment: what they ask beyond it is
    /// cut off, and they are accepted. So the arm can be lowered and vented under control, but not driven blindly.
    pub fn set_degraded(&mut self, degraded: bool) {
        self.degraded = degraded;
    }

    /// Accepts new set-points, from now on.
    ///
    /// # Errors
    /// [`Refusal::Disarmed`] if it is not armed, [`Refusal::OverRange`] if a pressure is over its regulator's limit,
    /// [`Refusal::Deadline`] if `valid_ms` is not 1 to [`VALID_MS_MAX`]. The set-points before then stand unchanged.
    pub fn set(&mut self, request: &SetPressures, now_us: u64) -> Result<(), Refusal> {
        self.advance(now_us);
        if self.state == Actuation::Disarmed {
            return Err(Refusal::Disarmed);
        }
        if request.pressures_pa.iter().zip(&self.limits_pa).any(|(pressure, limit)| pressure > limit) {
            return Err(Refusal::OverRange);
        }
        if !(1..=VALID_MS_MAX).contains(&request.valid_ms) {
            return Err(Refusal::Deadline);
        }
        let mut pressures_pa = request.pressures_pa;
        if self.degraded {
            for (pressure, now) in pressures_pa.iter_mut().zip(self.pressures_pa) {
                *pressure = now.min(*pressure);
            }
        }
        self.course = Some(Course { pressures_pa, accepted_us: now_us, valid_ms: request.valid_ms });
        self.advance(now_us);
        Ok(())
    }

    /// Brings state and pressures to this time; to be called every tick.
    pub fn advance(&mut self, now_us: u64) {
        let Some(course) = &self.course else { return };
        (self.state, self.pressures_pa) = course.at(now_us);
        if self.state == Actuation::Disarmed {
            self.course = None;
        }
    }

    /// State, as of the last call that brought the time.
    pub fn state(&self) -> Actuation {
        self.state
    }

    /// Set-points that the regulators get, Pa, as of the last call that brought the time.
    pub fn pressures_pa(&self) -> [u32; REGULATORS] {
        self.pressures_pa
    }

    /// The same as duties of a PWM with this period, in counts: none at 0 Pa, the whole period at [`FULL_SCALE_PA`].
    pub fn duties(&self, period_counts: u16) -> [u16; REGULATORS] {
        let full = u64::from(FULL_SCALE_PA);
        self.pressures_pa.map(|pressure| share(u32::from(period_counts), u64::from(pressure), full) as u16)
    }

    /// The state, once after each change.
    pub fn event(&mut self) -> Option<Event> {
        let changed = self.state != self.reported;
        self.reported = self.state;
        changed.then_some(Event::Actuation(self.state))
    }
}

fn us(ms: u16) -> u64 {
    u64::from(ms) * 1000
}

/// `whole · part / of`, rounded down; `part` is `of` at most.
fn share(whole: u32, part: u64, of: u64) -> u32 {
    (u64::from(whole) * part / of) as u32
}
