//! The pipeline: one [`Sample`] in, one [`Estimate`] out, by all four methods.

use core::ops::Range;

use heapless::Vec;
use nalgebra::Vector2;

use crate::anchor::Pace;
use crate::angle::Angle;
use crate::beyond::{Beyond, Seen};
use crate::contact::{Contact, ContactRule, Contacts};
use crate::imu::Tangent;
use crate::pcc::{Link, SegmentShape, chain};
use crate::sample::{ImuReading, Sample};
use crate::scalar::Scalar;
use crate::state::{State, Thetas, bend_angle};
use crate::table::{Segment, Table, TableError};
use crate::uncertainty::{Sources, Spread, Uncertainties, Uncertainty};

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
    is_beyond_the_paper: bool,
    pace: Pace,
    has_value: bool,
    states: Vec<State<S, W>, N>,
    fused: Shape<S, N>,
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
        Self {
            table,
            has_bend_sensors: false,
            is_beyond_the_paper: false,
            pace: Pace::new(),
            has_value: false,
            states: Vec::new(),
            fused: Vec::new(),
        }
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
        self.has_value = false;
        let window = table.anchor.window;
        if window == 0 || usize::from(window) > W {
            return Err(TableError::Window { found: window, room: W });
        }
        let found = table.segments.len();
        if found == 0 || found > N {
            return Err(TableError::Segments { found, room: N });
        }
        self.has_bend_sensors = table.segments.iter().any(|segment| segment.bend.iter().any(Option::is_some));
        self.is_beyond_the_paper = table.is_beyond_the_paper();
        for (place, segment) in table.segments.iter().enumerate() {
            // There is room: it was checked.
            let _ = self.states.push(State::new(place, segment, table));
            let _ = self.fused.push(SegmentShape { theta: None, end: None });
        }
        Ok(())
    }

    /// Takes one sample. The cost is linear in the number of segments and allocates nothing.
    pub fn step(&mut self, sample: &Sample<N>) -> Estimate<S, N> {
        let mut segments = Vec::new();
        self.take(sample, |state, thetas| {
            let _ = segments.push(state.estimate(&thetas)); // There is room: `start` has checked.
        });
        self.chain_fused();
        Estimate { time_us: sample.time_us, segments }
    }

    /// Takes one sample as [`Estimator::step`] does and gives the fused shape alone, which costs the board less than both.
    ///
    /// The numbers are those of [`Estimator::shape`] by [`Method::Fusion`], to the bit.
    #[inline(never)]
    pub fn fuse(&mut self, sample: &Sample<N>) -> &Shape<S, N> {
        self.take(sample, |_, _| ());
        // Over the states again, which leaves more of the registers to each of the two.
        self.chain_fused();
        &self.fused
    }

    #[inline]
    fn chain_fused(&mut self) {
        let Self { states, fused, .. } = self;
        let links = states.iter().map(|state| state.fused().map(|fused| fused.link));
        for (segment, shape) in fused.iter_mut().zip(chain(links)) {
            *segment = shape;
        }
    }

    #[inline]
    fn take(&mut self, sample: &Sample<N>, then: impl FnMut(&State<S, W>, Thetas<S>)) {
        // Two copies of one function, so that the paper's method does not pay for what goes beyond it.
        if self.is_beyond_the_paper {
            self.take_by::<true>(sample, then);
        } else {
            self.take_by::<false>(sample, then);
        }
    }

    /// Takes one sample, segment by segment from the base to the tip, and tells `then` of each.
    #[inline]
    fn take_by<const BEYOND: bool>(&mut self, sample: &Sample<N>, mut then: impl FnMut(&State<S, W>, Thetas<S>)) {
        let Self { table, has_bend_sensors, pace, has_value, states, .. } = self;
        let Table { anchor: rule, .. } = table;
        let has_bend_sensors = *has_bend_sensors;
        let slot = pace.tick(rule);
        *has_value |= BEYOND && slot.is_complete();
        let phases = if BEYOND && *has_value { pace.phases(rule, slot) } else { 0..0 };
        let mut before = &Tangent::BASE;
        let readings = sample.bend.iter().zip(&sample.imu);
        for (state, (counts, imu)) in states.iter_mut().zip(readings) {
            let imu_read = state.heading.read(imu.as_ref().and_then(ImuReading::heading)).is_some();
            let (bend, bend_sensors_read) = bend_angle(&state.maps, *counts);
            let bend = if BEYOND { bend.map(|theta| state.beyond.memory.correct(theta)) } else { bend };
            let [difference, zero] = state.heading.tangent().minus(before);
            let imu_o = difference.zip(zero).map(|(imu, zero)| Angle::from(imu - zero));
            let imu_c = if BEYOND {
                let theta_c = state.corrected(table, slot, &phases, [difference, zero], bend.map(S::to_turns));
                theta_c.filter(|_| has_bend_sensors).map(Angle::<S>::from)
            } else {
                state.anchor.push(slot, difference.zip(bend).map(|(imu, bend)| imu - bend.to_turns()));
                difference
                    .zip(zero)
                    .filter(|_| has_bend_sensors)
                    .map(|(imu, zero)| Angle::<S>::from(imu - state.anchor.zero(rule, zero)))
            };
            state.fuse(imu_c.map(|theta| theta.rest), bend);
            if BEYOND {
                state.beyond.seen = Seen { imu: imu_c.is_some(), bend: bend.is_some() };
            }
            let state = &*state;
            before = state.heading.tangent();
            then(state, Thetas { bend, imu_o, imu_c, bend_sensors_read, imu_read });
        }
        if BEYOND && let Some(rule) = &table.contact {
            compare(rule, &phases, table.segments, states);
        }
    }

    /// Whether something touches the segments, from the base to the tip; nothing where the table does not say how to tell.
    #[must_use]
    pub fn contacts(&self) -> Contacts<N> {
        let Self { table, states, .. } = self;
        let touched = self.touched();
        let count = if table.contact.is_some() { states.len() } else { 0 };
        let mut contacts: Contacts<N> =
            all((0..count).map(|i| Contact { score_percent: 0, is_touched: touched >> i & 1 != 0 }));
        for (i, (state, segment)) in states.iter().zip(table.segments).enumerate() {
            let [bend, alike] = [state.beyond.touch.bend(), state.beyond.touch.alike()].map(|of| of.score_percent);
            let other = segment.alike.map(|alike| usize::from(alike.segment));
            for (place, score) in [(Some(i), bend.max(alike)), (other, alike)] {
                if let Some(contact) = place.and_then(|place| contacts.get_mut(place)) {
                    contact.score_percent = contact.score_percent.max(score);
                }
            }
        }
        contacts
    }

    /// A bit for each segment that something touches, the first in the lowest place: less work than [`Self::contacts`].
    #[must_use]
    pub fn touched(&self) -> u32 {
        let Self { table, states, .. } = self;
        let mut touched = 0;
        for (i, (state, segment)) in states.iter().zip(table.segments).enumerate() {
            let Beyond { touch, .. } = &state.beyond;
            touched |= u32::from(touch.bend().is_touched) << i;
            if touch.alike().is_touched {
                let other = segment.alike.map_or(0, |alike| 1_u32.wrapping_shl(alike.segment.into()));
                touched |= 1 << i | other;
            }
        }
        touched
    }

    /// How far the fused shape of the newest sample may be off; empty where the table does not say what errors come from.
    #[must_use]
    pub fn uncertainties(&self) -> Uncertainties<S, N> {
        let Self { table, states, fused, .. } = self;
        let Some(rule) = &table.uncertainty else { return Vec::new() };
        let touched = self.touched();
        let mut spread = Spread::base(rule.heading, rule.end);
        let (mut before, mut is_known) = (Vector2::zeros(), true);
        // The base's heading has no error.
        let mut headings = rule.heading;
        let mut uncertainties = Vec::new();
        for (i, (state, shape)) in states.iter().zip(fused).enumerate() {
            let Beyond { observer, seen, lever, .. } = &state.beyond;
            let sources = Sources { seen: *seen, drift: observer.variance(), is_touched: touched >> i & 1 != 0 };
            let theta = rule.theta(&sources);
            let end = theta.zip(shape.end).filter(|_| is_known).map(|(theta, end)| {
                spread.step(end - before, *lever, theta);
                before = end;
                spread.end()
            });
            is_known = end.is_some();
            let _ = uncertainties.push(Uncertainty { theta: theta.map(|theta| theta + headings), end });
            headings = rule.heading + rule.heading;
        }
        uncertainties
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

/// Tells contact by the segments that bend alike: of each at its turn, which comes after that of the other.
#[inline(never)]
fn compare<S: Scalar, const W: usize>(
    rule: &ContactRule,
    phases: &Range<u32>,
    segments: &[Segment<S>],
    states: &mut [State<S, W>],
) {
    for (i, segment) in segments.iter().enumerate() {
        if !states.get(i).is_some_and(|state| state.beyond.is_due(phases)) {
            continue;
        }
        let Some(alike) = segment.alike else { continue };
        let there = states.get(usize::from(alike.segment)).and_then(|state| state.beyond.touch.theta);
        let Some(State { beyond, .. }) = states.get_mut(i) else { continue };
        let difference = beyond.touch.theta.zip(there).map(|(here, there)| alike.difference(here, there));
        beyond.touch.compare(rule, difference);
    }
}
