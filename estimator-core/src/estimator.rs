//! The pipeline: one [`Sample`] in, one [`Estimate`] out, by all four methods.

use heapless::Vec;
use nalgebra::SVector;

use crate::anchor::{Anchor, Pace, Slot};
use crate::angle::{Angle, Turns};
use crate::filter::{Block, Gains};
use crate::imu::Heading;
use crate::pcc::{Link, Pcc, SegmentShape, chain};
use crate::sample::{ImuReading, SENSORS_PER_SEGMENT, Sample};
use crate::scalar::Scalar;
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
    pace: Pace,
    states: Vec<State<S, W>, N>,
    fused: Shape<S, N>,
}

/// What is remembered of one segment.
#[derive(Debug, Clone)]
struct State<S, const W: usize> {
    heading: Heading<S>,
    anchor: Anchor<W>,
    pcc: Pcc<S>,
    orient: Block<S, 1>,
    coord: Block<S, 2>,
    orient_gains: Gains<S>,
    coord_gains: Gains<S>,
}

/// One tick: what there is to take a sample with.
struct Tick<'a, S, const W: usize> {
    table: &'a Table<'a, S>,
    has_bend_sensors: bool,
    slot: Slot,
    states: &'a mut [State<S, W>],
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
        let mut estimator = Self::unstarted(table);
        estimator.start()?;
        Ok(estimator)
    }

    /// An estimator that knows no segment until it is [started](Self::start): the value of a static, where several
    /// kilobytes are better made in place than moved over a small stack.
    #[must_use]
    pub const fn unstarted(table: &'t Table<'t, S>) -> Self {
        Self { table, has_bend_sensors: false, pace: Pace::new(), states: Vec::new(), fused: Vec::new() }
    }

    /// Begins a session, whatever was before.
    ///
    /// # Errors
    /// As [`Self::new`]; the estimator then knows no segment.
    pub fn start(&mut self) -> Result<(), TableError> {
        let Self { table, .. } = *self;
        self.states.clear();
        self.fused.clear();
        self.pace = Pace::new();
        let window = table.anchor.window;
        if window == 0 || usize::from(window) > W {
            return Err(TableError::Window { found: window, room: W });
        }
        let found = table.segments.len();
        if found == 0 || found > N {
            return Err(TableError::Segments { found, room: N });
        }
        self.has_bend_sensors = table.segments.iter().any(|segment| segment.bend.iter().any(Option::is_some));
        for segment in table.segments {
            let _ = self.states.push(State::new(segment, table.tare_samples)); // There is room: it was checked.
        }
        Ok(())
    }

    /// Takes one sample. The cost is linear in the number of segments and allocates nothing.
    pub fn step(&mut self, sample: &Sample<N>) -> Estimate<S, N> {
        Estimate { time_us: sample.time_us, segments: all(self.parts().1.estimates(sample)) }
    }

    /// Takes one sample as [`Estimator::step`] does and gives the fused shape alone, which costs the board less than both.
    ///
    /// The numbers are those of [`Estimator::shape`] by [`Method::Fusion`], to the bit.
    pub fn fuse(&mut self, sample: &Sample<N>) -> &Shape<S, N> {
        self.parts().1.estimates(sample).for_each(drop);
        // Over the states again, which leaves more of the registers to each of the two.
        let Self { states, fused, .. } = self;
        fused.clear();
        for segment in chain(states.iter().map(|state| state.fused().map(|fused| fused.link))) {
            let _ = fused.push(segment); // There is room for all segments: `new` has checked.
        }
        fused
    }

    /// The arm's shape by `method` at one of this estimator's estimates: bend angles, and the chain of the segments.
    #[must_use]
    pub fn shape(&self, estimate: &Estimate<S, N>, method: Method) -> Shape<S, N> {
        let links = self.states.iter().zip(&estimate.segments).map(|(state, of)| match method {
            Method::Bend => of.bend,
            Method::ImuO => of.imu_o.map(|theta| state.pcc.link(theta)),
            Method::ImuC => of.imu_c,
            Method::Fusion => of.fusion.map(|fused| fused.link),
        });
        all(chain(links))
    }

    /// The room for the fused shape, and what else a tick needs.
    #[inline]
    fn parts(&mut self) -> (&mut Shape<S, N>, Tick<'_, S, W>) {
        let Self { table, has_bend_sensors, pace, states, fused } = self;
        (fused, Tick { table, has_bend_sensors: *has_bend_sensors, slot: pace.tick(&table.anchor), states })
    }
}

