//! The table that is attached to a recording.

use std::io::Read;

use calibration_tables::ArmFile;
use mcap::records::{Record, op};

use super::scanner::{Part, Scanner};

/// Name of the attachment.
pub const TABLE: &str = "table.toml";

/// The table that is attached to a recording in front of its messages; `None` without one, and where it cannot be read: a
/// recording is read without it, too.
pub fn attached_table(file: impl Read) -> Option<ArmFile> {
    let mut scanner = Scanner::new(file);
    while let Ok(Some(part)) = scanner.next_part() {
        let Part::Record(opcode, body) = part else { continue };
        if opcode == op::MESSAGE {
            return None;
        }
        if opcode != op::ATTACHMENT {
            continue;
        }
        if let Ok(Record::Attachment { header, data, .. }) = mcap::parse_record(opcode, scanner.body(body))
            && header.name == TABLE
        {
            return ArmFile::parse(std::str::from_utf8(&data).ok()?).ok().filter(|file| !file.is_description());
        }
    }
    None
}
