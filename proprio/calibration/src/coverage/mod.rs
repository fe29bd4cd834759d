//! Coverage of a sweep while it is made, without truth: how far each segment has bent, and which sensor does not follow.
//!
//! The bend angle of a segment is the difference of the IMUs at both its ends, from the pose in which the sweep begins, without
//! their drift against a bend sensor that follows them. That needs no table.

mod drift;
mod fault;
mod range;
mod relation;
mod report;

use std::{array, mem};

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{HeadingTracker, ImuReading, SENSORS_PER_SEGMENT, Turns};
use proprio_session::Row;

pub use fault::SweepFault;
pub use report::{Rest, SegmentCoverage, SweepGoal, SweepReport};

use self::drift::DriftFilter;
use self::range::{Passes, RecentRange, SeenRange, widened};
use self::relation::Relation;
use crate::calibrate::{COUPLED, DEAD_COUNTS, GOOD_ENOUGH, LEAST_RANGE_DEG, UNRELATED};

/// Longest step of the time that is no gap, s.
const GAP_S: f64 = 0.5;
/// Time at the begin in which the arm should rest, s: the tare of a session.
const REST_S: f64 = 1.0;
/// Time for which a fault must hold before it is reported, s.
const HOLDS_S: f64 = 10.0;
/// Time of a step of the bend angles, and from one judgement of the sensors to the next, s.
const STEP_S: f64 = 1.0;
/// Standard deviation of a bend angle from which on sensors are compared with it, degrees.
const BENDS_DEG: f64 = 3.0;
/// Recent range of a heading below which the IMU stays, degrees.
const STAYS_DEG: f64 = 2.0;
/// Recent range of a bend sensor's readings from which on its IMU must turn, counts.
const TURNS_COUNTS: f64 = 5.0 * DEAD_COUNTS as f64;
/// Standard deviation of a bend sensor's readings from which on the IMUs are compared with it, counts: some degrees.
const BENDS_COUNTS: f64 = 50.0;

/// Heading of one IMU.
#[derive(Debug, Clone, Copy)]
struct Heading {
    tracker: HeadingTracker<f64>,
    zero: Option<Turns>,
    /// Smallest and largest heading in the first second, degrees.
    rest_deg: Option<[f64; 2]>,
}

impl Heading {
    fn new() -> Self {
        Self { tracker: HeadingTracker::new(0, Turns::ZERO), zero: None, rest_deg: None }
    }

    /// Heading from the pose at the begin, degrees.
    fn read(&mut self, reading: Option<&ImuReading>) -> Option<f64> {
        let heading = self.tracker.read(reading.and_then(ImuReading::heading))?;
        let zero = *self.zero.get_or_insert(heading);
        Some((heading - zero).rad().to_degrees())
    }
}

/// What one segment has gone through.
#[derive(Debug, Clone)]
struct Segment {
    angle: SeenRange,
    now_deg: Option<f64>,
    passes: Passes,
    /// Those of the readings of sensor a, which are reported where the bend angle is never known.
    passes_of_counts: Passes,
    counts: [Option<[u16; 2]>; SENSORS_PER_SEGMENT],
    /// The bend angle over the readings of each sensor.
    follows: [Relation; SENSORS_PER_SEGMENT],
    /// Whether it follows; `None` where neither has moved yet.
    is_followed: [Option<bool>; SENSORS_PER_SEGMENT],
    drift: [DriftFilter; SENSORS_PER_SEGMENT],
    /// The readings of sensor b over those of a.
    twins: Relation,
    recent_counts: [RecentRange; SENSORS_PER_SEGMENT],
    /// The readings of a sensor stay while the segment bends.
    stays: [bool; SENSORS_PER_SEGMENT],
    recent_angle: RecentRange,
    /// Heading of its end, degrees.
    recent_heading: RecentRange,
    /// The IMU at its end stays while sensor a moves.
    imu_stays: bool,
}

