//! Parts of a fuzz input.

/// The bytes of an input that are not taken yet.
pub struct Parts<'b>(&'b [u8]);

impl<'b> Parts<'b> {
    /// All bytes of an input.
    pub fn new(bytes: &'b [u8]) -> Self {
        Self(bytes)
    }

    /// Takes a byte; `None` at the end.
    pub fn byte(&mut self) -> Option<u8> {
        let (byte, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*byte)
    }

    /// Takes a length and so many bytes; fewer at the end.
    pub fn sized(&mut self) -> &'b [u8] {
        let length = self.byte().unwrap_or(0).into();
        self.bytes(length)
    }

    /// Takes this number of bytes; fewer at the end.
    pub fn bytes(&mut self, count: usize) -> &'b [u8] {
        let (bytes, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        bytes
    }

    /// Takes the four bytes of a number; 0 at the end.
    pub fn number(&mut self) -> u32 {
        self.bytes(4).first_chunk().copied().map_or(0, u32::from_le_bytes)
    }

    /// Takes all that is left.
    pub fn rest(&mut self) -> &'b [u8] {
        std::mem::take(&mut self.0)
    }
}
