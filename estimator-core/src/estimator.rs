//! The pipeline: one [`Sample`] in, one [`Estimate`] out, by all four methods.

use heapless::Vec;
use nalgebra::{SVector, Vector2};

use crate::anchor::Anchor;
use crate::angle::{Angle, Turns};
use crate::filter::Block;
use crate::imu::Heading;
use crate::pcc::{Link, chain};
use crate::sample::{ImuReading, Sample};
use crate::scalar::{Constant, Scalar};
use crate::table::{Segment, Table, TableError};

/// By what the shape is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Bend sensors alone.
    Bend,
    /// Raw IMUs, drift and all (the paper's IMU_O).
    ImuO,
    /// Drift-corrected IMUs (the paper's IMU_C).
    ImuC,
    /// Kalman-fused.
    Fusion,
}

impl Method {
    /// All methods, in the order of the files' columns.
    pub const ALL: [Self; 4] = [Self::Bend, Self::ImuO, Self::ImuC, Self::Fusion];

    /// The method's name in files: `bend`, `imu_o`, `imu_c`, `fusion`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bend => "bend",
            Self::ImuO => "imu_o",
            Self::ImuC => "imu_c",
            Self::Fusion => "fusion",
        }
    }
}

/// What one sample says of one segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentEstimate<S> {
    /// From the bend sensors that were read.
    pub bend: Option<Link<S>>,
    /// θ_imu,i from the raw IMUs; `None` until the tare is complete.
    pub imu_o: Option<Angle<S>>,
    /// From the drift-corrected IMUs.
    pub imu_c: Option<Link<S>>,
    /// From the filters; `None` before their first measurement.
    pub fusion: Option<Fused<S>>,
    /// How many of the segment's bend sensors were read.
    pub bend_sensors_read: u8,
    /// Whether the segment's IMU gave a heading.
    pub imu_read: bool,
}

/// What the filters say of one segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fused<S> {
    /// θ_i of KF_orient and P_i of KF_coord.
    pub link: Link<S>,
    /// Variance of θ_i, as a ratio to the larger R of KF_orient.
    pub theta_variance: S,
    /// Variance of each of P_i's two coordinates, as a ratio to the larger R of KF_coord.
    pub end_variance: S,
}

/// What one sample says of the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate<S, const N: usize> {
    /// Time of the sample, µs.
    pub time_us: u64,
    /// The segments from the base to the tip.
    pub segments: Vec<SegmentEstimate<S>, N>,
}

/// One segment of the arm's shape by one method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentShape<S> {
    /// Bend angle θ_i.
    pub theta: Option<Angle<S>>,
    /// End of the segment in {W}, m.
    pub end: Option<Vector2<S>>,
}

/// The arm's shape by one method, from the base to the tip.
pub type Shape<S, const N: usize> = Vec<SegmentShape<S>, N>;

/// The state of the pipeline for an arm of up to `N` segments and an anchor of up to `W` values.
///
/// A method that cannot say anything yet, or not of this sample, gives `None`: imu_o and imu_c until the tare is
/// complete, every method but fusion where a reading is missing. A table without any bend sensor has neither anchor nor
/// fusion, and only imu_o speaks. See the [crate's example](crate).
#[derive(Debug, Clone)]
pub struct Estimator<'t, S, const N: usize, const W: usize> {
    table: &'t Table<'t, S>,
    has_bend_sensors: bool,
    states: Vec<State<S, W>, N>,
}

/// What is remembered of one segment.
#[derive(Debug, Clone)]
struct State<S, const W: usize> {
    heading: Heading<S>,
    anchor: Anchor<W>,
    orient: Block<S, 1>,
    coord: Block<S, 2>,
}

/// One IMU in one tick.
#[derive(Clone, Copy)]
struct Tangent {
    /// Unwrapped heading, counted from anywhere.
    heading: Option<Turns>,
    /// What to subtract from it.
    zero: Option<Turns>,
}

impl<'t, S: Scalar, const N: usize, const W: usize> Estimator<'t, S, N, W> {
    /// An estimator at the start of a session.
    ///
    /// # Errors
    /// [`TableError`] where the table has more segments or a longer window than there is room for, or none at all.
    pub fn new(table: &'t Table<'t, S>) -> Result<Self, TableError> {
        let window = table.anchor.window;
        if window == 0 || usize::from(window) > W {
            return Err(TableError::Window { found: window, room: W });
        }
        let mut states = Vec::new();
        for segment in table.segments {
            let state = State {
                heading: Heading::new(table.tare_samples, segment.reference),
                anchor: Anchor::new(),
                orient: Block::new(),
                coord: Block::new(),
            };
            states.push(state).map_err(|_| TableError::Segments { found: table.segments.len(), room: N })?;
        }
        if states.is_empty() {
            return Err(TableError::Segments { found: 0, room: N });
        }
        let has_bend_sensors = table.segments.iter().any(|segment| segment.bend.iter().any(Option::is_some));
        Ok(Self { table, has_bend_sensors, states })
    }

