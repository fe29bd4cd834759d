//! The pressures: arming, set-points with a deadline, and venting after it.
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

use crate::command_server::Execution;
use board_table::Wiring;
use heapless::Vec;
use telemetry::{Actuation, Event, MAX_REGULATORS, Refusal, SetPressures, vector};

/// A pressure of each regulator, Pa.
pub type Pressures = Vec<u32, MAX_REGULATORS>;

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
/// use board_core::Actuator;
/// use board_table::Wiring;
/// use telemetry::{Actuation, SetPressures};
///
/// // Six regulators of 280 kPa.
/// let mut actuator = Actuator::new(&Wiring::reference(6));
/// actuator.arm();
/// let half = SetPressures { pressures_pa: [140_000; 6].into_iter().collect(), valid_ms: 100 };
/// actuator.set(&half, 0)?;
/// assert_eq!(actuator.duties(4200), [2100; 6]);
///
/// actuator.advance(250_000);
/// assert_eq!((actuator.state(), actuator.pressures_pa()), (Actuation::Holding, &half.pressures_pa));
/// actuator.advance(1_400_000);
/// assert_eq!((actuator.state(), actuator.duties(4200)), (Actuation::Disarmed, [0; 6].into_iter().collect()));
/// # Ok::<(), telemetry::Refusal>(())
/// ```
#[derive(Debug)]
pub struct Actuator {
    /// Pressure of each regulator at full duty.
    full_scale_pa: Pressures,
    state: Actuation,
    /// The state that was reported last.
    reported: Actuation,
    pressures_pa: Pressures,
    /// The accepted set-points and their deadline.
    lease: Option<SetpointLease>,
    degraded: bool,
}

/// Set-points from their acceptance to the vented arm.
#[derive(Debug, Clone)]
struct SetpointLease {
    pressures_pa: Pressures,
    accepted_us: u64,
    valid_ms: u16,
}

impl SetpointLease {
    /// State at a time, and the numerator and denominator of the pressures' share of the set-points.
    fn at(&self, now_us: u64) -> (Actuation, [u64; 2]) {
        let age_us = now_us.saturating_sub(self.accepted_us);
        let hold_from_us = us(self.valid_ms);
        let ramp_from_us = hold_from_us + us(HOLD_MS);
        if age_us <= hold_from_us {
            return (Actuation::Armed, [1, 1]);
        }
        if age_us <= ramp_from_us {
            return (Actuation::Holding, [1, 1]);
        }
        let left_us = us(VENTED_MS).saturating_sub(age_us);
        let ramp_us = us(VENTED_MS) - ramp_from_us;
        (if left_us == 0 { Actuation::Disarmed } else { Actuation::Ramping }, [left_us, ramp_us])
    }
}

impl Actuator {
    /// The regulators that are wired, vented and disarmed. None accepts a set-point over its full scale.
    pub fn new(wiring: &Wiring) -> Self {
        let full_scale_pa: Pressures = vector(wiring.regulators.iter().map(|regulator| regulator.full_scale_pa));
        Self {
            pressures_pa: vector(full_scale_pa.iter().map(|_| 0)),
            full_scale_pa,
            state: Actuation::Disarmed,
            reported: Actuation::Disarmed,
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
        self.pressures_pa.fill(0);
        self.lease = None;
    }

    /// Sets whether the shape estimate is degraded: all IMUs, or all bend sensors of a segment, are lost.
    ///
    /// While degraded, set-points are accepted but limited to the present pressures ([`Execution::Limited`]). So the arm can
    /// be lowered and vented under control, but no pressure rises.
    pub fn set_degraded(&mut self, degraded: bool) {
        self.degraded = degraded;
    }

    /// Accepts new set-points, and returns whether they were limited.
    ///
    /// # Errors
    /// [`Refusal::Disarmed`] if it is not armed, [`Refusal::Regulators`] if there are more or fewer set-points than
    /// regulators, [`Refusal::OverRange`] if a pressure is over its regulator's full scale, [`Refusal::Deadline`] if
    /// `valid_ms` is not 1 to [`VALID_MS_MAX`]. The previous set-points are then unchanged.
    pub fn set(&mut self, request: &SetPressures, now_us: u64) -> Result<Execution, Refusal> {
        self.advance(now_us);
        if self.state == Actuation::Disarmed {
            return Err(Refusal::Disarmed);
        }
        if request.pressures_pa.len() != self.full_scale_pa.len() {
            return Err(Refusal::Regulators);
        }
        if request.pressures_pa.iter().zip(&self.full_scale_pa).any(|(pressure, limit)| pressure > limit) {
            return Err(Refusal::OverRange);
        }
        if !(1..=VALID_MS_MAX).contains(&request.valid_ms) {
            return Err(Refusal::Deadline);
        }
        let mut pressures_pa = request.pressures_pa.clone();
        if self.degraded {
            for (pressure, now) in pressures_pa.iter_mut().zip(&self.pressures_pa) {
                *pressure = (*now).min(*pressure);
            }
        }
        let is_limited = pressures_pa != request.pressures_pa;
        self.lease = Some(SetpointLease { pressures_pa, accepted_us: now_us, valid_ms: request.valid_ms });
        self.advance(now_us);
        Ok(if is_limited { Execution::Limited } else { Execution::Done })
    }

    /// Advances state and pressures to this time; called every tick.
    pub fn advance(&mut self, now_us: u64) {
        let Some(lease) = &self.lease else { return };
        let (state, [part, of]) = lease.at(now_us);
        self.state = state;
        for (pressure, set_point) in self.pressures_pa.iter_mut().zip(&lease.pressures_pa) {
            *pressure = share(*set_point, part, of);
        }
        if self.state == Actuation::Disarmed {
            self.lease = None;
        }
    }

    /// State at the time of the last call with a time.
    pub fn state(&self) -> Actuation {
        self.state
    }

    /// Set-points of the regulators, Pa, at the time of the last call with a time.
    pub fn pressures_pa(&self) -> &Pressures {
        &self.pressures_pa
    }

    /// The set-points as PWM duties, counts: 0 at 0 Pa, the whole period at full scale.
    pub fn duties(&self, period_counts: u16) -> Vec<u16, MAX_REGULATORS> {
        let pressures = self.pressures_pa.iter().zip(&self.full_scale_pa);
        let duty =
            |(pressure, full): (&u32, &u32)| share(period_counts.into(), (*pressure).into(), (*full).into()) as u16;
        vector(pressures.map(duty))
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

/// `whole · part / of`, rounded down; `part` is `of` at most. 0 of nothing.
fn share(whole: u32, part: u64, of: u64) -> u32 {
    (u64::from(whole) * part).checked_div(of).unwrap_or(0) as u32
}
