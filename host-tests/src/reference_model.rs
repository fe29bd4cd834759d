//! The method's equations as they are printed: whole sessions at once, std's floats, two moving averages, dense filters.
//!
//! It shares nothing with `estimator-core`, so that an error stays undetected only if it is made twice, in two ways.

mod dense;

use dense::{Filter, Matrix};
use std::f64::consts::PI;

/// Quadratic V–Orient map of one bend sensor: θ = c2 V² + c1 V + c0, rad.
#[derive(Debug, Clone, Copy)]
pub struct Sensor {
    /// rad/V².
    pub c2: f64,
    /// rad/V.
    pub c1: f64,
    /// rad.
    pub c0: f64,
}

/// Parameters of one filter block, in the table's units.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    /// Process noise per second.
    pub q: f64,
    /// Variance of the drift-corrected IMU's measurement.
    pub r_imu: f64,
    /// Variance of the bend sensors' measurement.
    pub r_bend: f64,
    /// H of the drift-corrected IMU.
    pub h_imu: f64,
    /// H of the bend sensors.
    pub h_bend: f64,
}

/// One segment of the arm.
#[derive(Debug, Clone)]
pub struct Segment {
    /// L_act, m.
    pub length: f64,
    /// d_off, m.
    pub offset: f64,
    /// True if the connector follows the curve; else it precedes it.
    pub offset_at_end: bool,
    /// No, one or two sensors.
    pub bend: Vec<Sensor>,
    /// Heading of the segment's end in the reference pose, rad.
    pub reference: f64,
    /// KF_orient.
    pub orient: Noise,
    /// KF_coord.
    pub coord: Noise,
}

/// An arm's table and the rate of its samples.
#[derive(Debug, Clone)]
pub struct Arm {
    /// From the base to the tip.
    pub segments: Vec<Segment>,
    /// Sample rate, Hz.
    pub rate: f64,
    /// Length of the tare, s.
    pub tare_seconds: f64,
    /// The anchor's window, in values of its own rate.
    pub window: usize,
    /// The anchor's threshold, rad.
    pub threshold: f64,
    /// The anchor's rate, Hz.
    pub anchor_rate: f64,
}

/// One row of a session.
#[derive(Debug, Clone, Default)]
pub struct Row {
    /// Heading of each segment's IMU, rad, clockwise positive, of any whole turns.
    pub headings: Vec<Option<f64>>,
    /// Counts of each segment's bend sensors.
    pub counts: Vec<[Option<u16>; 2]>,
}

/// One method's answer to one row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shape {
    /// θ_i, rad.
    pub theta: Vec<Option<f64>>,
    /// Ends of the segments in {W}, m.
    pub end: Vec<Option<[f64; 2]>>,
}

/// All answers to one row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Answer {
    /// Bend sensors alone.
    pub bend: Shape,
    /// Raw IMUs.
    pub imu_o: Shape,
    /// Drift-corrected IMUs.
    pub imu_c: Shape,
    /// Kalman-fused.
    pub fusion: Shape,
    /// The anchor's offset of each segment, rad.
    pub offsets: Vec<Option<f64>>,
}

/// A value per row and segment, unknown where it is `None`.
type Rows = Vec<Vec<Option<f64>>>;

/// Answers of the equations to all rows of a session.
pub fn replay(arm: &Arm, rows: &[Row]) -> Vec<Answer> {
    let bend = bend_angles(arm, rows);
    let imu = imu_angles(arm, rows);
    let offsets = offsets(arm, &imu, &bend);
    let tare = tare_rows(arm);
    let with_bend = arm.segments.iter().any(|segment| !segment.bend.is_empty());
    let mut filters: Vec<_> = arm.segments.iter().map(|segment| Fusion::new(segment, arm.rate)).collect();
    let unknown = vec![None; arm.segments.len()];
    (0..rows.len())
        .map(|t| {
            let imu_o = if t + 1 < tare { unknown.clone() } else { imu[t].clone() };
            if !with_bend {
                let shape = || pcc_shape(arm, unknown.clone());
                let imu_o = pcc_shape(arm, imu_o);
                return Answer { bend: shape(), imu_o, imu_c: shape(), fusion: shape(), offsets: unknown.clone() };
            }
            let corrected = |(theta, offset): (&Option<f64>, &Option<f64>)| match offset {
                Some(offset) if offset.abs() > arm.threshold => theta.map(|theta| theta - offset),
                _ => *theta,
            };
            let imu_c: Vec<_> = imu_o.iter().zip(&offsets[t]).map(corrected).collect();
            let fused = filters.iter_mut().zip(&imu_c).zip(&bend[t]);
            let fused: Vec<_> = fused.map(|((filter, &imu_c), &bend)| filter.step(imu_c, bend)).collect();
            Answer {
                bend: pcc_shape(arm, bend[t].clone()),
                imu_o: pcc_shape(arm, imu_o),
                imu_c: pcc_shape(arm, imu_c),
                fusion: Shape {
                    end: world(&fused),
                    theta: fused.iter().map(|link| link.map(|(theta, _)| theta)).collect(),
                },
                offsets: offsets[t].clone(),
            }
        })
        .collect()
}

