//! Faults with their times: `FAULT@SECONDS`, `FAULT@SECONDS+DURATION`, and lines of `SECONDS FAULT`.

use core::fmt;
use core::str::FromStr;

use super::error::FaultError;
use super::fault::Fault;

/// Margin at which a time has been reached, s, so that rounding never costs a step.
const SLACK_S: f64 = 1e-9;

/// A fault with its begin and its end.
///
/// ```
/// use rig_twin::{FaultError, TimedFault};
///
/// let jump: TimedFault = "imu3:jump=30@12.5+0.05".parse()?;
/// assert!(jump.is_present(12.52) && !jump.is_present(12.56));
/// # Ok::<(), FaultError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedFault {
    /// The fault.
    pub fault: Fault,
    /// Begin, s.
    pub begin_s: f64,
    /// End, s; infinite for one that stays.
    pub end_s: f64,
}

impl TimedFault {
    /// A fault from a time on.
    pub fn from(fault: Fault, begin_s: f64) -> Self {
        Self { fault, begin_s, end_s: f64::INFINITY }
    }

    /// True from the begin on.
    pub fn has_begun(&self, time_s: f64) -> bool {
        time_s >= self.begin_s - SLACK_S
    }

    /// True from the end on.
    pub fn has_ended(&self, time_s: f64) -> bool {
        time_s >= self.end_s - SLACK_S
    }

    /// True from the begin to the end.
    pub fn is_present(&self, time_s: f64) -> bool {
        self.has_begun(time_s) && !self.has_ended(time_s)
    }

    /// The fault `name` at `time`, SECONDS or SECONDS+DURATION.
    fn of(name: &str, time: &str) -> Result<Self, FaultError> {
        let fault: Fault = name.parse()?;
        let wrong = || FaultError::Time(time.to_owned());
        let seconds = |text: &str| text.parse().ok().filter(|seconds: &f64| (0.0..=1e9).contains(seconds));
        let (begin, duration) = time.split_once('+').map_or((time, None), |(begin, rest)| (begin, Some(rest)));
        let begin_s = seconds(begin).ok_or_else(wrong)?;
        let Some(duration) = duration else { return Ok(Self::from(fault, begin_s)) };
        if fault.is_instant() {
            return Err(FaultError::Instant(name.to_owned()));
        }
        Ok(Self { fault, begin_s, end_s: begin_s + seconds(duration).ok_or_else(wrong)? })
    }
}

impl FromStr for TimedFault {
    type Err = FaultError;

    /// `FAULT@SECONDS` or `FAULT@SECONDS+DURATION`.
    fn from_str(text: &str) -> Result<Self, FaultError> {
        let (name, time) = text.split_once('@').ok_or_else(|| FaultError::NoBegin(text.to_owned()))?;
        Self::of(name, time)
    }
}

impl fmt::Display for TimedFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}@{}", self.fault, self.begin_s)?;
        if self.end_s.is_finite() { write!(f, "+{}", self.end_s - self.begin_s) } else { Ok(()) }
    }
}

/// Reads a schedule: lines of `SECONDS FAULT` or `SECONDS+DURATION FAULT`; `#` begins a comment. Returns each fault with
/// the number of its line, counted from 1.
///
/// # Errors
/// The number of the first wrong line, counted from 1, and its error.
pub fn parse_schedule(text: &str) -> Result<Vec<(usize, TimedFault)>, (usize, FaultError)> {
    let mut faults = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let parsed = match line.split_whitespace().collect::<Vec<_>>()[..] {
            [time, name] => TimedFault::of(name, time),
            _ => Err(FaultError::Line(line.to_owned())),
        };
        faults.push((number, parsed.map_err(|error| (number, error))?));
    }
    Ok(faults)
}

#[cfg(test)]
mod tests {
    use super::{FaultError, TimedFault, parse_schedule};

    #[test]
    fn faults_with_times_are_parsed_and_printed_the_same() {
        for text in ["imu3:reset@12.5", "imu3:jump=30@10+0.5", "bend2a:factor=1.3@0"] {
            assert_eq!(text.parse::<TimedFault>().map(|timed| timed.to_string()), Ok(text.to_owned()));
        }
    }

    #[test]
    fn times_that_are_no_times_are_refused() {
        for text in ["imu3:frozen@", "imu3:frozen@x", "imu3:frozen@-1", "imu3:frozen@1+", "imu3:frozen@NaN"] {
            let error = text.parse::<TimedFault>().expect_err(text);
            assert!(matches!(error, FaultError::Time(_)), "{error}");
        }
        assert!(matches!("imu3:frozen".parse::<TimedFault>(), Err(FaultError::NoBegin(_))));
        assert!(matches!("imu3:reset@1+2".parse::<TimedFault>(), Err(FaultError::Instant(_))));
    }

    #[test]
    fn a_wrong_line_of_a_schedule_is_named() {
        let schedule = "# two faults\n\n1 imu3:reset\n2.5+0.05 imu1:jump=30 # a jump\n";
        let faults = parse_schedule(schedule).expect("two faults");
        let read: Vec<_> = faults.iter().map(|(line, timed)| (*line, timed.fault.to_string())).collect();
        assert_eq!(read, [(3, "imu3:reset".to_owned()), (4, "imu1:jump=30".to_owned())]);
        assert_eq!(parse_schedule("1 imu3:reset\nimu3:reset").map_err(|(line, _)| line), Err(2));
    }
}