    /// Takes one sample. The cost is linear in the number of segments and allocates nothing.
    pub fn step(&mut self, sample: &Sample<N>) -> Estimate<S, N> {
        let mut before = Tangent { heading: Some(Turns::ZERO), zero: Some(Turns::ZERO) };
        let readings = sample.bend.iter().zip(&sample.imu);
        let mut segments = Vec::new();
        for ((segment, state), (counts, imu)) in self.table.segments.iter().zip(&mut self.states).zip(readings) {
            let heading = state.heading.read(imu.and_then(ImuReading::heading));
            let here = Tangent { heading, zero: state.heading.zero() };
            let (theta_bend, bend_sensors_read) = bend_angle(segment, counts);
            let difference = here.minus(before);
            before = here;

            let raw = difference.heading;
            state.anchor.push(&self.table.anchor, raw.zip(theta_bend).map(|(raw, bend)| raw - bend.to_turns()));
            let theta_imu = raw.zip(difference.zero).map(|(raw, zero)| raw - zero);
            let theta_corrected = theta_imu.filter(|_| self.has_bend_sensors).map(|theta| {
                let offset = state.anchor.offset().zip(difference.zero).map(|(offset, zero)| offset - zero);
                offset.filter(|offset| offset.magnitude() > self.table.anchor.threshold).map_or(theta, |o| theta - o)
            });

            let bend = theta_bend.map(|theta| Link::new(Angle::from(theta), segment));
            let imu_c = theta_corrected.map(|theta| Link::new(Angle::from(theta), segment));
            // There is room for all segments: `new` has checked.
            let _ = segments.push(SegmentEstimate {
                bend,
                imu_o: theta_imu.map(Angle::from),
                imu_c,
                fusion: state.fuse(segment, imu_c, bend),
                bend_sensors_read,
                imu_read: heading.is_some(),
            });
        }
        Estimate { time_us: sample.time_us, segments }
    }

    /// The arm's shape by `method` at one of this estimator's estimates: bend angles, and the chain of the segments.
    #[must_use]
    pub fn shape(&self, estimate: &Estimate<S, N>, method: Method) -> Shape<S, N> {
        let links = self.table.segments.iter().zip(&estimate.segments).map(|(segment, of)| match method {
            Method::Bend => of.bend,
            Method::ImuO => of.imu_o.map(|theta| Link::new(theta, segment)),
            Method::ImuC => of.imu_c,
            Method::Fusion => of.fusion.map(|fused| fused.link),
        });
        let thetas = links.clone().map(|link| link.map(|link| link.theta));
        let mut shape = Vec::new();
        for (theta, end) in thetas.zip(chain(links)) {
            let _ = shape.push(SegmentShape { theta, end }); // There is room for all that the estimate has.
        }
        shape
    }
}

impl Tangent {
    /// Heading and zero of here less those of the segment before; unknown where either is.
    fn minus(self, before: Self) -> Self {
        let minus = |here: Option<Turns>, before: Option<Turns>| here.zip(before).map(|(here, before)| here - before);
        Self { heading: minus(self.heading, before.heading), zero: minus(self.zero, before.zero) }
    }
}

/// θ_bend,i, the mean of the segment's sensors that were read, and their number.
fn bend_angle<S: Scalar>(segment: &Segment<S>, counts: &[Option<u16>]) -> (Option<S>, u8) {
    const HALF: Constant = Constant::new(0.5);
    let maps = segment.bend.iter().zip(counts);
    let mut angles = maps.filter_map(|(map, counts)| map.as_ref()?.angle((*counts)?));
    match (angles.next(), angles.next()) {
        (Some(a), Some(b)) => (Some((a + b) * S::constant(HALF)), 2),
        (one, _) => (one, u8::from(one.is_some())),
    }
}

impl<S: Scalar, const W: usize> State<S, W> {
    /// KF_orient and KF_coord of one segment, with the measurements that there are.
    fn fuse(&mut self, segment: &Segment<S>, imu_c: Option<Link<S>>, bend: Option<Link<S>>) -> Option<Fused<S>> {
        let (orient, coord) = (&segment.orient, &segment.coord);
        // A segment without bend sensors drifts on; whole turns say nothing of its bend, and fixed point ends at 32 rad.
        let imu_c = imu_c.map(|link| match link.theta {
            Angle { turns: 0, .. } => link,
            Angle { rest, .. } => Link::new(Angle::from(rest), segment),
        });
        self.orient.predict(orient.q);
        self.coord.predict(coord.q);
        if let Some(link) = imu_c {
            self.orient.update(SVector::from([link.theta.rest]), orient.h_imu, orient.r_imu);
            self.coord.update(link.end, coord.h_imu, coord.r_imu);
        }
        if let Some(link) = bend {
            self.orient.update(SVector::from([link.theta.rest]), orient.h_bend, orient.r_bend);
            self.coord.update(link.end, coord.h_bend, coord.r_bend);
        }
        let ((theta, theta_variance), (end, end_variance)) = self.orient.state().zip(self.coord.state())?;
        let link = Link { end, ..Link::new(Angle::from(theta.x), segment) };
        Some(Fused { link, theta_variance, end_variance })
    }
}