/// Rows of the tare.
fn tare_rows(arm: &Arm) -> usize {
    (arm.rate * arm.tare_seconds).round() as usize
}

/// Angles by the V–Orient maps: mean of the sensors that were read.
fn bend_angles(arm: &Arm, rows: &[Row]) -> Rows {
    let angle = |sensor: &Sensor, counts: u16| {
        let volts = f64::from(counts) * 3.3 / 4095.0;
        sensor.c2 * volts.powi(2) + sensor.c1 * volts + sensor.c0
    };
    let of_row = |row: &Row| {
        let segments = arm.segments.iter().zip(&row.counts);
        segments
            .map(|(segment, counts)| {
                let read =
                    segment.bend.iter().zip(counts).filter_map(|(sensor, counts)| Some(angle(sensor, (*counts)?)));
                mean(&read.collect::<Vec<_>>())
            })
            .collect()
    };
    rows.iter().map(of_row).collect()
}

/// θ_imu,i = h_i − h_{i−1}, from row 0 on, as if the tare had been known from the start.
fn imu_angles(arm: &Arm, rows: &[Row]) -> Rows {
    let mut angles = vec![Vec::new(); rows.len()];
    let mut before = vec![Some(0.0); rows.len()];
    for (i, segment) in arm.segments.iter().enumerate() {
        let raw: Vec<_> = rows.iter().map(|row| row.headings[i]).collect();
        let headings = world_headings(&raw, tare_rows(arm), segment.reference);
        for t in 0..rows.len() {
            angles[t].push(headings[t].zip(before[t]).map(|(here, before)| here - before));
        }
        before = headings;
    }
    angles
}

/// One IMU's headings, unwrapped and less their tare.
fn world_headings(raw: &[Option<f64>], tare: usize, reference: f64) -> Vec<Option<f64>> {
    let Some(first) = raw.iter().flatten().next().copied() else { return raw.to_vec() };
    let start = if tare == 0 {
        wrapped(first)
    } else {
        let read: Vec<_> = raw.iter().take(tare).flatten().copied().collect();
        let (sines, cosines): (Vec<_>, Vec<_>) = read.iter().map(|heading| heading.sin_cos()).unzip();
        let Some((sin, cos)) = mean(&sines).zip(mean(&cosines)) else { return vec![None; raw.len()] };
        wrapped(first - sin.atan2(cos)) + reference
    };
    let mut newest = (first, start);
    let unwrap = |heading: f64| {
        newest = (heading, newest.1 + wrapped(heading - newest.0));
        newest.1
    };
    let mut unwrap = unwrap;
    raw.iter().map(|heading| heading.map(&mut unwrap)).collect()
}

/// MA(θ_imu) − MA(θ_bend) of each row and segment.
fn offsets(arm: &Arm, imu: &Rows, bend: &Rows) -> Rows {
    // Value k of the window ends with the first row by whose end k periods of the anchor's rate have passed.
    let values_by = |rows: usize| (rows as f64 * (arm.anchor_rate / arm.rate).min(1.0) + 1e-9).floor() as usize;
    let mut begun = 0;
    let mut newest: Vec<Option<f64>> = vec![None; arm.segments.len()];
    let mut slots: Vec<Vec<Option<(f64, f64)>>> = vec![Vec::new(); arm.segments.len()];
    let mut offsets = Vec::new();
    for t in 0..imu.len() {
        if values_by(t + 1) > values_by(t) {
            for i in 0..arm.segments.len() {
                let rows = begun..=t;
                slots[i].push(means(&rows.map(|t| imu[t][i].zip(bend[t][i])).collect::<Vec<_>>()));
                let window = slots[i].len().saturating_sub(arm.window);
                newest[i] = means(&slots[i][window..]).map(|(imu, bend)| imu - bend).or(newest[i]);
            }
            begun = t + 1;
        }
        offsets.push(newest.clone());
    }
    offsets
}

