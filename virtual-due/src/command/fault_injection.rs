//! Faults that the user injects while the board runs, by lines on standard input.

use std::io::{BufRead, stdin};
use std::sync::mpsc::{Receiver, channel};

use virtual_due::rig::{Faults, ImuFault, Rail};

/// Reader of faults from standard input, where that is not the serial line.
pub struct FaultInjector(Receiver<String>);

impl FaultInjector {
    /// Starts to read lines.
    pub fn new() -> Self {
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in stdin().lock().lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Self(lines)
    }

    /// Applies the faults of the lines received; prints those that it cannot parse.
    pub fn apply(&self, faults: &mut Faults) {
        for line in self.0.try_iter() {
            if apply(line.trim(), faults).is_none() {
                eprintln!("{line}: expected `unplug` or `plug`, and bend1a to bend6b or imu1 to imu6");
            }
        }
    }
}

fn apply(line: &str, faults: &mut Faults) -> Option<()> {
    let (verb, sensor) = line.split_once(' ')?;
    let is_unplugged = match verb {
        "unplug" => true,
        "plug" => false,
        _ => return None,
    };
    if let Some(number) = sensor.strip_prefix("imu") {
        let fault = faults.imus.get_mut(number.parse::<usize>().ok()?.checked_sub(1)?)?;
        *fault = if is_unplugged { ImuFault::Unplugged } else { ImuFault::None };
    } else {
        let name = sensor.strip_prefix("bend")?;
        let side = ["a", "b"].iter().position(|side| name.ends_with(side))?;
        let segment = name.get(..name.len() - 1)?.parse::<usize>().ok()?.checked_sub(1)?;
        *faults.bend.get_mut(2 * segment + side)? = is_unplugged.then_some(Rail::High);
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::{Faults, ImuFault, Rail, apply};

    #[test]
    fn sensors_are_unplugged_and_plugged_in_by_name() {
        let mut faults = Faults::default();
        assert_eq!(apply("unplug imu3", &mut faults), Some(()));
        assert_eq!(apply("unplug bend6b", &mut faults), Some(()));
        assert_eq!((faults.imus[2], faults.bend[11]), (ImuFault::Unplugged, Some(Rail::High)));
        assert_eq!(apply("plug imu3", &mut faults), Some(()));
        assert_eq!(apply("plug bend6b", &mut faults), Some(()));
        assert_eq!((faults.imus[2], faults.bend[11]), (ImuFault::None, None));
        for line in ["", "unplug", "unplug imu0", "unplug imu7", "unplug bend7a", "unplug bend1c", "pull imu1"] {
            assert_eq!(apply(line, &mut faults), None, "{line}");
        }
    }
}