impl<'a, S: Scalar, const W: usize> Tick<'a, S, W> {
    /// Takes one sample, segment by segment from the base to the tip.
    #[inline]
    fn estimates<const N: usize>(self, sample: &'a Sample<N>) -> impl Iterator<Item = SegmentEstimate<S>> + 'a {
        let Self { table: Table { segments, anchor: rule, .. }, has_bend_sensors, slot, states } = self;
        let mut before = Tangent { heading: Some(Turns::ZERO), zero: Some(Turns::ZERO) };
        let readings = sample.bend.iter().zip(&sample.imu);
        let segments = segments.iter().zip(states).zip(readings);
        segments.map(move |((segment, state), (counts, imu))| {
            let heading = state.heading.read(imu.and_then(ImuReading::heading));
            let here = Tangent { heading, zero: state.heading.zero() };
            let (theta_bend, bend_sensors_read) = bend_angle(segment, *counts);
            let difference = here.minus(before);
            before = here;

            let raw = difference.heading;
            state.anchor.push(slot, raw.zip(theta_bend).map(|(raw, bend)| raw - bend.to_turns()));
            let theta_imu = raw.zip(difference.zero).map(|(raw, zero)| raw - zero);
            let theta_corrected = theta_imu.filter(|_| has_bend_sensors).map(|theta| {
                let offset = state.anchor.offset().zip(difference.zero).map(|(offset, zero)| offset - zero);
                offset.filter(|offset| offset.exceeds(rule.threshold)).map_or(theta, |o| theta - o)
            });

            let thetas = [theta_bend.map(Angle::from), theta_corrected.map(Angle::from)];
            let [bend, imu_c] = thetas.map(|theta| theta.map(|theta| state.pcc.link(theta)));
            SegmentEstimate {
                bend,
                imu_o: theta_imu.map(Angle::from),
                imu_c,
                fusion: state.fuse(imu_c, bend),
                bend_sensors_read,
                imu_read: heading.is_some(),
            }
        })
    }
}

/// One item a segment, for which there is room: [`Estimator::new`] has checked.
#[inline]
fn all<T, const N: usize>(segments: impl Iterator<Item = T>) -> Vec<T, N> {
    let mut all = Vec::new();
    for segment in segments {
        let _ = all.push(segment);
    }
    all
}

impl Tangent {
    /// Heading and zero of here less those of the segment before; unknown where either is.
    fn minus(self, before: Self) -> Self {
        let minus = |here: Option<Turns>, before: Option<Turns>| here.zip(before).map(|(here, before)| here - before);
        Self { heading: minus(self.heading, before.heading), zero: minus(self.zero, before.zero) }
    }
}

/// θ_bend,i, the mean of the segment's sensors that were read, and their number.
#[inline]
fn bend_angle<S: Scalar>(segment: &Segment<S>, counts: [Option<u16>; SENSORS_PER_SEGMENT]) -> (Option<S>, u8) {
    let mut counts = counts.into_iter();
    let angles = segment.bend.each_ref().map(|map| {
        let counts = counts.next().flatten();
        map.as_ref()?.angle(counts?)
    });
    match angles.into() {
        (Some(a), Some(b)) => (Some((a + b).half()), 2),
        (Some(one), None) | (None, Some(one)) => (Some(one), 1),
        (None, None) => (None, 0),
    }
}

impl<S: Scalar, const W: usize> State<S, W> {
    fn new(segment: &Segment<S>, tare_samples: u32) -> Self {
        Self {
            heading: Heading::new(tare_samples, segment.reference),
            anchor: Anchor::new(),
            pcc: Pcc::new(segment),
            orient: Block::new(),
            coord: Block::new(),
            orient_gains: Gains::new(&segment.orient),
            coord_gains: Gains::new(&segment.coord),
        }
    }

    /// KF_orient and KF_coord of one segment, with the measurements that there are.
    #[inline]
    fn fuse(&mut self, imu_c: Option<Link<S>>, bend: Option<Link<S>>) -> Option<Fused<S>> {
        let imu_c = imu_c.map(|link| self.pcc.within_a_turn(link));
        let theta = |link: Link<S>| SVector::from([link.theta.rest]);
        self.orient.step(&self.orient_gains, imu_c.map(theta), bend.map(theta));
        self.coord.step(&self.coord_gains, imu_c.map(|link| link.end), bend.map(|link| link.end));
        self.fused()
    }

    /// What the filters say now.
    #[inline]
    fn fused(&self) -> Option<Fused<S>> {
        let ((theta, theta_variance), (end, end_variance)) = self.orient.state().zip(self.coord.state())?;
        Some(Fused { link: Link { theta: Angle::from(theta.x), end }, theta_variance, end_variance })
    }
}