/// Both averages over the pairs that are there.
fn means(pairs: &[Option<(f64, f64)>]) -> Option<(f64, f64)> {
    let (imu, bend): (Vec<_>, Vec<_>) = pairs.iter().flatten().copied().unzip();
    mean(&imu).zip(mean(&bend))
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The same direction within ±π.
fn wrapped(angle: f64) -> f64 {
    angle - 2.0 * PI * (angle / (2.0 * PI)).round()
}

/// P_i = C_i + D_i of a segment bent by `theta`.
pub fn pcc(segment: &Segment, theta: f64) -> [f64; 2] {
    let (lateral, axial) = if theta.abs() < 1e-4 {
        (theta / 2.0 - theta.powi(3) / 24.0, 1.0 - theta.powi(2) / 6.0)
    } else {
        ((1.0 - theta.cos()) / theta, theta.sin() / theta)
    };
    let connector = if segment.offset_at_end { [theta.sin(), theta.cos()] } else { [0.0, 1.0] };
    [segment.length * lateral + segment.offset * connector[0], segment.length * axial + segment.offset * connector[1]]
}

fn pcc_shape(arm: &Arm, theta: Vec<Option<f64>>) -> Shape {
    let link = |(segment, theta): (&Segment, &Option<f64>)| theta.map(|theta| (theta, pcc(segment, theta)));
    let links: Vec<_> = arm.segments.iter().zip(&theta).map(link).collect();
    Shape { end: world(&links), theta }
}

/// P_W,i = P_W,i−1 + R(Θ_{i−1}) P_i, up to the first segment without an estimate.
fn world(links: &[Option<(f64, [f64; 2])>]) -> Vec<Option<[f64; 2]>> {
    let mut at = Some((0.0, [0.0, 0.0]));
    links
        .iter()
        .map(|link| {
            at = at.zip(*link).map(|((heading, [x, y]), (theta, [px, py]))| {
                let (sin, cos) = f64::sin_cos(heading);
                (heading + theta, [x + px * cos + py * sin, y - px * sin + py * cos])
            });
            at.map(|(_, end)| end)
        })
        .collect()
}

/// KF_orient and KF_coord of one segment.
struct Fusion<'a> {
    segment: &'a Segment,
    rate: f64,
    orient: Option<Filter>,
    coord: Option<Filter>,
}

impl<'a> Fusion<'a> {
    fn new(segment: &'a Segment, rate: f64) -> Self {
        Self { segment, rate, orient: None, coord: None }
    }

    /// θ_i and P_i, fused; `None` before the first measurement.
    fn step(&mut self, imu: Option<f64>, bend: Option<f64>) -> Option<(f64, [f64; 2])> {
        let Segment { orient, coord, .. } = *self.segment;
        // Whole turns are drift, not bending.
        let imu = imu.map(wrapped);
        let point = |theta: Option<f64>| theta.map(|theta| pcc(self.segment, theta).to_vec());
        let (imu_point, bend_point) = (point(imu), point(bend));
        measure(&mut self.orient, self.rate, &orient, imu.map(|theta| vec![theta]), bend.map(|theta| vec![theta]));
        measure(&mut self.coord, self.rate, &coord, imu_point, bend_point);
        let end = &self.coord.as_ref()?.x;
        Some((self.orient.as_ref()?.x.at(0, 0), [end.at(0, 0), end.at(1, 0)]))
    }
}

/// One step of a filter with the measurements that there are, stacked.
fn measure(filter: &mut Option<Filter>, rate: f64, noise: &Noise, imu: Option<Vec<f64>>, bend: Option<Vec<f64>>) {
    /// Largest covariance, in units of the larger R.
    const LIMIT: f64 = 16.0;
    let stacked = [(imu, noise.h_imu, noise.r_imu), (bend, noise.h_bend, noise.r_bend)];
    let (mut z, mut h, mut r) = (Vec::new(), Vec::new(), Vec::new());
    for (measured, gain, variance) in stacked {
        for (axis, value) in measured.iter().flatten().enumerate() {
            z.push(*value);
            h.push((axis, gain));
            r.push(variance);
        }
    }
    let states = match filter {
        Some(filter) => filter.x.rows(),
        None => h.iter().map(|(axis, _)| axis + 1).max().unwrap_or(0),
    };
    let z = Matrix::new(z.len(), 1, |i, _| z[i]);
    let h = Matrix::new(h.len(), states, |i, j| if h[i].0 == j { h[i].1 } else { 0.0 });
    let r = Matrix::new(r.len(), r.len(), |i, j| if i == j { r[i] } else { 0.0 });
    match filter {
        Some(filter) => {
            filter.predict(noise.q / rate, LIMIT * noise.r_imu.max(noise.r_bend));
            filter.update(&z, &h, &r);
        }
        None if z.rows() > 0 => *filter = Some(Filter::start(&z, &h, &r)),
        None => {}
    }
}
