//! Random inputs, the same on board and host.

/// Marsaglia's xorshift of 32 bits (Journal of Statistical Software 8, 14).
#[derive(Debug, Clone)]
pub struct Random(u32);

impl Random {
    /// A sequence of its own for each seed but 0.
    #[must_use]
    pub const fn new(seed: u32) -> Self {
        Self(seed)
    }

    /// Any 32 bits but all zeros.
    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// A number of any size: small ones are as likely as large ones.
    pub fn number(&mut self) -> i32 {
        let shift = self.bits() >> 27;
        self.bits() as i32 >> shift
    }

    /// A number of any size in 64 bits.
    pub fn long(&mut self) -> i64 {
        let shift = self.bits() >> 26;
        ((i64::from(self.bits()) << 32) | i64::from(self.bits())) >> shift
    }

    /// One of `0..count`, nearly evenly.
    pub fn below(&mut self, count: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(count)) >> 32) as u32
    }
}
