//! A channel: counter, duty, period, and their double buffers (datasheet 38.6.2).

use crate::model::Cycles;
use crate::ticks::Ticks;

/// Channels of the controller.
pub const CHANNELS: usize = 8;

/// A frequency, Hz, and its divisor.
pub type Clock = (u32, u32);

const CALG: u32 = 1 << 8;
const CPOL: u32 = 1 << 9;
const DTE: u32 = 1 << 16;
const DTLI: u32 = 1 << 18;

/// The clock that CMR.CPRE selects: MCK / 2^CPRE, CLKA, or CLKB (datasheet 38.6.1).
pub fn channel_clock(mode: u32, clock_register: u32, master_clock_hz: u32) -> Clock {
    let linear = |shift: u32| {
        let divisor = (clock_register >> shift) & 0xFF;
        let prescaler = (clock_register >> (shift + 8)) & 15;
        // DIV = 0 turns it off.
        (if prescaler <= 10 { master_clock_hz } else { 0 }, divisor << prescaler.min(10))
    };
    match mode & 15 {
        prescaler @ 0..=10 => (master_clock_hz, 1 << prescaler),
        11 => linear(0),
        12 => linear(16),
        _ => (0, 1),
    }
}

/// Period and alignment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    period: u32,
    center_aligned: bool,
}

impl Timing {
    /// Clocks of a whole period; a centre-aligned counter goes up and down.
    fn clocks(self) -> u32 {
        if self.center_aligned { 2 * self.period } else { self.period }
    }
}

/// One channel.
#[derive(Debug, Clone)]
pub struct Channel {
    /// CMR.
    pub mode: u32,
    pub duty: u32,
    pub period: u32,
    pub dead_time: u32,
    pub next_duty: Option<u32>,
    pub next_period: Option<u32>,
    pub next_dead_time: Option<u32>,
    pub enabled: bool,
    /// It was disabled, and stops at the end of the period.
    pub stopping: bool,
    ticks: Ticks,
    /// The tick at which the period began.
    began: u64,
}

impl Default for Channel {
    fn default() -> Self {
        Self {
            mode: 0,
            duty: 0,
            period: 0,
            dead_time: 0,
            next_duty: None,
            next_period: None,
            next_dead_time: None,
            enabled: false,
            stopping: false,
            ticks: Ticks { origin: 0, hz: 0, divisor: 1 },
            began: 0,
        }
    }
}

impl Channel {
    pub fn timing(&self) -> Timing {
        Timing { period: self.period, center_aligned: self.mode & CALG != 0 }
    }

    /// Begins a period now, unless one is under way.
    pub fn enable(&mut self, (hz, divisor): Clock, now: Cycles) {
        self.stopping = false;
        if !self.enabled {
            self.enabled = true;
            self.ticks = Ticks { origin: now, hz, divisor };
            self.began = 0;
        }
    }

    /// Begins a new period if the clock has changed.
    pub fn follow_clock(&mut self, (hz, divisor): Clock, now: Cycles) {
        if (self.ticks.hz, self.ticks.divisor) != (hz, divisor) {
            self.ticks = Ticks { origin: now, hz, divisor };
            self.began = 0;
        }
    }

    pub fn stop_if_requested(&mut self) {
        self.enabled &= !self.stopping;
        self.stopping = false;
    }

    /// End of the period.
    pub fn period_end(&self, timing: Timing) -> Option<Cycles> {
        if !self.enabled || timing.clocks() == 0 {
            return None;
        }
        self.ticks.time(self.began + u64::from(timing.clocks()))
    }

    pub fn next_period(&mut self, timing: Timing) {
        self.began += u64::from(timing.clocks());
    }

    /// Goes to the last period that has begun by `now`.
    pub fn skip_periods(&mut self, timing: Timing, now: Cycles) {
        let passed = self.ticks.at(now) - self.began;
        self.began += passed - passed % u64::from(timing.clocks());
    }

    /// CCNT.
    pub fn counter(&self, timing: Timing, now: Cycles) -> u32 {
        if !self.enabled {
            return 0;
        }
        let passed = self.ticks.at(now).saturating_sub(self.began) as u32;
        if timing.center_aligned && passed > timing.period { timing.clocks().saturating_sub(passed) } else { passed }
    }

    pub fn has_update(&self) -> bool {
        self.next_duty.is_some() || self.next_period.is_some() || self.next_dead_time.is_some()
    }

    /// Applies the update registers.
    pub fn update_all(&mut self) {
        self.update_duty();
        self.update_period();
    }

    pub fn update_duty(&mut self) {
        self.duty = self.next_duty.take().unwrap_or(self.duty);
    }

    /// Period and dead time.
    pub fn update_period(&mut self) {
        self.period = self.next_period.take().unwrap_or(self.period);
        self.dead_time = self.next_dead_time.take().unwrap_or(self.dead_time);
    }

    /// Level of PWML now, without its dead time: the complement of OC, which leaves CPOL at CDTY.
    pub fn low_side_level(&self, timing: Timing, now: Cycles) -> bool {
        let runs = self.enabled && timing.period != 0;
        let reached_duty = runs && self.counter(timing, now) >= self.duty;
        let oc = reached_duty != (self.mode & CPOL != 0);
        oc == (self.mode & DTLI != 0)
    }

    /// The next instant after `now` at which the comparator's output changes: at CDTY, on the way back, or with the period.
    pub fn next_edge(&self, timing: Timing, now: Cycles) -> Option<Cycles> {
        if !self.enabled || timing.clocks() == 0 {
            return None;
        }
        let duty = u64::from(self.duty.min(timing.period));
        let clocks = u64::from(timing.clocks());
        let edges = [duty, clocks - duty + 1, clocks, clocks + duty];
        let times = edges.iter().filter_map(|edge| self.ticks.time(self.began + edge));
        times.filter(|time| *time > now).min()
    }

    /// High clocks of PWML, of the clocks of a period.
    pub fn low_side(&self, timing: Timing) -> (u32, u32) {
        let starts_high = self.mode & CPOL != 0;
        let inverted = self.mode & DTLI != 0;
        if !self.enabled || timing.period == 0 {
            return (u32::from(starts_high == inverted), 1);
        }
        let first_part = self.duty.min(timing.period);
        let scale = if timing.center_aligned { 2 } else { 1 };
        let oc_low = scale * if starts_high { timing.period - first_part } else { first_part };
        // With an edge in every period PWML rises only after its dead time.
        let has_edges = oc_low != 0 && oc_low != timing.clocks();
        let delay = if self.mode & DTE != 0 && has_edges { self.dead_time >> 16 } else { 0 };
        let high = oc_low.saturating_sub(delay);
        (if inverted { timing.clocks() - high } else { high }, timing.clocks())
    }
}
