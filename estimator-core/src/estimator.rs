//! The pipeline: one [`Sample`] in, one [`Estimate`] or [`Shape`] out.

mod off_reference;

use heapless::Vec;

use crate::config::{ArmConfig, ConfigError, UncertaintyConfig};
use crate::contact::monitor::ContactMonitor;
use crate::drift::bias_filter::BiasFilter;
use crate::drift::bias_trace::BiasTrace;
use crate::drift::correction::{CorrectedArm, DriftCorrection, SensedArm};
use crate::drift::decimator::Decimator;
use crate::drift::moving_average::MovingAverage;
use crate::drift::share::{Share, ShareCounter};
use crate::kinematics::forward::forward_kinematics;
use crate::numeric::angle::Angle;
use crate::numeric::fused::FusedOps;
use crate::numeric::q::Q;
use crate::segment::SegmentState;
use crate::sensing::heading::SegmentHeading;
use crate::types::{
    Condition, Conditions, Contacts, Estimate, Method, Sample, SegmentShape, Shape, Uncertainties, Uncertainty,
};
use crate::uncertainty::ShapeUncertainty;

/// State of the pipeline for an arm of up to `N` segments and an anchor of up to `W` values.
///
/// A method without an estimate for a sample returns `None`: imu_o and imu_c until the tare is complete, every method
/// but fusion where a reading is missing. A table without any bend sensor has imu_o alone, and neither drift correction
/// nor fusion. See the [crate's example](crate).
///
/// `T` is the [trace](BiasTrace) of the bias filter's operations, for a host that smooths a recording; by default there
/// is no trace.
#[derive(Debug, Clone)]
pub struct Estimator<'t, S, const N: usize, const W: usize, T = ()> {
    config: &'t ArmConfig<'t, S>,
    has_bend_sensors: bool,
    decimator: Decimator,
    segments: Vec<SegmentState<S>, N>,
    drift: Drift<N, W, T>,
    contact: ContactMonitor<N>,
    /// Angles of the newest sample; a field, as a local variable would be copied.
    sensed: SensedArm<S, N>,
    /// Corrected angles of the newest sample; for a table without bend sensors all are unknown.
    corrected: CorrectedArm<N>,
    fused: Shape<S, N>,
    uncertainty: ShapeUncertainty<N>,
}

/// Both drift corrections, of which the configuration selects one. Both are allocated, as a static has room for them
/// and a small stack has not. The bias filter uses fixed point for every `S`, so that its decisions do not depend on
/// the number type.
#[derive(Debug, Clone)]
struct Drift<const N: usize, const W: usize, T> {
    moving_average: MovingAverage<N, W>,
    bias_filter: BiasFilter<Q, N, T>,
    has_bias_filter: bool,
    shares: ShareCounter,
}

impl<const N: usize, const W: usize, T: BiasTrace<Q>> Drift<N, W, T> {
    const fn new(trace: T) -> Self {
        let zero = Q::from_bits(0);
        Self {
            moving_average: MovingAverage::new(),
            bias_filter: BiasFilter::new(zero, trace),
            has_bias_filter: false,
            shares: ShareCounter::new(),
        }
    }

    fn start(&mut self, has_bias_filter: bool) {
        self.moving_average.start();
        self.bias_filter.start();
        self.has_bias_filter = has_bias_filter;
        self.shares = ShareCounter::new();
    }

    /// The bias filter, if it corrects the drift.
    fn bias_filter(&self) -> Option<&BiasFilter<Q, N, T>> {
        self.has_bias_filter.then_some(&self.bias_filter)
    }

    fn correct<S: FusedOps>(
        &mut self,
        config: &ArmConfig<S>,
        sensed: &SensedArm<S, N>,
        corrected: &mut CorrectedArm<N>,
    ) {
        if self.has_bias_filter {
            self.bias_filter.correct(config, sensed, corrected);
        } else {
            self.moving_average.correct(config, sensed, corrected);
        }
    }

