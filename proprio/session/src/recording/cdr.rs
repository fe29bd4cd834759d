//! CDR, the form of ROS 2 messages: little-endian, each number aligned to its own size.

/// Its first four bytes: plain CDR, little-endian (DDS-XTypes 1.3, 7.6.2).
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// Writer of a message.
#[derive(Debug)]
pub struct CdrWriter(Vec<u8>);

impl CdrWriter {
    /// A message without a field.
    #[must_use]
    #[expect(clippy::new_without_default, reason = "it is not empty: it has CDR's header")]
    pub fn new() -> Self {
        Self(HEADER.to_vec())
    }

    /// The message.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    fn align(&mut self, size: usize) {
        let length = HEADER.len() + (self.0.len() - HEADER.len()).next_multiple_of(size);
        self.0.resize(length, 0);
    }

    fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        self.align(N);
        self.0.extend_from_slice(&bytes);
    }

    /// A number of the type `uint8`.
    pub fn u8(&mut self, value: u8) {
        self.put([value]);
    }

    /// A number of the type `uint16`.
    pub fn u16(&mut self, value: u16) {
        self.put(value.to_le_bytes());
    }

    /// A number of the type `int16`.
    pub fn i16(&mut self, value: i16) {
        self.put(value.to_le_bytes());
    }

    /// A number of the type `uint32`.
    pub fn u32(&mut self, value: u32) {
        self.put(value.to_le_bytes());
    }

    /// A number of the type `uint64`.
    pub fn u64(&mut self, value: u64) {
        self.put(value.to_le_bytes());
    }

    /// A number of the type `int32`.
    pub fn i32(&mut self, value: i32) {
        self.put(value.to_le_bytes());
    }

    /// A number of the type `float32`.
    pub fn f32(&mut self, value: f32) {
        self.put(value.to_le_bytes());
    }

    /// A number of the type `float64`.
    pub fn f64(&mut self, value: f64) {
        self.put(value.to_le_bytes());
    }

    /// Numbers of an array, without their count.
    pub fn floats(&mut self, values: &[f64]) {
        for value in values {
            self.f64(*value);
        }
    }

    /// A string, ended by a zero.
    pub fn string(&mut self, text: &str) {
        self.length(text.len() + 1);
        self.0.extend_from_slice(text.as_bytes());
        self.0.push(0);
    }

    /// A sequence of bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.length(bytes.len());
        self.0.extend_from_slice(bytes);
    }

    /// Length of a sequence, whose items follow.
    pub fn length(&mut self, length: usize) {
        self.u32(length as u32);
    }
}

/// Reader of a message; its methods return `None` where the message is too short.
#[derive(Debug)]
pub struct CdrReader<'b> {
    body: &'b [u8],
    at: usize,
}

impl<'b> CdrReader<'b> {
    pub fn new(message: &'b [u8]) -> Option<Self> {
        message.strip_prefix(&HEADER).map(|body| Self { body, at: 0 })
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let start = self.at.next_multiple_of(N);
        let bytes = self.body.get(start..)?.first_chunk()?;
        self.at = start + N;
        Some(*bytes)
    }

    pub fn u8(&mut self) -> Option<u8> {
        self.take().map(u8::from_le_bytes)
    }

    pub fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    pub fn i16(&mut self) -> Option<i16> {
        self.take().map(i16::from_le_bytes)
    }

    pub fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    pub fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    /// A sequence of bytes.
    pub fn bytes(&mut self) -> Option<&'b [u8]> {
        let length = self.length()?;
        let bytes = self.body.get(self.at..)?.get(..length)?;
        self.at += length;
        Some(bytes)
    }

    /// A string, without the zero that ends it.
    pub fn string(&mut self) -> Option<&'b str> {
        std::str::from_utf8(self.bytes()?.strip_suffix(&[0])?).ok()
    }

    /// Length of a sequence, whose items follow.
    pub fn length(&mut self) -> Option<usize> {
        self.u32().map(|length| length as usize)
    }

    /// True where nothing is left.
    pub fn is_at_end(&self) -> bool {
        self.at == self.body.len()
    }

    /// A sequence of floats.
    pub fn floats(&mut self) -> Option<Vec<f64>> {
        let length = self.length()?;
        (0..length).map(|_| self.take().map(f64::from_le_bytes)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{CdrReader, CdrWriter};

    #[test]
    fn numbers_are_aligned_behind_the_header() {
        let mut cdr = CdrWriter::new();
        cdr.u8(1);
        cdr.u16(0x0302);
        cdr.string("ab");
        cdr.f64(1.0);
        let expected =
            [[0, 1, 0, 0], [1, 0, 2, 3], [3, 0, 0, 0], [b'a', b'b', 0, 0], [0; 4], [0, 0, 0xf0, 0x3f]].concat();
        // The float begins at 12 behind the header, and is moved to 16.
        let padded = [&expected[..16], &[0; 4], &expected[16..]].concat();
        assert_eq!(cdr.into_bytes(), padded);
    }

    #[test]
    fn a_cut_message_is_not_read() {
        let mut cdr = CdrWriter::new();
        cdr.string("frame");
        cdr.length(2);
        cdr.f64(1.5);
        cdr.f64(-2.5);
        let bytes = cdr.into_bytes();
        let read = |bytes: &[u8]| {
            let mut cdr = CdrReader::new(bytes)?;
            Some((cdr.string()?.to_owned(), cdr.floats()?))
        };
        assert_eq!(read(&bytes), Some(("frame".to_owned(), vec![1.5, -2.5])));
        assert_eq!((0..bytes.len()).find_map(|length| read(&bytes[..length])), None);
    }
}