/// Coverage of a sweep, row by row.
#[derive(Debug, Clone)]
pub struct SweepCoverage {
    last_s: Option<f64>,
    seconds: f64,
    headings: [Heading; MAX_SEGMENTS],
    segments: Vec<Segment>,
    /// Time and bend angles at the last whole second.
    second: (f64, [Option<f64>; MAX_SEGMENTS]),
    /// Sums of the products of the steps of two bend angles over a second, in which there is no drift, degrees².
    products: [[f64; MAX_SEGMENTS]; MAX_SEGMENTS],
    /// The faults of the last judgement, and since when each of them holds, s of the sweep.
    faults: Vec<(SweepFault, f64)>,
}

impl SweepCoverage {
    /// The coverage before the first row, of an arm with this number of segments.
    #[must_use]
    pub fn new(segments: usize) -> Self {
        Self {
            last_s: None,
            seconds: 0.0,
            headings: [Heading::new(); MAX_SEGMENTS],
            segments: vec![Segment::new(); segments.min(MAX_SEGMENTS)],
            second: (f64::NEG_INFINITY, [None; MAX_SEGMENTS]),
            products: [[0.0; MAX_SEGMENTS]; MAX_SEGMENTS],
            faults: Vec::new(),
        }
    }

    /// Adds the next row. Where the estimator starts again, headings have a new zero: the arm is in its reference pose.
    pub fn update(&mut self, row: &Row) {
        let time_s = row.sample.time_us as f64 / 1e6;
        let step_s = self.last_s.map_or(0.0, |last_s| time_s - last_s);
        let step_s = if (0.0..GAP_S).contains(&step_s) { step_s } else { 0.0 };
        self.last_s = Some(time_s);
        self.seconds += step_s;
        if row.starts {
            self.headings = [Heading::new(); MAX_SEGMENTS];
            self.segments.iter_mut().for_each(|segment| segment.drift = [DriftFilter::new(); SENSORS_PER_SEGMENT]);
        }
        let headings_deg = self.headings(row);
        let before = |i: usize| if i == 0 { Some(0.0) } else { headings_deg[i - 1] };
        let angles_deg = array::from_fn(|i| Some(headings_deg[i]? - before(i)?));
        for (i, segment) in self.segments.iter_mut().enumerate() {
            segment.update(step_s, row.sample.bend[i], headings_deg[i], angles_deg[i]);
            segment.bend(step_s, angles_deg[i], row.sample.bend[i][0]);
        }
        if time_s - self.second.0 >= STEP_S {
            self.add_products(&angles_deg);
            self.judge();
            self.second = (time_s, angles_deg);
        }
    }

    fn add_products(&mut self, angles_deg: &[Option<f64>; MAX_SEGMENTS]) {
        let before = self.second.1;
        let steps: [Option<f64>; MAX_SEGMENTS] = array::from_fn(|i| Some(angles_deg[i]? - before[i]?));
        for (products, one) in self.products.iter_mut().zip(steps) {
            for (product, other) in products.iter_mut().zip(steps) {
                *product += one.zip(other).map_or(0.0, |(one, other)| one * other);
            }
        }
    }

    /// Headings by the IMUs from the pose at the begin, degrees.
    fn headings(&mut self, row: &Row) -> [Option<f64>; MAX_SEGMENTS] {
        let is_rest = self.seconds <= REST_S;
        let mut headings_deg = [None; MAX_SEGMENTS];
        for (i, heading) in self.headings.iter_mut().enumerate().take(self.segments.len()) {
            headings_deg[i] = heading.read(row.sample.imu[i].as_ref());
            if let Some(now_deg) = headings_deg[i].filter(|_| is_rest) {
                heading.rest_deg = Some(widened(heading.rest_deg, now_deg));
            }
        }
        headings_deg
    }