    /// Ends a sample, after the last use of the covariance.
    fn finish(&mut self, share: Share, segments: usize) {
        if let Share::Row(row) = share {
            self.bias_filter.update_covariance_row();
            if row + 1 >= segments {
                // Rows beyond the arm's number of segments.
                self.bias_filter.finish_covariance();
            }
        }
        let waits = share == Share::Update && self.bias_filter.is_started() && !self.bias_filter.is_updating();
        if !waits {
            self.shares.advance(segments);
        }
    }
}

impl<'t, S: FusedOps, const N: usize, const W: usize> Estimator<'t, S, N, W> {
    /// An estimator at the start of a session.
    ///
    /// # Errors
    /// [`ConfigError`] if the arm has no segment, or more segments or a longer window than `N` and `W`.
    pub fn new(config: &'t ArmConfig<'t, S>) -> Result<Self, ConfigError> {
        Self::with_trace(config, ())
    }

    /// An estimator without segments until it is [started](Self::start): the initial value of a static. Several
    /// kilobytes are then initialised in place, and not moved over a small stack.
    #[must_use]
    pub const fn const_new(config: &'t ArmConfig<'t, S>) -> Self {
        Self::unstarted(config, ())
    }
}

impl<'t, S: FusedOps, const N: usize, const W: usize, T: BiasTrace<Q>> Estimator<'t, S, N, W, T> {
    /// An estimator at the start of a session, with a trace of the bias filter's operations.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_trace(config: &'t ArmConfig<'t, S>, trace: T) -> Result<Self, ConfigError> {
        let mut estimator = Self::unstarted(config, trace);
        estimator.start()?;
        Ok(estimator)
    }

    const fn unstarted(config: &'t ArmConfig<'t, S>, trace: T) -> Self {
        Self {
            config,
            has_bend_sensors: false,
            decimator: Decimator::new(),
            segments: Vec::new(),
            drift: Drift::new(trace),
            contact: ContactMonitor::new(),
            sensed: SensedArm::UNKNOWN,
            corrected: CorrectedArm::UNKNOWN,
            fused: Vec::new(),
            uncertainty: ShapeUncertainty::new(),
        }
    }

    /// The trace of the bias filter's operations.
    pub fn trace_mut(&mut self) -> &mut T {
        self.drift.bias_filter.trace_mut()
    }

    /// Starts a session; clears the state of the one before.
    ///
    /// # Errors
    /// As [`Self::new`]; the estimator then has no segment.
    pub fn start(&mut self) -> Result<(), ConfigError> {
        let config = self.config;
        self.segments.clear();
        self.fused.clear();
        self.decimator = Decimator::new();
        self.contact.start();
        self.corrected = CorrectedArm::UNKNOWN;
        self.sensed = SensedArm::UNKNOWN;
        self.uncertainty = ShapeUncertainty::new();
        let window = config.anchor.window;
        if window == 0 || usize::from(window) > W {
            return Err(ConfigError::Window { found: window, room: W });
        }
        let found = config.segments.len();
        if found == 0 || found > N {
            return Err(ConfigError::Segments { found, room: N });
        }
        self.has_bend_sensors = config.segments.iter().any(|segment| segment.bend.iter().any(Option::is_some));
        self.drift.start(config.bias_filter.is_some());
        for segment in config.segments {
            // The capacity was checked above.
            let _ = self.segments.push(SegmentState::new(segment, config.tare_samples));
            let _ = self.fused.push(SegmentShape { theta: None, end: None });
        }
        Ok(())
    }

    /// Processes one sample; returns the fused shape. Allocates nothing.
    ///
    /// The result equals that of [`Estimator::update_full`] and [`Estimator::shape`] by [`Method::Fusion`] to the bit.
    pub fn update(&mut self, sample: &Sample<N>) -> &Shape<S, N> {
        self.process(sample);
        &self.fused
    }

    /// Processes one sample; returns the estimate by every method.
    pub fn update_full(&mut self, sample: &Sample<N>) -> Estimate<S, N> {
        self.process(sample);
        let sensed = &self.sensed;
        let mut segments = Vec::new();
        let mut below = &SegmentHeading::BASE;
        let angles = sensed.bend.iter().zip(&sensed.headings).zip(self.corrected.imu);
        for (segment, ((bend, heading), imu_c)) in self.segments.iter().zip(angles) {
            let [difference, zero] = heading.relative_to(below);
            below = heading;
            let imu_o = difference.zip(zero).map(|(imu, zero)| Angle::from(imu - zero));
            let _ = segments.push(segment.estimate(bend, imu_o, imu_c)); // `start` has checked the capacity.
        }
        Estimate { time_us: sample.time_us, segments }
    }

    /// The stages, in the order of the data.
    fn process(&mut self, sample: &Sample<N>) {
        self.sense(sample);
        self.drift.correct(self.config, &self.sensed, &mut self.corrected);
        if !self.has_bend_sensors {
            self.corrected = CorrectedArm::UNKNOWN;
        }
        self.fuse();
        self.detect_contact();
        self.update_uncertainty();
        self.drift.finish(self.sensed.share, self.segments.len());
    }

    /// Sensing: counts to bend angles, IMU readings to headings.
    fn sense(&mut self, sample: &Sample<N>) {
        let sensed = &mut self.sensed;
        sensed.time_us = sample.time_us;
        sensed.decimated = self.decimator.advance(&self.config.anchor);
        sensed.share = self.drift.shares.share(&self.config.anchor);
        let rows = sensed.share.rows(N);
        let readings = sample.bend.iter().zip(&sample.imu);
        let angles = sensed.bend.iter_mut().zip(&mut sensed.headings);
        let segments = self.segments.iter_mut().zip(self.config.segments).enumerate();
        for (((i, (segment, config)), (counts, imu)), (bend, heading)) in segments.zip(readings).zip(angles) {
            segment.sense_heading(heading, imu.as_ref());
            segment.sense_bend(bend, config, *counts, sample.time_us, rows.contains(&i));
        }
    }

    /// Fusion, and forward kinematics of the fused links.
    fn fuse(&mut self) {
        let filters = !self.drift.has_bias_filter;
        let angles = self.sensed.bend.iter().zip(&self.corrected.imu).zip(&self.corrected.fused);
        for (segment, ((bend, theta_c), fused)) in self.segments.iter_mut().zip(angles) {
            if filters {
                segment.filter(*theta_c, bend.mean);
            } else {
                segment.bend_to(*fused);
            }
        }
        let links = self.segments.iter().map(SegmentState::fused);
        for (shape, segment) in self.fused.iter_mut().zip(forward_kinematics(links)) {
            *shape = segment;
        }
    }

    fn detect_contact(&mut self) {
        let Some(thresholds) = &self.config.contact else { return };
        let Self { contact, drift, sensed, corrected, .. } = self;
        let condition = |i| drift.bias_filter().map_or(Condition::default(), |filter| filter.condition(i));
        contact.update(self.config, thresholds, self.decimator, sensed.decimated, &corrected.measured, condition);
    }

    /// θ_bend of each segment in the newest sample, from the base to the tip, rad; `None`: no bend sensor was read.
    pub fn bend_angles(&self) -> impl Iterator<Item = Option<S>> {
        self.sensed.bend.iter().take(self.segments.len()).map(|bend| bend.mean)
    }

    /// Contact of each segment, from the base to the tip; empty where the configuration disables detection.
    #[must_use]
    pub fn contacts(&self) -> Contacts<N> {
        match self.config.contact {
            Some(_) => self.contact.contacts(self.config.segments),
            None => Contacts::new(),
        }
    }

    /// Bit mask of the segments in contact, bit 0 for the first segment; cheaper than [`Self::contacts`].
    #[must_use]
    pub fn contact_mask(&self) -> u32 {
        self.contact.contact_mask(self.config.segments)
    }

    /// Conditions of the newest sample, from the base to the tip; with the moving-average anchor all are `false`.
    #[must_use]
    pub fn conditions(&self) -> Conditions<N> {
        let condition = |i| self.drift.bias_filter().map_or(Condition::default(), |filter| filter.condition(i));
        let mut conditions = Vec::new();
        for i in 0..self.segments.len() {
            let _ = conditions.push(condition(i));
        }
        conditions
    }

    /// Uncertainty of the newest fused shape; empty where the configuration has no error sources.
    ///
    /// Above 50 Hz one segment is computed in a sample, so that the result is up to N + 2 samples older than the shape.
    #[must_use]
    pub fn uncertainties(&self) -> Uncertainties<N> {
        let mut uncertainties = Vec::new();
        if self.config.uncertainty.is_some() {
            for (i, shape) in self.fused.iter().enumerate() {
                let newest = self.uncertainty.of(i).copied().unwrap_or(Uncertainty { theta: None, end: None });
                let theta = newest.theta.filter(|_| shape.theta.is_some());
                let end = newest.end.filter(|_| shape.end.is_some());
                let _ = uncertainties.push(Uncertainty { theta, end });
            }
        }
        uncertainties
    }

    /// Variance of each heading that was not read, in addition to that of its bias, rad² times
    /// [`VARIANCE_SCALE`](crate::VARIANCE_SCALE); zero for all others, and with the moving-average anchor.
    #[must_use]
    pub fn absence_variances(&self) -> [Q; N] {
        let mut variances = [Q::from_bits(0); N];
        for (i, variance) in variances.iter_mut().enumerate() {
            *variance = self.absence_variance(i);
        }
        variances
    }

    fn absence_variance(&self, i: usize) -> Q {
        let filter = self.drift.bias_filter().zip(self.config.segments.get(i));
        filter.map_or(Q::from_bits(0), |(filter, config)| filter.absence_variance(&config.bend_error, i))
    }

    /// Computes this sample's share of the uncertainties.
    fn update_uncertainty(&mut self) {
        let Some(sources) = &self.config.uncertainty else { return };
        for i in self.sensed.share.rows(self.segments.len()) {
            self.propagate(sources, i);
        }
    }

    /// Propagates the covariance of the headings over segment `i`.
    fn propagate(&mut self, sources: &UncertaintyConfig, i: usize) {
        let (Some(shape), Some(config)) = (self.fused.get(i), self.config.segments.get(i)) else { return };
        let mut headings = [Q::from_bits(0); N];
        match self.drift.bias_filter() {
            Some(filter) => {
                for (scaled, covariance) in headings.iter_mut().zip(filter.heading_covariances(i)) {
                    *scaled = sources.bias_share * covariance;
                }
            }
            None => headings = self.anchored_covariance(sources, i),
        }
        if let Some(own) = headings.get_mut(i) {
            *own += self.absence_variance(i) + sources.heading;
        }
        let shape = SegmentShape { theta: shape.theta.filter(|_| self.is_measured(i)), end: shape.end };
        self.uncertainty.step(i, config, sources, &shape, &headings);
    }

    fn is_measured(&self, i: usize) -> bool {
        let is_bend_read = || self.sensed.bend.get(i).is_some_and(|bend| bend.mean.is_some());
        let measured = self.corrected.imu.get(i).is_some_and(Option::is_some) || is_bend_read();
        self.drift.bias_filter().map_or(measured, BiasFilter::is_started)
    }

    /// Covariance of heading `i` with the moving-average anchor: the errors of the bend angles are independent, and add
    /// up along the arm.
    fn anchored_covariance(&self, sources: &UncertaintyConfig, i: usize) -> [Q; N] {
        let mask = self.contact_mask();
        let mut sums = [Q::from_f64(0.0); N];
        let mut sum = Q::from_f64(0.0);
        for (j, (total, theta_c)) in sums.iter_mut().zip(&self.corrected.imu).enumerate() {
            if j <= i {
                sum += if theta_c.is_some() { sources.theta } else { sources.bend };
                if mask >> j & 1 != 0 {
                    sum += sources.contact;
                }
            }
            *total = sum;
        }
        sums
    }

    /// Shape of the arm by `method` at one of this estimator's estimates: bend angles, and forward kinematics.
    #[must_use]
    pub fn shape(&self, estimate: &Estimate<S, N>, method: Method) -> Shape<S, N> {
        let links = self.segments.iter().zip(&estimate.segments).map(|(segment, of)| match method {
            Method::Bend => of.bend,
            Method::ImuO => of.imu_o.map(|theta| segment.link(theta)),
            Method::ImuC => of.imu_c,
            Method::Fusion => of.fusion,
        });
        let mut shape = Vec::new();
        for segment in forward_kinematics(links) {
            let _ = shape.push(segment); // `start` has checked the capacity.
        }
        shape
    }
}
