//! A bend sensor that leaves its twin and the IMU: a strip that comes loose, a bad contact.

use calibration_tables::{ArmFile, MAX_SEGMENTS};

use super::finding::{Finding, Kind, Rows, Source, is_bend_blamed, is_imu_exchanged};
use super::frame::{Frame, difference};

/// Duration of a mean, s.
const SECONDS: f64 = 10.0;
/// Least difference of the twins, deg, and as a multiple of the deviation of half their difference in the calibration.
const ANGLE: f64 = 30.0;
const DEVIATIONS: f64 = 6.0;
/// The sensor that stays is nearer to the IMU than this share of the difference.
const NEAR: f64 = 0.35;

/// Sums of a mean.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    a_imu: f64,
    b_imu: f64,
    count: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Segment {
    limit: f64,
    tare: Sums,
    now: Sums,
    left: [Rows; 2],
    figure: [f64; 2],
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Twins {
    tare_s: f64,
    tare_ends_s: f64,
    from_s: f64,
    rows: Rows,
    segments: [Segment; MAX_SEGMENTS],
}

impl Twins {
    pub fn new(table: &ArmFile) -> Self {
        let mut segments = [Segment { limit: ANGLE, ..Segment::default() }; MAX_SEGMENTS];
        for (segment, given) in segments.iter_mut().zip(&table.segments) {
            let deviation = given.bend_error.as_ref().map_or(0.0, |error| error.difference_deg);
            segment.limit = ANGLE.max(DEVIATIONS * deviation);
        }
        Self { tare_s: table.tare.seconds, tare_ends_s: 0.0, from_s: 0.0, rows: Rows::default(), segments }
    }

    pub fn update(&mut self, frame: &Frame) {
        if frame.starts {
            self.end();
            self.tare_ends_s = frame.time_s + self.tare_s;
            self.from_s = frame.time_s;
            self.segments.iter_mut().for_each(|segment| segment.tare = Sums::default());
        }
        if frame.time_s >= self.from_s + SECONDS {
            self.end();
            self.from_s = frame.time_s;
        }
        self.rows.add(frame);
        let is_tare = frame.time_s < self.tare_ends_s;
        for (i, segment) in self.segments.iter_mut().enumerate() {
            let imu = difference(&frame.heading, i);
            let [a, b] = frame.bend[i];
            if (a + b + imu).is_nan() {
                continue;
            }
            let sums = if is_tare { &mut segment.tare } else { &mut segment.now };
            sums.a_imu += a - imu;
            sums.b_imu += b - imu;
            sums.count += 1.0;
        }
    }

    fn end(&mut self) {
        let rows = std::mem::take(&mut self.rows);
        for segment in &mut self.segments {
            let Sums { a_imu, b_imu, count } = std::mem::take(&mut segment.now);
            if count * 2.0 < rows.count as f64 || segment.tare.count == 0.0 {
                continue;
            }
            let tare = &segment.tare;
            // The IMU's zero is that of the tare, by both sensors.
            let zero = f64::midpoint(tare.a_imu, tare.b_imu) / tare.count;
            let [a, b] = [a_imu / count - zero, b_imu / count - zero];
            let figure = (a - b).abs();
            if figure < segment.limit {
                continue;
            }
            for (place, (leaves, stays)) in [(a, b), (b, a)].into_iter().enumerate() {
                if stays.abs() < NEAR * figure && leaves.abs() > stays.abs() {
                    segment.left[place].append(&rows);
                    segment.figure[place] = segment.figure[place].max(figure);
                }
            }
        }
    }

    pub fn finish(&mut self, findings: &mut Vec<Finding>) {
        self.end();
        for (i, segment) in self.segments.iter().enumerate() {
            let is_blamed = is_bend_blamed(findings, i + 1) || (i..=i + 1).any(|imu| is_imu_exchanged(findings, imu));
            for place in 0..2 {
                let sensor = Source::Bend { segment: i + 1, place };
                let rows = segment.left[place];
                if rows.count > 0 && !is_blamed {
                    findings.push(Finding { sensor, rows, kind: Kind::LeavesTwin, figure: segment.figure[place] });
                }
            }
        }
    }
}