    /// What was covered so far.
    #[must_use]
    pub fn report(&self) -> SweepReport {
        let rests = (1..).zip(&self.headings).filter_map(|(segment, heading)| {
            let [low, high] = heading.rest_deg?;
            Some(Rest { segment, turned_deg: high - low })
        });
        let rest = rests.max_by(|a, b| a.turned_deg.total_cmp(&b.turned_deg));
        SweepReport {
            seconds: self.seconds,
            rest: rest.filter(|_| self.seconds > REST_S),
            segments: self.segments.iter().map(Segment::coverage).collect(),
            coupled: self.coupled(),
            faults: self.lasting_faults().collect(),
            goal: SweepGoal::CALIBRATE,
        }
    }

    fn coupled(&self) -> Vec<[usize; 2]> {
        let bends =
            |i: usize| self.segments[i].angle.ends_deg().is_some_and(|[low, high]| high - low > LEAST_RANGE_DEG);
        let n = self.segments.len();
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).filter(|(i, j)| bends(*i) && bends(*j));
        let product = |i: usize, j: usize| self.products[i][j];
        let alike = pairs.filter(|(i, j)| product(*i, *j).powi(2) > COUPLED * product(*i, *i) * product(*j, *j));
        alike.map(|(i, j)| [i + 1, j + 1]).collect()
    }

    /// Judges all sensors.
    fn judge(&mut self) {
        self.segments.iter_mut().for_each(Segment::judge);
        let since = |fault: SweepFault| {
            let known = self.faults.iter().find(|(known, _)| *known == fault);
            known.map_or(self.seconds, |(_, since_s)| *since_s)
        };
        self.faults = self.faults_now().into_iter().map(|fault| (fault, since(fault))).collect();
    }

    fn lasting_faults(&self) -> impl Iterator<Item = SweepFault> {
        let lasting = self.faults.iter().filter(|(_, since_s)| self.seconds - since_s >= HOLDS_S);
        lasting.map(|(fault, _)| *fault)
    }

    fn faults_now(&self) -> Vec<SweepFault> {
        let is_astray = |i: usize| self.segments.get(i).is_some_and(Segment::is_astray);
        let mut faults = Vec::new();
        // The IMU before a segment is why the segment is astray.
        let mut is_explained = false;
        for (i, segment) in self.segments.iter().enumerate() {
            let number = i + 1;
            let is_before = mem::take(&mut is_explained);
            if segment.imu_stays {
                is_explained = true;
                faults.push(SweepFault::ImuStays { segment: number });
            } else if !is_before && !is_astray(i) {
                faults.extend(segment.lost_sensors(number));
            } else if !is_before && is_astray(number) {
                is_explained = true;
                faults.push(SweepFault::ImuUnrelated { segment: number });
            } else if !is_before {
                faults.push(SweepFault::Segment { segment: number });
            }
        }
        faults
    }
}

/// True where a value stays within `least` while another one moves; where that does not move either, as before.
fn stays_while(other_moves: bool, before: bool, value: &RecentRange, least: f64) -> bool {
    value.is_narrower(least) && (before || other_moves)
}

impl Segment {
    fn new() -> Self {
        Self {
            angle: SeenRange::default(),
            now_deg: None,
            passes: Passes::default(),
            passes_of_counts: Passes::default(),
            counts: Default::default(),
            follows: Default::default(),
            is_followed: [None; SENSORS_PER_SEGMENT],
            drift: [DriftFilter::new(); SENSORS_PER_SEGMENT],
            twins: Relation::default(),
            recent_counts: Default::default(),
            stays: [false; SENSORS_PER_SEGMENT],
            recent_angle: RecentRange::default(),
            recent_heading: RecentRange::default(),
            imu_stays: false,
        }
    }

