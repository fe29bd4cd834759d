//! Drift between the IMUs and the bend sensors that no good IMU has: of one IMU, or of both bend sensors of a segment together.
//!
//! The angle of a segment by its IMUs less that by its bend sensors changes as the IMUs drift, which the table expects. What is
//! above a multiple of this drift is summed (Page's CUSUM test) and found where it exceeds a multiple of the bend sensors' errors.
//!
//! An IMU drifts in two segments by opposite angles, a segment's bend sensors drift in one. At the tip they look the same. A
//! segment's bend sensors look like all IMUs from this segment to the tip, where these drift by one and the same angle; below the
//! multiple of the table's drift that is what good IMUs may do, so that nothing is found there.

use calibration_tables::{ArmFile, DriftToml, MAX_SEGMENTS};

use super::finding::{Finding, Kind, Rows, Source, is_bend_blamed, is_chain_wrong, is_imu_blamed};
use super::frame::{Frame, difference};

/// Duration of a mean, s.
const SECONDS: f64 = 20.0;
/// Drift that is not found, as a multiple of the table's deviation of an IMU's drift.
const DRIFTS: f64 = 4.0;
/// Least angle beyond it, deg, and as a multiple of the deviation of the segment's bend sensors.
const ANGLE: f64 = 15.0;
const DEVIATIONS: f64 = 12.0;

/// Angle of each segment by the IMUs less that by the bend sensors, deg.
type Differences = [f64; MAX_SEGMENTS];

/// Drift of one segment in one direction.
#[derive(Debug, Clone, Copy, Default)]
struct Run {
    /// Drift beyond the expected one since the run began, deg.
    sum: f64,
    /// Differences before it.
    from: Differences,
    rows: Rows,
    /// Its largest sum, and what was found at that time.
    largest: f64,
    change: Differences,
    found: Rows,
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Drift {
    segments: usize,
    /// Segments with two bend sensors.
    are_twins: [bool; MAX_SEGMENTS],
    /// Drift that is not found, deg/s.
    rate: f64,
    /// Least sums, deg.
    limits: [f64; MAX_SEGMENTS],
    from_s: f64,
    rows: Rows,
    sums: Differences,
    /// Segments of which a heading has jumped, or was not read, since the last mean.
    broken: [bool; MAX_SEGMENTS],
    /// Middle of the last mean, s, and the mean; NaN for a segment without one.
    last_s: f64,
    last: Differences,
    /// Of each segment, those that rise and those that fall.
    runs: [[Run; 2]; MAX_SEGMENTS],
}

impl Drift {
    pub fn new(table: &ArmFile) -> Self {
        let rate =
            table.drift.as_ref().map_or_else(|| DriftToml::kalman().rate_deg_per_s, |drift| drift.rate_deg_per_s);
        let (mut limits, mut are_twins) = ([ANGLE; MAX_SEGMENTS], [false; MAX_SEGMENTS]);
        for ((limit, are_twins), segment) in limits.iter_mut().zip(&mut are_twins).zip(&table.segments) {
            let deviation = segment.bend_error.as_ref().map_or(0.0, |error| error.mean_deg);
            *limit = ANGLE.max(DEVIATIONS * deviation);
            *are_twins = segment.bend.iter().flatten().count() > 1;
        }
        Self {
            segments: table.segments.len(),
            are_twins,
            rate: DRIFTS * rate,
            limits,
            from_s: f64::NEG_INFINITY,
            rows: Rows::default(),
            sums: [0.0; MAX_SEGMENTS],
            broken: [false; MAX_SEGMENTS],
            last_s: f64::NAN,
            last: [f64::NAN; MAX_SEGMENTS],
            runs: [[Run::default(); 2]; MAX_SEGMENTS],
        }
    }

    pub fn update(&mut self, frame: &Frame) {
        if frame.starts {
            self.end();
            self.last = [f64::NAN; MAX_SEGMENTS];
        }
        if frame.time_s >= self.from_s + SECONDS {
            self.end();
            self.from_s = frame.time_s;
        }
        self.rows.add(frame);
        for (i, (sum, broken)) in self.sums.iter_mut().zip(&mut self.broken).enumerate().take(self.segments) {
            *sum += difference(&frame.heading, i) - frame.theta[i];
            *broken |= frame.broken[i] || i > 0 && frame.broken[i - 1];
        }
    }

