//! The file that keeps the flash of the board between runs.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::PathBuf;

use virtual_due::model::World;
use virtual_due::{FLASH_BYTES, Machine};

/// The file of the flash's content.
pub struct FlashFile {
    path: PathBuf,
    /// The content of the file.
    kept: Vec<u8>,
}

impl FlashFile {
    /// Loads the file into the flash of a board, but for what the firmware occupies. A file that does not exist is empty
    /// flash, and made.
    ///
    /// # Errors
    /// Those of the file, and [`ErrorKind::InvalidData`] for another length.
    pub fn load<W: World>(path: PathBuf, machine: &mut Machine<W>) -> io::Result<Self> {
        let kept = match fs::read(&path) {
            Ok(content) if content.len() == FLASH_BYTES => content,
            Ok(content) => {
                let reason = format!("the file has {} bytes, expected {FLASH_BYTES}", content.len());
                return Err(io::Error::new(ErrorKind::InvalidData, reason));
            }
            Err(error) if error.kind() == ErrorKind::NotFound => vec![0xFF; FLASH_BYTES],
            Err(error) => return Err(error),
        };
        machine.load_flash(&kept);
        let mut file = Self { path, kept };
        file.keep(machine)?;
        Ok(file)
    }

    /// Writes the file if the flash has changed.
    ///
    /// # Errors
    /// Those of the file.
    pub fn keep<W: World>(&mut self, machine: &Machine<W>) -> io::Result<()> {
        let content = machine.flash();
        if content == self.kept {
            return Ok(());
        }
        self.kept = content;
        // A program that is killed meanwhile leaves the content before or after.
        let part = self.path.with_added_extension("part");
        fs::write(&part, &self.kept)?;
        fs::rename(part, &self.path)
    }
}
