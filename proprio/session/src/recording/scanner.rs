//! Reads the records of a file, and continues behind damaged ones.
//!
//! A chunk has a checksum: one that fails it is left out. Behind a damaged record the next record is searched whose form, and
//! whose checksum where it has one, are right.

use std::io::{self, Read};
use std::ops::Range;

use mcap::records::op;

use super::form::{self, CHUNK_HEADER, ChunkForm, HEAD, MAX_CHUNK_HEADER, MAX_RECORD, u64_at};
use super::hole::Hole;
use super::read_error::ReadError;
use super::window::Window;

/// Bytes of a damaged part that are kept to classify it; a longer one has messages.
const MOST_KEPT: usize = 1 << 16;

/// Bytes in which a record has the lengths of its parts.
const MOST_LENGTHS: usize = 4096;

/// Bytes of the file's end: the footer, and the magic bytes.
const END: usize = HEAD + 20 + mcap::MAGIC.len();

/// A part of a file.
#[derive(Debug)]
pub enum Part {
    /// A whole record: its opcode, and the place of its body for [`Scanner::body`].
    Record(u8, Range<usize>),
    /// Damaged messages.
    Hole(Hole),
    /// Damaged attachments or metadata.
    DamagedAbout,
}

/// A damaged part's content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Content {
    Messages,
    About,
    Index,
}

/// A whole record at a place of the window.
struct Found {
    opcode: u8,
    /// Bytes in the file.
    length: usize,
    /// The records in it, one after the other.
    records: Vec<u8>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Begin,
    Data,
    Index,
    Finished,
}

/// Reader of the records of a file.
pub struct Scanner<R> {
    window: Window<R>,
    place: Place,
    /// Records that were read.
    records: Vec<u8>,
    /// The next of them.
    next: usize,
    is_chunked: bool,
    last_ns: Option<u64>,
    hole: Option<Hole>,
    /// Damaged attachments and metadata that are not reported yet.
    damaged_about: u32,
    is_cut: bool,
    lost_end: Option<u64>,
    index_is_damaged: bool,
}

impl<R: Read> Scanner<R> {
    pub fn new(source: R) -> Self {
        Self {
            window: Window::new(source),
            place: Place::Begin,
            records: Vec::new(),
            next: 0,
            is_chunked: false,
            last_ns: None,
            hole: None,
            damaged_about: 0,
            is_cut: false,
            lost_end: None,
            index_is_damaged: false,
        }
    }

    /// True where the file ends without its index, after the last part.
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Bytes of the last part, which was cut, where the file ends before the end of its data, after the last part.
    pub fn lost_end(&self) -> Option<u64> {
        self.lost_end
    }

    /// True where a part is damaged that has no data.
    pub fn index_is_damaged(&self) -> bool {
        self.index_is_damaged
    }

    /// Bytes that were read.
    pub fn bytes(&self) -> u64 {
        self.window.offset()
    }

    /// The body of the last record.
    pub fn body(&self, place: Range<usize>) -> &[u8] {
        &self.records[place]
    }

    /// The next part, or `None` at the end.
    pub fn next_part(&mut self) -> Result<Option<Part>, ReadError> {
        loop {
            if let Some((opcode, length)) = form::head(&self.records[self.next..]) {
                let body = self.next + HEAD..self.next + HEAD + length as usize;
                if opcode == op::MESSAGE {
                    let log_ns = u64_at(&self.records[body.clone()], 6);
                    if let Some(hole) = self.hole.take() {
                        return Ok(Some(Part::Hole(Hole { to_ns: log_ns, ..hole })));
                    }
                    self.last_ns = log_ns;
                }
                self.next = body.end;
                return Ok(Some(Part::Record(opcode, body)));
            }
            if self.damaged_about > 0 {
                self.damaged_about -= 1;
                return Ok(Some(Part::DamagedAbout));
            }
            match self.place {
                Place::Begin => self.begin()?,
                Place::Data => self.load().map_err(ReadError::Read)?,
                Place::Index => self.skip_index().map_err(ReadError::Read)?,
                Place::Finished => return Ok(self.hole.take().map(Part::Hole)),
            }
        }
    }

    /// Reads the magic bytes; damaged ones are accepted before a whole header.
    fn begin(&mut self) -> Result<(), ReadError> {
        const LENGTH: usize = mcap::MAGIC.len();
        let is_magic = self.window.peek(0, LENGTH).map_err(ReadError::Read)? == mcap::MAGIC;
        if !is_magic {
            let header = self.found(LENGTH, false).map_err(ReadError::Read)?;
            if header.is_none_or(|header| header.opcode != op::HEADER) {
                return Err(ReadError::NoMcap);
            }
            self.index_is_damaged = true;
        }
        self.window.consume(LENGTH);
        self.place = Place::Data;
        Ok(())
    }

