//! The six pressures: arming, set-points with a deadline, and venting after it.
//!
//! Pressures move only while armed, and only while set-points are received. Accepted set-points are a lease of the
//! pressures: they are valid until their deadline `valid_ms`. Time from the last accepted set-points:
//!
//! | time | state | pressures |
//! |---|---|---|
//! | up to `valid_ms` | [`Actuation::Armed`] | the set-points |
//! | then for [`HOLD_MS`] | [`Actuation::Holding`] | the set-points, still |
//! | then up to [`VENTED_MS`] | [`Actuation::Ramping`] | straight down to 0 |
//! | from [`VENTED_MS`] on | [`Actuation::Disarmed`] | 0, until armed again |
//!
//! The arm is vented at the same time for every deadline: a longer one leaves less time for the ramp, which takes 1.1 s
//! at most and 0.1 s at the longest deadline of [`VALID_MS_MAX`]. [`VENTED_MS`] is 100 ms less than the 1.5 s within
//! which the arm must be vented, for the frame's transmission, the tick, and the regulator's own lag.
//!
//! Set-points received while holding or ramping are followed again: only a vented arm must be armed. An arm that was
//! armed and has received no set-points has no deadline; it is vented and stays armed. Arming it again while it is not
//! disarmed changes nothing, so that arming cannot extend a deadline.

use telemetry::{Actuation, Event, REGULATORS, Refusal, SetPressures};

/// Pressure of a regulator at full duty, Pa: the supply's.
pub const FULL_SCALE_PA: u32 = 280_000;

/// Longest deadline of set-points, ms.
pub const VALID_MS_MAX: u16 = 1000;

/// Time for which the pressures are held after the deadline, ms.
pub const HOLD_MS: u16 = 300;

/// Time from the last accepted set-points to zero pressure, ms.
pub const VENTED_MS: u16 = 1400;

/// The longest deadline leaves time for a ramp.
const _: () = assert!(VALID_MS_MAX + HOLD_MS < VENTED_MS);

/// The pressures' set-points and their state.
///
/// It has no clock: the time since boot in µs, which never decreases, is an argument.
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
    /// The accepted set-points and their deadline.
    lease: Option<SetpointLease>,
    degraded: bool,
}

/// Set-points from their acceptance to the vented arm.
#[derive(Debug, Clone, Copy)]
struct SetpointLease {
    pressures_pa: [u32; REGULATORS],
    accepted_us: u64,
    valid_ms: u16,
}

impl SetpointLease {
    /// State and pressures, Pa, at a time.
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
            lease: None,
            degraded: false,
        }
    }

    /// Lets set-points move the pressures, which stay at zero until then.
    pub fn arm(&mut self) {
        if self.state == Actuation::Disarmed {
            self.state = Actuation::Armed;
        }
    }

    /// Vents at once, and lets nothing move the pressures until armed again.
    pub fn disarm(&mut self) {
        self.state = Actuation::Disarmed;
        self.pressures_pa = [0; REGULATORS];
        self.lease = None;
    }

    /// Sets whether the shape estimate is degraded: all IMUs, or all bend sensors of a segment, are lost.
    ///
    /// While degraded, set-points are accepted but limited to the present pressures. So the arm can be lowered and vented
    /// under control, but no pressure rises.
    pub fn set_degraded(&mut self, degraded: bool) {
        self.degraded = degraded;
    }

    /// Accepts new set-points.
    ///
    /// # Errors
    /// [`Refusal::Disarmed`] if it is not armed, [`Refusal::OverRange`] if a pressure is over its regulator's limit,
    /// [`Refusal::Deadline`] if `valid_ms` is not 1 to [`VALID_MS_MAX`]. The previous set-points are then unchanged.
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
        self.lease = Some(SetpointLease { pressures_pa, accepted_us: now_us, valid_ms: request.valid_ms });
        self.advance(now_us);
        Ok(())
    }

    /// Advances state and pressures to this time; called every tick.
    pub fn advance(&mut self, now_us: u64) {
        let Some(lease) = &self.lease else { return };
        (self.state, self.pressures_pa) = lease.at(now_us);
        if self.state == Actuation::Disarmed {
            self.lease = None;
        }
    }

    /// State at the time of the last call with a time.
    pub fn state(&self) -> Actuation {
        self.state
    }

    /// Set-points of the regulators, Pa, at the time of the last call with a time.
    pub fn pressures_pa(&self) -> [u32; REGULATORS] {
        self.pressures_pa
    }

    /// The set-points as PWM duties, counts: 0 at 0 Pa, the whole period at [`FULL_SCALE_PA`].
    pub fn duties(&self, period_counts: u16) -> [u16; REGULATORS] {
        let full = u64::from(FULL_SCALE_PA);
        self.pressures_pa.map(|pressure| share(u32::from(period_counts), u64::from(pressure), full) as u16)
    }

    /// Returns the state once after each change.
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
