//! Control of the pressures: one handle of a link drives them at a time.

use std::sync::Weak;
use std::time::{Duration, Instant};

use telemetry::Command;

/// Time from the last request of a handle that drives to the end of its control. The board has vented by then.
const HELD: Duration = Duration::from_millis(1500);

/// The handle that drives the pressures, if one does: from its request to arm or to set them until the arm is vented, the handle
/// is dropped, or it has sent nothing for 1.5 s.
#[derive(Debug, Default)]
pub(super) struct Control {
    holder: Option<(Weak<()>, Instant)>,
}

impl Control {
    /// True where this handle may send the command. To vent is permitted to all.
    pub fn admits(&mut self, handle: &Weak<()>, command: &Command, now: Instant) -> bool {
        match command {
            Command::Arm | Command::SetPressures(_) => {
                let is_other = |(holder, until): &(Weak<()>, Instant)| {
                    holder.strong_count() > 0 && now < *until && !holder.ptr_eq(handle)
                };
                let is_free = !self.holder.as_ref().is_some_and(is_other);
                if is_free {
                    self.holder = Some((handle.clone(), now + HELD));
                }
                is_free
            }
            Command::Disarm => {
                self.holder = None;
                true
            }
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use telemetry::{SetPressures, TareMode};

    use super::{Command, Control, HELD, Instant};

    fn pressures() -> Command {
        Command::SetPressures(SetPressures { pressures_pa: [1000; 6].into_iter().collect(), valid_ms: 300 })
    }

    #[test]
    fn one_handle_drives_until_it_is_dropped() {
        let (mut control, now) = (Control::default(), Instant::now());
        let (one, other) = (Arc::new(()), Arc::new(()));
        assert!(control.admits(&Arc::downgrade(&one), &Command::Arm, now));
        assert!(control.admits(&Arc::downgrade(&one), &pressures(), now));
        for command in [Command::Arm, pressures()] {
            assert!(!control.admits(&Arc::downgrade(&other), &command, now));
        }
        assert!(control.admits(&Arc::downgrade(&other), &Command::Tare(TareMode::IfStill), now));
        drop(one);
        assert!(control.admits(&Arc::downgrade(&other), &Command::Arm, now));
    }

    #[test]
    fn any_handle_vents_which_ends_the_control_of_another() {
        let (mut control, now) = (Control::default(), Instant::now());
        let (one, other) = (Arc::new(()), Arc::new(()));
        assert!(control.admits(&Arc::downgrade(&one), &Command::Arm, now));
        assert!(control.admits(&Arc::downgrade(&other), &Command::Disarm, now));
        assert!(control.admits(&Arc::downgrade(&other), &Command::Arm, now));
    }

    #[test]
    fn control_ends_when_the_board_has_vented_and_is_extended_by_each_set_of_pressures() {
        let (mut control, start) = (Control::default(), Instant::now());
        let (one, other) = (Arc::new(()), Arc::new(()));
        let later = start + HELD / 2;
        assert!(control.admits(&Arc::downgrade(&one), &Command::Arm, start));
        assert!(control.admits(&Arc::downgrade(&one), &pressures(), later));
        assert!(!control.admits(&Arc::downgrade(&other), &Command::Arm, start + HELD));
        assert!(control.admits(&Arc::downgrade(&other), &Command::Arm, later + HELD));
    }
}