    /// Reads the next record or chunk.
    fn load(&mut self) -> io::Result<()> {
        if self.window.peek(0, 1)?.is_empty() {
            self.cut(0);
            return Ok(());
        }
        let Some(found) = self.found(0, false)? else { return self.skip_damage() };
        self.window.consume(found.length);
        self.is_chunked |= found.opcode == op::CHUNK;
        self.records = found.records;
        self.next = 0;
        if matches!(found.opcode, op::DATA_END | op::FOOTER) {
            self.place = Place::Index;
        }
        Ok(())
    }

    /// The whole record at `at`. In a search its form must be right in each part; otherwise one part may be damaged that follows
    /// from the others.
    fn found(&mut self, at: usize, in_search: bool) -> io::Result<Option<Found>> {
        let Some((opcode, length)) = form::head(self.window.peek(at, HEAD)?) else { return Ok(None) };
        if in_search && !self.may_follow_damage(opcode) {
            return Ok(None);
        }
        if let Some(found) = self.chunk(at, opcode, length, in_search)? {
            return Ok(Some(found));
        }
        if opcode == op::CHUNK {
            return Ok(None);
        }
        if length <= MAX_RECORD {
            let length = length as usize;
            let next = at + HEAD + length;
            let is_chunked = self.is_chunked;
            let body = self.window.peek(at + HEAD, length)?;
            let is_complete = body.len() == length;
            let fitting = if in_search {
                Some(opcode).filter(|of| form::fits_surely(*of, body))
            } else {
                form::opcode_of(opcode, body, is_chunked)
            };
            if let Some(opcode) = fitting.filter(|of| is_complete && (!in_search || *of == op::ATTACHMENT)) {
                return self.take(at, opcode, length).map(Some);
            }
            let is_sure = opcode == op::DATA_END || !in_search || self.is_searched(next)?;
            if is_complete && is_sure && (fitting.is_some() || opcode > op::DATA_END) && self.follows(next, opcode)? {
                return self.take(at, opcode, length).map(Some);
            }
            if in_search || self.found(next, true)?.is_some() {
                return Ok(None);
            }
        }
        if in_search {
            return Ok(None);
        }
        let own = form::own_length(opcode, self.window.peek(at + HEAD, MOST_LENGTHS)?);
        let Some(own) = own.filter(|own| *own as u64 <= MAX_RECORD) else { return Ok(None) };
        let next = at + HEAD + own;
        let body = self.window.peek(at + HEAD, own)?;
        if body.len() < own || !form::fits(opcode, body) {
            return Ok(None);
        }
        let is_followed = match opcode {
            op::HEADER | op::DATA_END | op::FOOTER => self.follows(next, opcode)?,
            _ => self.found(next, true)?.is_some(),
        };
        if is_followed { self.take(at, opcode, own).map(Some) } else { Ok(None) }
    }

    /// True for the records that a search stops at. Messages in a damaged chunk have no checksum of their own.
    fn may_follow_damage(&self, opcode: u8) -> bool {
        match opcode {
            op::CHUNK | op::MESSAGE_INDEX | op::ATTACHMENT | op::METADATA | op::DATA_END | op::FOOTER => true,
            op::SCHEMA | op::CHANNEL | op::MESSAGE => !self.is_chunked,
            _ => false,
        }
    }

    /// True where the record at `at` is of a kind that a search stops at, or there is none or an end.
    fn is_searched(&mut self, at: usize) -> io::Result<bool> {
        let opcode = self.window.peek(at, 1)?.first().copied();
        Ok(opcode.is_none_or(|opcode| opcode == mcap::MAGIC[0] || self.may_follow_damage(opcode)))
    }

    /// True where a record begins at `at`, or the file ends there, behind a record of this kind.
    fn follows(&mut self, at: usize, opcode: u8) -> io::Result<bool> {
        let next = self.window.peek(at, HEAD)?;
        if opcode == op::FOOTER {
            return Ok(next.starts_with(mcap::MAGIC));
        }
        Ok(match form::head(next) {
            Some((opcode, length)) => (op::HEADER..=op::DATA_END).contains(&opcode) && length <= MAX_RECORD,
            None => next.is_empty(),
        })
    }

