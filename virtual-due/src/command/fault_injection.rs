//! Faults that the user injects while the board runs, by lines on standard input.

use std::io::{BufRead, stdin};
use std::sync::mpsc::{Receiver, channel};

use virtual_due::rig::{ImuFault, Rail, WiredRig};

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
    pub fn apply(&self, rig: &mut WiredRig) {
        for line in self.0.try_iter() {
            if apply(line.trim(), rig).is_none() {
                eprintln!("{line}: expected `unplug` or `plug`, and a sensor of the arm, such as bend1a or imu1");
            }
        }
    }
}

fn apply(line: &str, rig: &mut WiredRig) -> Option<()> {
    let (verb, sensor) = line.split_once(' ')?;
    let is_unplugged = match verb {
        "unplug" => true,
        "plug" => false,
        _ => return None,
    };
    if let Some(number) = sensor.strip_prefix("imu") {
        let segment = number.parse::<usize>().ok()?.checked_sub(1)?;
        rig.wiring().segments.get(segment)?.imu?;
        rig.faults.imus[segment] = if is_unplugged { ImuFault::Unplugged } else { ImuFault::None };
    } else {
        let name = sensor.strip_prefix("bend")?;
        let side = ["a", "b"].iter().position(|side| name.ends_with(side))?;
        let segment = name.get(..name.len() - 1)?.parse::<usize>().ok()?.checked_sub(1)?;
        rig.wiring().segments.get(segment)?.bend[side]?;
        rig.faults.bend[2 * segment + side] = is_unplugged.then_some(Rail::High);
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use rig_twin::Scenario;

    use super::{ImuFault, Rail, WiredRig, apply};

    #[test]
    fn sensors_are_unplugged_and_plugged_in_by_name() {
        let mut rig = WiredRig::new(Scenario::FreeSwing, 1);
        assert_eq!(apply("unplug imu3", &mut rig), Some(()));
        assert_eq!(apply("unplug bend6b", &mut rig), Some(()));
        assert_eq!((rig.faults.imus[2], rig.faults.bend[11]), (ImuFault::Unplugged, Some(Rail::High)));
        assert_eq!(apply("plug imu3", &mut rig), Some(()));
        assert_eq!(apply("plug bend6b", &mut rig), Some(()));
        assert_eq!((rig.faults.imus[2], rig.faults.bend[11]), (ImuFault::None, None));
        for line in ["", "unplug", "unplug imu0", "unplug imu7", "unplug bend7a", "unplug bend1c", "pull imu1"] {
            assert_eq!(apply(line, &mut rig), None, "{line}");
        }
    }
}
