//! The words that [`BootCounter`] retains over resets, in the chip's backup registers.

use atsam3x8e_hal::backup::Backup;
use board_core::{BootCounter, RETAINED_WORDS};

/// Reads the words of the last boot.
pub fn read(backup: &Backup) -> [u32; RETAINED_WORDS] {
    [
        backup.read::<0>(),
        backup.read::<1>(),
        backup.read::<2>(),
        backup.read::<3>(),
        backup.read::<4>(),
        backup.read::<5>(),
        backup.read::<6>(),
    ]
}

/// Writes the words of this boot.
pub fn write(backup: &mut Backup, boots: &BootCounter) {
    let [a, b, c, d, e, f, g] = boots.retained();
    backup.write::<0>(a);
    backup.write::<1>(b);
    backup.write::<2>(c);
    backup.write::<3>(d);
    backup.write::<4>(e);
    backup.write::<5>(f);
    backup.write::<6>(g);
}

/// Writes the uptime, ticks.
pub fn write_uptime(backup: &mut Backup, ticks: u32) {
    backup.write::<{ board_core::UPTIME_WORD }>(ticks);
}
