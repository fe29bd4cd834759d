//! TC_CMR, as capture and as waveform mode (datasheet 36.7.3 and 36.7.4).

/// The mode register of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mode(pub u32);

/// Behaviour of the counter at its top in waveform mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Waveform {
    Up,
    UpDown,
    UpRc,
    UpDownRc,
}

/// The edges that a field selects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edges(u32);

impl Edges {
    /// True if a change to `level` is one of them.
    pub fn include(self, level: bool) -> bool {
        self.0 & (if level { 1 } else { 2 }) != 0
    }
}

impl Mode {
    fn field(self, shift: u32) -> u32 {
        (self.0 >> shift) & 3
    }

    pub fn bit(self, bit: u32) -> bool {
        self.0 & (1 << bit) != 0
    }

    /// Frequency of the source and its divisor: TIMER_CLOCK1…5. XC0…2 are counted edge by edge.
    pub fn clock(self, master_clock_hz: u32) -> (u32, u32) {
        match self.0 & 7 {
            0 => (master_clock_hz, 2),
            1 => (master_clock_hz, 8),
            2 => (master_clock_hz, 32),
            3 => (master_clock_hz, 128),
            4 => (32_768, 1),
            _ => (0, 1),
        }
    }

    /// The line XC0…2 that is the clock.
    pub fn external_clock(self) -> Option<usize> {
        (self.0 as usize & 7).checked_sub(5)
    }

    /// CLKI: the counter counts falling edges of its clock.
    pub fn counts_falling_edges(self) -> bool {
        self.bit(3)
    }

    /// BURST: a line XC0…2 gates the clock.
    pub fn has_burst_gate(self) -> bool {
        self.field(4) != 0
    }

    pub fn is_waveform(self) -> bool {
        self.bit(15)
    }

    pub fn waveform(self) -> Waveform {
        match self.field(13) {
            0 => Waveform::Up,
            1 => Waveform::UpDown,
            2 => Waveform::UpRc,
            _ => Waveform::UpDownRc,
        }
    }

    /// The counter counts down as well.
    pub fn turns(self) -> bool {
        self.is_waveform() && matches!(self.waveform(), Waveform::UpDown | Waveform::UpDownRc)
    }

    /// CPCSTOP and CPCDIS.
    pub fn stops_at_rc(self) -> bool {
        self.bit(6)
    }

    pub fn disables_at_rc(self) -> bool {
        self.bit(7)
    }

    /// The line XC0…2 that is the external event (EEVT = 1…3).
    pub fn event_line(self) -> Option<usize> {
        (self.field(10) as usize).checked_sub(1)
    }

    /// TIOB is an input: the external event (EEVT = 0).
    pub fn tiob_is_input(self) -> bool {
        self.field(10) == 0
    }

    pub fn event_edges(self) -> Edges {
        Edges(self.field(8))
    }

    pub fn event_triggers(self) -> bool {
        self.bit(12)
    }

    pub fn a_at_ra(self) -> u32 {
        self.field(16)
    }

    pub fn a_at_rc(self) -> u32 {
        self.field(18)
    }

    pub fn a_at_event(self) -> u32 {
        self.field(20)
    }

    pub fn a_at_trigger(self) -> u32 {
        self.field(22)
    }

    pub fn b_at_rb(self) -> u32 {
        self.field(24)
    }

    pub fn b_at_rc(self) -> u32 {
        self.field(26)
    }

    pub fn b_at_trigger(self) -> u32 {
        self.field(30)
    }

    /// LDBSTOP and LDBDIS.
    pub fn stops_at_rb_load(self) -> bool {
        self.bit(6)
    }

    pub fn disables_at_rb_load(self) -> bool {
        self.bit(7)
    }

    pub fn trigger_edges(self) -> Edges {
        Edges(self.field(8))
    }

    /// ABETRG: the external trigger is TIOA rather than TIOB.
    pub fn trigger_is_tioa(self) -> bool {
        self.bit(10)
    }

    pub fn rc_triggers(self) -> bool {
        self.bit(14)
    }

    pub fn load_a_edges(self) -> Edges {
        Edges(self.field(16))
    }

    pub fn load_b_edges(self) -> Edges {
        Edges(self.field(18))
    }
}
