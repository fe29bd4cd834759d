//! The estimator's step between two calls that a debugger can stop at, `step_begins` and `step_ends`.

use crate::random::Random;
use atsam3x8e_hal::pac::Peripherals;
use atsam3x8e_hal::watchdog;
use estimator_core::{
    AnchorConfig, Angle, ArmConfig, BendErrorConfig, BendMap, BendSensorConfig, BiasFilterConfig, ContactConfig,
    CoupledSegment, CurveMap, Estimator, ImuReading, KNOTS, KalmanParams, Lag, MemoryConfig, OffsetAt, Phase, Play, Q,
    QuadraticMap, SENSORS_PER_SEGMENT, Sample, Scalar, SegmentConfig, TIME_UNIT_S, Turns, UncertaintyConfig, UnitArc,
};

/// Samples of each arm that moves, those of the tare included.
const STEPS: u32 = 1_000;
/// Samples of the arm that stops: after 20 s of rest the bias filter updates from it.
const STEPS_WITH_REST: u32 = STEPS + 3_000;
const TARE: u32 = 100;
const SAMPLE_US: u64 = 10_000;
const WINDOW: usize = 100;

const CENTER: u16 = 2_048;
/// A sensor bends by 2.2 rad over 2¹⁰ counts.
const RANGE: u8 = 10;
const RAD_PER_RANGE: f64 = 2.2;

const SENSOR: BendSensorConfig<Q> = BendSensorConfig {
    map: BendMap::Quadratic(QuadraticMap {
        center: CENTER,
        shift: RANGE,
        coefficients: [Q::from_f64(0.01), Q::from_f64(RAD_PER_RANGE), Q::from_f64(0.03)],
        readable: [0, 4095],
    }),
    memory: None,
};

const FILTER: KalmanParams<Q> = KalmanParams {
    q: Q::from_f64(0.01),
    r_imu: Q::from_f64(1.0),
    r_bend: Q::from_f64(0.4),
    h_imu: Q::from_f64(1.0),
    h_bend: Q::from_f64(1.02),
};

const SEGMENT: SegmentConfig<Q> = SegmentConfig {
    length: Q::from_f64(0.080),
    offset: Q::from_f64(0.017),
    offset_at: OffsetAt::End,
    bend: [Some(SENSOR); SENSORS_PER_SEGMENT],
    hysteresis: None,
    bend_error: BendErrorConfig::PAPER,
    imu_scale_error: 0,
    coupled_to: None,
    contact: None,
    reference: Turns::ZERO,
    orient: FILTER,
    coord: FILTER,
};

static SEGMENTS: [SegmentConfig<Q>; 8] = [SEGMENT; 8];

const fn table(segments: usize) -> ArmConfig<'static, Q> {
    let anchor = AnchorConfig {
        window: WINDOW as u16,
        rate_millihertz: 10_000,
        sample_rate_millihertz: 100_000,
        threshold: Turns::from_bits(5_965_232),
    };
    ArmConfig { tare_samples: TARE, anchor, ..ArmConfig::uncalibrated(SEGMENTS.split_at(segments).0) }
}

/// Half a degree a play, and a tenth of it in the correction.
const PLAY: Play<Q> = Play { radius: Q::from_f64(0.01), weight: Q::from_f64(0.1) };

/// A lag of a minute.
const LAG: Lag<Q> =
    Lag { time: Q::from_f64(60.0 / TIME_UNIT_S), rate: Q::from_f64(TIME_UNIT_S / 60.0), weight: Q::from_f64(0.05) };

/// The quadratic's slope as a curve, with creep and hysteresis of the sensor.
const CURVE_SENSOR: BendSensorConfig<Q> = {
    // Knots every 2⁵ counts: 64 spans over 2 ranges.
    let mut knots = [Q::from_f64(0.0); KNOTS];
    let mut k = 0;
    while k < KNOTS {
        knots[k] = Q::from_f64((k as f64 / 32.0 - 1.0) * RAD_PER_RANGE);
        k += 1;
    }
    let (first, last) = (CENTER - (1 << RANGE), CENTER + (1 << RANGE) - 1);
    let range = [first, last];
    let curve = CurveMap { first, shift: RANGE - 5, knots, readable: range, calibrated: range };
    BendSensorConfig { map: BendMap::Curve(curve), memory: Some(MemoryConfig { lags: [LAG; 2], plays: [PLAY; 2] }) }
};

/// Segments with everything that a table can have in addition to the paper's method.
static BIAS_FILTER_SEGMENTS: [SegmentConfig<Q>; 8] = {
    let first = SegmentConfig {
        bend: [Some(CURVE_SENSOR); SENSORS_PER_SEGMENT],
        hysteresis: Some([PLAY; 3]),
        // 1 %.
        imu_scale_error: 42_949_673,
        ..SEGMENT
    };
    let second = SegmentConfig { coupled_to: Some(CoupledSegment { segment: 0, ratio: 1 << 28 }), ..first };
    let fourth = SegmentConfig { coupled_to: Some(CoupledSegment { segment: 2, ratio: 1 << 28 }), ..first };
    let sixth = SegmentConfig { coupled_to: Some(CoupledSegment { segment: 4, ratio: 1 << 28 }), ..first };
    let eighth = SegmentConfig { coupled_to: Some(CoupledSegment { segment: 6, ratio: 1 << 28 }), ..first };
    [first, second, first, fourth, first, sixth, first, eighth]
};

const fn degrees(degrees: i64) -> Turns {
    Turns::from_bits((degrees << 32) / 360)
}

