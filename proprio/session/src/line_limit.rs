//! A limit of the length of lines, so that a file without line ends does not take the memory.

use std::fmt;
use std::io::{self, Read};

/// Longest line, bytes.
pub const LONGEST_LINE: usize = 1 << 20;

/// Reader of text whose lines are not longer than [`LONGEST_LINE`].
pub struct LineLimit<R> {
    source: R,
    line: u64,
    length: usize,
}

/// The error of a longer line.
#[derive(Debug)]
pub struct LongLine {
    /// Its number, from 1.
    pub line: u64,
}

impl<R> LineLimit<R> {
    pub fn new(source: R) -> Self {
        Self { source, line: 1, length: 0 }
    }
}

impl<R: Read> Read for LineLimit<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // A line within what is read at once is not too long; the first and the last may go on outside of it.
        let room = buffer.len().min(LONGEST_LINE);
        let count = self.source.read(&mut buffer[..room])?;
        let text = &buffer[..count];
        let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
        self.length += text.iter().position(is_end).map_or(count, |first| first + 1);
        if self.length > LONGEST_LINE {
            return Err(io::Error::other(LongLine { line: self.line }));
        }
        if let Some(last) = text.iter().rposition(is_end) {
            self.length = count - (last + 1);
        }
        self.line += text.iter().map(|byte| u64::from(*byte == b'\n')).sum::<u64>();
        Ok(count)
    }
}

impl fmt::Display for LongLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {} is longer than {LONGEST_LINE} bytes", self.line)
    }
}

impl std::error::Error for LongLine {}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::{LONGEST_LINE, LineLimit, LongLine};

    #[test]
    fn a_long_line_is_refused_by_its_number() {
        let text = [b"a,b\n1,2\n".as_slice(), &vec![b','; LONGEST_LINE + 1]].concat();
        let error = LineLimit::new(&text[..]).read_to_end(&mut Vec::new()).expect_err("the line is too long");
        let long = error.get_ref().and_then(|error| error.downcast_ref::<LongLine>());
        assert_eq!(long.map(|long| long.line), Some(3));
    }

    #[test]
    fn a_long_file_of_short_lines_is_read() {
        let text = "1,2\r".repeat(LONGEST_LINE);
        assert_eq!(LineLimit::new(text.as_bytes()).read_to_end(&mut Vec::new()).expect("lines are short"), text.len());
    }
}