    /// Ends a mean. A segment of which a reading is missing has none, which ends its runs.
    fn end(&mut self) {
        let rows = std::mem::take(&mut self.rows);
        let (sums, broken) = (std::mem::take(&mut self.sums), std::mem::take(&mut self.broken));
        if rows.to_s - rows.from_s < SECONDS / 2.0 {
            return;
        }
        let mean: Differences = std::array::from_fn(|i| if broken[i] { f64::NAN } else { sums[i] / rows.count as f64 });
        let middle_s = f64::midpoint(rows.from_s, rows.to_s);
        let expected = self.rate * (middle_s - self.last_s);
        for (i, [rises, falls]) in self.runs.iter_mut().enumerate().take(self.segments) {
            let change = mean[i] - self.last[i];
            rises.add(change - expected, &self.last, &mean, &rows);
            falls.add(-change - expected, &self.last, &mean, &rows);
        }
        (self.last_s, self.last) = (middle_s, mean);
    }

    pub fn finish(&mut self, findings: &mut Vec<Finding>) {
        self.end();
        let mut found: Vec<Finding> = Vec::new();
        for (i, runs) in self.runs.iter().enumerate().take(self.segments) {
            let run = if runs[0].largest >= runs[1].largest { &runs[0] } else { &runs[1] };
            let blamed = self.blame(i, &run.change).filter(|_| run.largest > self.limits[i]);
            if let Some((sensor, figure)) = blamed.filter(|(sensor, _)| self.is_unblamed(findings, *sensor, i)) {
                let finding = Finding { sensor, rows: run.found, kind: Kind::Drift, figure };
                match found.iter_mut().find(|other| other.sensor == sensor) {
                    Some(other) if other.figure < figure => *other = finding,
                    Some(_) => {}
                    None => found.push(finding),
                }
            }
        }
        findings.append(&mut found);
    }

    /// The source that explains most of the changes' squares, of those that explain that of segment `i`, and its drift; `None`
    /// where the IMU at the segment's start may be the one, but is not seen in the segment before.
    fn blame(&self, i: usize, change: &Differences) -> Option<(Source, f64)> {
        let is_known = |i: usize| i < self.segments && !change[i].is_nan();
        if i > 0 && !is_known(i - 1) {
            return None;
        }
        let segment = i + 1;
        let own = match (is_known(segment), self.are_twins[i]) {
            (false, _) => Source::ImuOrBend { segment },
            (true, true) => Source::Twins { segment },
            (true, false) => Source::Bend { segment, place: 0 },
        };
        let by_bend = (own, change[i], change[i] * change[i]);
        // An IMU turns the start of the next segment by the same angle.
        let by_imu = |imu: usize| {
            let drift = f64::midpoint(change[imu], -change[imu + 1]);
            (Source::Imu { segment: imu + 1 }, drift, 2.0 * drift * drift)
        };
        let imus = [i.checked_sub(1), is_known(segment).then_some(i)];
        let all = imus.into_iter().flatten().map(by_imu);
        let (sensor, drift, _) = all.fold(by_bend, |best, other| if other.2 > best.2 { other } else { best });
        Some((sensor, drift.abs()))
    }

    /// True where no finding explains the drift.
    fn is_unblamed(&self, findings: &[Finding], sensor: Source, i: usize) -> bool {
        let segments = match sensor {
            Source::Imu { segment } => segment - 1..=segment,
            _ => i..=i,
        };
        let is_blamed = |i: usize| {
            is_bend_blamed(findings, i + 1) || is_imu_blamed(findings, i + 1) || i > 0 && is_imu_blamed(findings, i)
        };
        !segments.into_iter().any(is_blamed) && !is_chain_wrong(findings, self.segments)
    }
}

impl Run {
    /// Adds a change beyond the expected drift, from one mean to the next.
    fn add(&mut self, excess: f64, last: &Differences, mean: &Differences, rows: &Rows) {
        if self.sum <= 0.0 {
            (self.sum, self.from, self.rows) = (0.0, *last, Rows::default());
        }
        // NaN, without one of the means, ends the run: `max` ignores it.
        self.sum = (self.sum + excess).max(0.0);
        self.rows.append(rows);
        if self.sum > self.largest {
            self.largest = self.sum;
            self.found = self.rows;
            self.change = std::array::from_fn(|i| mean[i] - self.from[i]);
        }
    }
}