    fn take(&mut self, at: usize, opcode: u8, length: usize) -> io::Result<Found> {
        let has_content = matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE | op::ATTACHMENT | op::METADATA);
        let mut records = Vec::new();
        if has_content {
            records.push(opcode);
            records.extend((length as u64).to_le_bytes());
            records.extend(self.window.peek(at + HEAD, length)?);
        }
        Ok(Found { opcode, length: HEAD + length, records })
    }

    /// The chunk at `at`, whose opcode or one of whose lengths may be damaged, as its checksum holds.
    fn chunk(&mut self, at: usize, opcode: u8, length: u64, in_search: bool) -> io::Result<Option<Found>> {
        let header = self.window.peek(at + HEAD, MAX_CHUNK_HEADER)?;
        let Some(form) = ChunkForm::of(header) else { return Ok(None) };
        // Zeros are no chunk.
        if in_search && (form.crc == 0 || form.data == 0) {
            return Ok(None);
        }
        if (opcode != op::CHUNK || in_search) && form.data.checked_add(form.header as u64) != Some(length) {
            return Ok(None);
        }
        let lengths = form.data_lengths(length);
        let is_sure = lengths.iter().flatten().count() == 1;
        for data_length in lengths.into_iter().flatten() {
            let data_length = data_length as usize;
            let next = at + HEAD + form.header + data_length;
            let data = self.window.peek(at + HEAD + form.header, data_length)?;
            if data.len() < data_length {
                continue;
            }
            if let Some(records) = form.records(data) {
                let records = records.into_owned();
                // A compressed chunk ends before its data where that is too long.
                if is_sure || self.follows(next, op::CHUNK)? {
                    return Ok(Some(Found { opcode: op::CHUNK, length: next - at, records }));
                }
            }
        }
        Ok(None)
    }

    /// Leaves out a damaged record, to the next whole one.
    fn skip_damage(&mut self) -> io::Result<()> {
        let offset = self.window.offset();
        let head = form::head(self.window.peek(0, HEAD)?);
        self.is_chunked |= head.is_some_and(|(opcode, _)| opcode == op::CHUNK);
        let end = match head {
            Some((_, length)) if length <= MAX_RECORD => Some(HEAD + length as usize),
            _ => None,
        };
        let mut length = 1;
        if let Some(end) = end
            && self.window.peek(end - 1, 1)?.len() == 1
            && (self.window.peek(end, 1)?.is_empty() || self.found(end, true)?.is_some())
        {
            length = end;
        } else {
            while self.found(length, true)?.is_none() {
                if self.window.peek(length, 1)?.is_empty() {
                    // Nothing whole follows.
                    self.window.consume(length);
                    self.cut(self.window.offset() - offset);
                    return Ok(());
                }
                if length < MOST_KEPT {
                    length += 1;
                } else {
                    self.window.consume(1);
                }
            }
        }
        let content =
            if self.window.offset() == offset { content(self.window.peek(0, length)?) } else { Content::Messages };
        self.window.consume(length);
        let hole = Hole { offset, bytes: self.window.offset() - offset, from_ns: self.last_ns, to_ns: None };
        match content {
            Content::Messages => self.hole = Some(self.hole.map_or(hole, |before| before.with(&hole))),
            Content::About => self.damaged_about += 1,
            Content::Index => self.index_is_damaged = true,
        }
        Ok(())
    }

    /// Notes that the file ends before the end of its data, within a part of which there are `bytes`.
    fn cut(&mut self, bytes: u64) {
        self.is_cut = true;
        self.lost_end = Some(bytes);
        self.place = Place::Finished;
    }

    /// Reads the index, which repeats what the data section has, to the magic bytes at the file's end.
    fn skip_index(&mut self) -> io::Result<()> {
        const PIECE: usize = 1 << 16;
        self.place = Place::Finished;
        loop {
            let bytes = self.window.peek(0, PIECE)?;
            let length = bytes.len();
            let is_whole = bytes.windows(mcap::MAGIC.len()).any(|bytes| bytes == mcap::MAGIC);
            if is_whole || length < PIECE {
                // The magic bytes may be damaged behind a whole footer.
                let footer = length.checked_sub(END).and_then(|at| form::head(&bytes[at..]));
                self.is_cut = !is_whole && footer != Some((op::FOOTER, 20));
                self.window.consume(length);
                return Ok(());
            }
            self.window.consume(PIECE - END);
        }
    }
}

/// The content of a damaged part.
fn content(part: &[u8]) -> Content {
    let Some((opcode, length)) = form::head(part) else { return Content::Messages };
    let body = &part[HEAD..];
    let is_own = |opcode| form::own_length(opcode, body) == Some(body.len());
    let is_one = length == body.len() as u64;
    match opcode {
        op::ATTACHMENT | op::METADATA if is_one || is_own(opcode) => Content::About,
        op::HEADER | op::MESSAGE_INDEX if is_one || is_own(opcode) => Content::Index,
        _ if is_one && body.len() < CHUNK_HEADER && is_own(op::MESSAGE_INDEX) => Content::Index,
        _ => Content::Messages,
    }
}