    /// Adds the readings of its sensors, the heading of its end and the bend angle by the IMUs.
    fn update(
        &mut self,
        step_s: f64,
        counts: [Option<u16>; SENSORS_PER_SEGMENT],
        heading_deg: Option<f64>,
        angle_deg: Option<f64>,
    ) {
        for (place, counts) in counts.into_iter().enumerate() {
            let Some(counts) = counts else { continue };
            self.counts[place] = Some(widened(self.counts[place], counts));
            self.recent_counts[place].update(step_s, counts.into());
            if let Some(angle_deg) = angle_deg {
                self.follows[place].update(step_s, counts, angle_deg);
                self.drift[place].update(step_s, counts, angle_deg);
            }
        }
        if let [Some(a), Some(b)] = counts {
            self.twins.update(step_s, a, b.into());
        }
        if let Some(heading_deg) = heading_deg {
            self.recent_heading.update(step_s, heading_deg);
        }
    }

    /// Adds the bend angle, and a reading of sensor a.
    fn bend(&mut self, step_s: f64, angle_deg: Option<f64>, counts: Option<u16>) {
        self.now_deg = angle_deg.map(|angle_deg| angle_deg - self.drift_deg());
        if let Some(angle_deg) = self.now_deg {
            self.recent_angle.update(step_s, angle_deg);
            self.angle.update(step_s, angle_deg);
            self.passes.update(angle_deg, LEAST_RANGE_DEG);
        }
        if let Some(counts) = counts {
            self.passes_of_counts.update(counts.into(), BENDS_COUNTS);
        }
    }

    /// Drift of the bend angle by the first sensor that is not known to follow it badly, degrees; 0 without one.
    fn drift_deg(&self) -> f64 {
        let place = (0..SENSORS_PER_SEGMENT).find(|place| self.is_followed[*place] != Some(false));
        place.map_or(0.0, |place| self.drift[place].drift_deg())
    }

    fn coverage(&self) -> SegmentCoverage {
        SegmentCoverage {
            ends_deg: self.angle.ends_deg(),
            now_deg: self.now_deg,
            seen_deg: self.angle.parts_deg(),
            passes: self.angle.ends_deg().map_or(self.passes_of_counts, |_| self.passes).count,
            counts: self.counts,
        }
    }

    /// Judges whether the bend angle follows each sensor. Between the limits, and at rest, it is as before: swings of other segments
    /// are alike by chance.
    fn judge(&mut self) {
        let bends = self.recent_angle.is_wider(LEAST_RANGE_DEG);
        let turns = self.recent_counts[0].is_wider(TURNS_COUNTS);
        for (counts, stays) in self.recent_counts.iter().zip(&mut self.stays) {
            *stays = stays_while(bends, *stays, counts, DEAD_COUNTS.into());
        }
        self.imu_stays = stays_while(turns, self.imu_stays, &self.recent_heading, STAYS_DEG);
        for (relation, is_followed) in self.follows.iter().zip(&mut self.is_followed) {
            let deviations = relation.value_deviation().zip(relation.counts_deviation());
            let moves = deviations.is_some_and(|(angle, counts)| angle > BENDS_DEG || counts > BENDS_COUNTS);
            match relation.unexplained().filter(|_| moves) {
                Some(unexplained) if unexplained > UNRELATED => *is_followed = Some(false),
                Some(unexplained) if unexplained < GOOD_ENOUGH => *is_followed = Some(true),
                _ => {}
            }
        }
    }

    /// True where both bend sensors agree with each other, and the bend angle by the IMUs with none of them; of a segment with one
    /// sensor, where that moves.
    fn is_astray(&self) -> bool {
        let followed = self.is_followed;
        let is_alone = self.counts[1].is_none();
        let agree = self.twins.unexplained().is_some_and(|unexplained| unexplained < UNRELATED);
        followed[0] == Some(false) && (followed[1] == Some(false) && agree || is_alone && !self.stays[0])
    }

    fn lost_sensors(&self, segment: usize) -> impl Iterator<Item = SweepFault> {
        (0..SENSORS_PER_SEGMENT).filter_map(move |place| {
            if self.stays[place] {
                return Some(SweepFault::BendStays { segment, place });
            }
            (self.is_followed[place] == Some(false)).then_some(SweepFault::BendUnrelated { segment, place })
        })
    }
}

#[cfg(test)]
mod tests;
