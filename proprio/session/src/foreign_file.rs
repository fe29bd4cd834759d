//! Files of other kinds than sessions, by their first bytes: packed files, spreadsheets, text in another encoding.

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes at the start by which a kind is detected.
const BEGIN: u64 = 32;
/// First bytes of packed files, and the names of their kinds.
const PACKED: [(&[u8], &str); 7] = [
    (b"\x1f\x8b", "gzip"),
    (b"PK\x03\x04", "zip"),
    (b"\x28\xb5\x2f\xfd", "zstd"),
    (b"\x04\x22\x4d\x18", "lz4"),
    (b"BZh", "bzip2"),
    (b"\xfd7zXZ\0", "xz"),
    (b"7z\xbc\xaf\x27\x1c", "7z"),
];
/// First bytes of data of other programs, and the names of their kinds.
const DATA: [(&[u8], &str); 5] = [
    (b"#ROSBAG", "a bag of ROS 1"),
    (b"SQLite format 3\0", "a database, as bags of ROS 2 (.db3) are"),
    (b"\x89HDF\r\n", "an HDF5 file"),
    (b"MATLAB 5.0", "a file of MATLAB"),
    (b"PAR1", "a Parquet file"),
];
/// Endings of spreadsheets, which are zip files or of the old form.
const SPREADSHEETS: [&str; 3] = ["xlsx", "ods", "xls"];

/// A file of another kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForeignFile {
    /// A packed file, by the name of its kind.
    Packed(&'static str),
    /// A spreadsheet.
    Spreadsheet,
    /// Data of another program, by the name of its kind.
    Data(&'static str),
    /// Text in UTF-16.
    Utf16,
    /// A recording in place of a CSV.
    Recording,
}

impl ForeignFile {
    /// The kind of a file; `None` for text in UTF-8, and for a file that cannot be read.
    #[must_use]
    pub fn of_file(path: &Path) -> Option<Self> {
        let mut begin = Vec::new();
        File::open(path).ok()?.take(BEGIN).read_to_end(&mut begin).ok()?;
        Self::of(path, &begin)
    }

    /// Detects the kind by the first bytes of a file, and by its name.
    pub(crate) fn of(path: &Path, begin: &[u8]) -> Option<Self> {
        let named = |kinds: &[(&[u8], &'static str)]| {
            kinds.iter().find(|(magic, _)| begin.starts_with(magic)).map(|(_, name)| *name)
        };
        let is_spreadsheet =
            path.extension().is_some_and(|of| SPREADSHEETS.iter().any(|ending| of.eq_ignore_ascii_case(ending)));
        if is_spreadsheet {
            Some(Self::Spreadsheet)
        } else if is_utf16(begin) {
            Some(Self::Utf16)
        } else {
            named(&PACKED).map(Self::Packed).or_else(|| named(&DATA).map(Self::Data))
        }
    }
}

/// True for a byte order mark, and for Latin letters, each with a zero byte.
fn is_utf16(begin: &[u8]) -> bool {
    let has_zeros = |place: usize| {
        let pairs = begin.chunks_exact(2);
        pairs.len() > 1 && pairs.into_iter().all(|pair| pair[place] == 0 && pair[1 - place] != 0)
    };
    begin.starts_with(b"\xff\xfe") || begin.starts_with(b"\xfe\xff") || has_zeros(0) || has_zeros(1)
}

impl fmt::Display for ForeignFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Packed(name) => write!(f, "is a packed file ({name})"),
            Self::Spreadsheet => f.write_str("is a spreadsheet"),
            Self::Data(name) => write!(f, "is {name}"),
            Self::Utf16 => f.write_str("is text in UTF-16"),
            Self::Recording => f.write_str("is a recording, expected a CSV"),
        }
    }
}