const fn bias_filter_table(segments: usize) -> ArmConfig<'static, Q> {
    ArmConfig {
        segments: BIAS_FILTER_SEGMENTS.split_at(segments).0,
        bias_filter: Some(BiasFilterConfig::BNO055),
        contact: Some(ContactConfig { bend: degrees(5), coupling: degrees(4) }),
        uncertainty: Some(UncertaintyConfig {
            theta: Q::from_f64(0.001),
            bias_share: Q::from_f64(0.5),
            bend: Q::from_f64(0.2),
            contact: Q::from_f64(0.1),
            heading: Q::from_f64(0.007),
            end: Q::from_f64(6.4e-5),
        }),
        ..table(segments)
    }
}

/// Tables of 6 and 8 segments with the bias filter, contact and uncertainty.
pub static BIAS_FILTER_TABLES: [ArmConfig<'static, Q>; 2] = [bias_filter_table(6), bias_filter_table(8)];

/// Tables of 1, 2, 6 and 8 segments.
pub static TABLES: [ArmConfig<'static, Q>; 4] = [table(1), table(2), table(6), table(8)];

/// The estimator of an arm of up to `N` segments.
pub type TestedEstimator<const N: usize> = Estimator<'static, Q, N, WINDOW>;

/// All steps of one arm.
#[inline(never)]
pub fn steps<const N: usize>(estimator: &mut TestedEstimator<N>) {
    run(estimator, STEPS, |estimator, sample| {
        core::hint::black_box(estimator.update(sample));
    });
}

/// All steps of one arm, at rest at last, each with the covariances of its shape, which the board reads four times a second
/// for a message of its own.
#[inline(never)]
pub fn steps_with_uncertainty<const N: usize>(estimator: &mut TestedEstimator<N>) {
    // As in the firmware, the step does not know where the estimator is.
    let estimator = core::hint::black_box(estimator);
    run(estimator, STEPS_WITH_REST, |estimator, sample| {
        core::hint::black_box(estimator.update(sample));
    });
    core::hint::black_box(&estimator.uncertainties());
}

/// Runs this and nothing else, without a watchdog.
pub fn alone(run: impl FnOnce()) -> ! {
    if let Some(device) = Peripherals::take() {
        watchdog::disable(device.WDT);
    }
    run();
    loop {
        cortex_m::asm::wfi();
    }
}

#[inline]
fn run<const N: usize>(
    estimator: &mut TestedEstimator<N>,
    steps: u32,
    step: impl Fn(&mut TestedEstimator<N>, &Sample<N>),
) {
    if estimator.start().is_err() {
        return;
    }
    let mut arm = Arm::<N>::new();
    for k in 0..steps {
        let sample = arm.sample(u64::from(k) * SAMPLE_US, k < STEPS);
        step_begins((&raw const sample).cast());
        step(estimator, &sample);
        step_ends();
    }
}

/// The next instruction after its return is the step's first.
#[inline(never)]
#[unsafe(no_mangle)]
extern "C" fn step_begins(sample: *const u8) {
    core::hint::black_box(sample);
}

/// The instruction before its call was the step's last.
#[inline(never)]
#[unsafe(no_mangle)]
extern "C" fn step_ends() {
    core::hint::black_box(());
}

/// An arm whose segments each bend at random, slowly enough for its headings to be followed.
struct Arm<const N: usize> {
    random: Random,
    angles: [Phase; N],
}

impl<const N: usize> Arm<N> {
    fn new() -> Self {
        Self { random: Random::new(0x1234_5678), angles: [Phase::from_bits(0); N] }
    }

    /// The sample at `time_us`, in which every reading is present.
    fn sample(&mut self, time_us: u64, is_moving: bool) -> Sample<N> {
        let mut sample = Sample::missing(time_us);
        let mut heading = 0_i32;
        let readings = sample.bend.iter_mut().zip(&mut sample.imu);
        for (angle, (bend, imu)) in self.angles.iter_mut().zip(readings) {
            if is_moving {
                *angle = walk(*angle, &mut self.random);
            }
            for counts in bend {
                *counts = Some(counts_at(*angle).wrapping_add_signed(self.random.below(17) as i16 - 8));
            }
            heading = heading.wrapping_add(angle.bits());
            *imu = Some(quaternion(heading));
        }
        sample
    }
}

/// Turns an angle by at most 20 mrad, within ±1.9 rad.
fn walk(angle: Phase, random: &mut Random) -> Phase {
    const STEP: u32 = 13_671_305;
    const LIMIT: i32 = 1_298_774_022;
    let stride = random.below(2 * STEP) as i32 - STEP as i32;
    Phase::from_bits(angle.bits().saturating_add(stride).clamp(-LIMIT, LIMIT))
}

/// Counts of a bend sensor at an angle.
fn counts_at(angle: Phase) -> u16 {
    const RANGES_PER_RAD: Q = Q::from_f64(1.0 / RAD_PER_RANGE);
    let range = Q::from_phase(angle) * RANGES_PER_RAD;
    CENTER.wrapping_add_signed((range.to_bits() >> (Q::FRACTION_BITS - u32::from(RANGE))) as i16)
}

/// Reading of a BNO055 at a heading, clockwise, in units of 2⁻³² turns.
fn quaternion(heading: i32) -> ImuReading {
    let half = UnitArc::new(Angle::from(Q::from_phase(Phase::from_bits(heading >> 1))));
    // Of 26 fractional bits it gives 14.
    ImuReading::from_bno055([(half.cos.to_bits() >> 12) as i16, 0, 0, (-half.sin.to_bits() >> 12) as i16])
}
