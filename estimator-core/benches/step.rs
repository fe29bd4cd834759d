//! Time of 1000 estimator steps, all of fusion's path, so that µs read as ns a step: `cargo bench -p estimator-core`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use estimator_core::{
    AnchorConfig, ArmConfig, BendMap, BendSensorConfig, BiasFilterConfig, Estimator, FusedOps, ImuReading, Phase, Q,
    QuadraticMap, Sample, SegmentConfig, Turns,
};

const SEGMENTS: [usize; 3] = [6, 12, 16];
/// Longer than the anchor's window, so that its sums run as they do for hours.
const SAMPLES: usize = 1000;

fn main() {
    divan::main();
}

fn segments<S: FusedOps>(count: usize) -> Vec<SegmentConfig<S>> {
    let map = BendMap::Quadratic(QuadraticMap::from_volts(0.1, 1.2, -2.0, [0.5, 2.5]));
    let sensor = BendSensorConfig { map, memory: None };
    (0..count).map(|_| SegmentConfig { bend: [Some(sensor); 2], ..SegmentConfig::uncalibrated(0.080, 0.017) }).collect()
}

/// An arm that swings, with drift; no two samples are the same.
fn samples(count: usize) -> Vec<Sample<16>> {
    let sample = |k: usize| {
        let swing = (k as f64 / 50.0).sin();
        let mut sample = Sample::missing(k as u64 * 10_000);
        for i in 0..count {
            sample.bend[i] = [Some((2000.0 + 300.0 * swing) as u16), Some((2010.0 + 290.0 * swing) as u16)];
            let heading = 20.0 * swing * (i + 1) as f64 + 0.0005 * k as f64;
            sample.imu[i] = Some(ImuReading::Heading(Phase::from_degrees(heading)));
        }
        sample
    };
    (0..SAMPLES).map(sample).collect()
}

fn steps<S: FusedOps>(bencher: Bencher, count: usize, bias_filter: Option<BiasFilterConfig>) {
    let segments = segments::<S>(count);
    let anchor = AnchorConfig {
        window: 100,
        rate_millihertz: 10_000,
        sample_rate_millihertz: 100_000,
        threshold: Turns::from_bits(5_965_232),
    };
    let table = ArmConfig { tare_samples: 100, anchor, bias_filter, ..ArmConfig::uncalibrated(&segments) };
    let samples = samples(count);
    let mut estimator = Estimator::<S, 16, 100>::new(&table).expect("a valid table");
    // All samples at once, as one is shorter than the clock's own noise; the counter divides by them.
    bencher.counter(ItemsCount::new(SAMPLES)).bench_local(|| {
        for sample in &samples {
            black_box(estimator.update_full(black_box(sample)));
        }
    });
}

#[divan::bench(args = SEGMENTS)]
fn fixed_point(bencher: Bencher, segments: usize) {
    steps::<Q>(bencher, segments, None);
}

#[divan::bench(args = SEGMENTS)]
fn float(bencher: Bencher, segments: usize) {
    steps::<f64>(bencher, segments, None);
}

#[divan::bench(args = SEGMENTS)]
fn bias_filter(bencher: Bencher, segments: usize) {
    steps::<Q>(bencher, segments, Some(BiasFilterConfig::BNO055));
}
