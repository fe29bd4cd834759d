//! Detector of IMUs that give the same readings: a multiplexer on the wrong channel, whose register reads back right,
//! gives one IMU's readings under the names of two.

use telemetry::MAX_SEGMENTS;

/// Changes of a reading, in each of which it was the same as another IMU's, bit for bit, after which both are invalid.
/// Two IMUs of the same heading, with a noise of 0.1° each in steps of 0.007°, agree in one tick of fifty by chance.
const CHANGES: u8 = 5;

type Quaternion = [i16; 4];

#[derive(Debug)]
pub(super) struct CopyDetector {
    last: [Option<Quaternion>; MAX_SEGMENTS],
    /// Changes in a row in which the readings were the same as another IMU's.
    changes: [u8; MAX_SEGMENTS],
}

impl CopyDetector {
    pub(super) const fn new() -> Self {
        Self { last: [None; MAX_SEGMENTS], changes: [0; MAX_SEGMENTS] }
    }

    /// Updates the detector with the readings of a tick. Returns the IMUs whose readings are another's.
    pub(super) fn update(&mut self, now: &[Option<Quaternion>; MAX_SEGMENTS]) -> [bool; MAX_SEGMENTS] {
        let mut copies = [false; MAX_SEGMENTS];
        let imus = self.last.iter_mut().zip(&mut self.changes).zip(&mut copies).zip(now);
        for (((last, changes), is_copy), reading) in imus {
            let has_changed = core::mem::replace(last, *reading) != *reading;
            let is_same = reading.is_some() && now.iter().filter(|other| *other == reading).count() > 1;
            if !is_same {
                *changes = 0;
            } else if has_changed {
                *changes = changes.saturating_add(1);
            }
            *is_copy = *changes >= CHANGES;
        }
        copies
    }
}
