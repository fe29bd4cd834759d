//! Backup registers: eight words that are retained over resets while their supply lasts, for counters of boots and crashes.
//!
//! ```no_run
//! use atsam3x8e_hal::{backup::Backup, pac};
//!
//! let device = pac::Peripherals::take().unwrap();
//! let mut backup = Backup::new(device.GPBR);
//! backup.write::<0>(backup.read::<0>().wrapping_add(1));
//! ```

use crate::{pac, reg};

/// The general-purpose backup registers (datasheet chapter 17). On the Due their supply is the board's own 3.3 V.
#[derive(Debug)]
pub struct Backup(pac::GPBR);

impl Backup {
    /// Takes the registers; their content is unchanged.
    pub fn new(gpbr: pac::GPBR) -> Self {
        Self(gpbr)
    }

    /// Reads register `N`, 0 to 7. 0 after power-up.
    pub fn read<const N: usize>(&self) -> u32 {
        const { assert!(N < 8, "the chip has backup registers 0 to 7") };
        self.0.gpbr[N].read().bits()
    }

    /// Writes register `N`, 0 to 7.
    pub fn write<const N: usize>(&mut self, value: u32) {
        const { assert!(N < 8, "the chip has backup registers 0 to 7") };
        reg::set(&self.0.gpbr[N], value);
    }
}
