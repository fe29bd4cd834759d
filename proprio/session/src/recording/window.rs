//! The bytes of a file that are next, as many as are needed.

use std::io::{self, Read};

/// Bytes that are read at once.
const PIECE: usize = 1 << 16;

/// A window over the bytes of a file. Its memory grows with the bytes that were read, never with a length that a record claims.
#[derive(Debug)]
pub struct Window<R> {
    source: R,
    bytes: Vec<u8>,
    start: usize,
    offset: u64,
    at_end: bool,
}

impl<R: Read> Window<R> {
    pub fn new(source: R) -> Self {
        Self { source, bytes: Vec::new(), start: 0, offset: 0, at_end: false }
    }

    /// Place of the window's first byte in the file.
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// The next `count` bytes from `from` on; fewer at the end of the file.
    pub fn peek(&mut self, from: usize, count: usize) -> io::Result<&[u8]> {
        let end = from.saturating_add(count);
        while !self.at_end && self.bytes.len() - self.start < end {
            self.fill()?;
        }
        let unread = &self.bytes[self.start..];
        Ok(&unread[from.min(unread.len())..end.min(unread.len())])
    }

    /// Moves the window's begin by `count` bytes that were peeked at.
    pub fn consume(&mut self, count: usize) {
        let count = count.min(self.bytes.len() - self.start);
        self.start += count;
        self.offset += count as u64;
    }

    fn fill(&mut self) -> io::Result<()> {
        if self.start >= PIECE && 2 * self.start >= self.bytes.len() {
            self.bytes.drain(..self.start);
            self.start = 0;
        }
        let length = self.bytes.len();
        self.bytes.resize(length + PIECE, 0);
        let read = loop {
            match self.source.read(&mut self.bytes[length..]) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                read => break read,
            }
        };
        self.bytes.truncate(length + *read.as_ref().unwrap_or(&0));
        self.at_end = matches!(read, Ok(0));
        read.map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::{PIECE, Window};

    #[test]
    fn a_claimed_length_takes_no_more_memory_than_the_file() {
        let file = vec![7; 22_000];
        let mut window = Window::new(&file[..]);
        assert_eq!(window.peek(0, 1 << 40).expect("memory can be read").len(), file.len());
        assert!(window.bytes.capacity() <= 4 * PIECE, "{} bytes", window.bytes.capacity());
    }

    #[test]
    fn consumed_bytes_are_not_kept() {
        let file = vec![7; 1 << 22];
        let mut window = Window::new(&file[..]);
        while !window.peek(0, 100).expect("memory can be read").is_empty() {
            window.consume(100);
        }
        assert_eq!(window.offset(), file.len() as u64);
        assert!(window.bytes.capacity() <= 4 * PIECE, "{} bytes", window.bytes.capacity());
    }
}
