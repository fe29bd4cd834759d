//! Runs the pipeline on a host with a small configuration written by hand, and prints the tip by each method:
//! `cargo run -p estimator-core --example tip`.
//!
//! Two segments swing for 20 s. Each has a bend sensor of 1 rad/V and an IMU, of which the second drifts by 0.05 °/s.

use estimator_core::{
    ArmConfig, BendMap, BendSensorConfig, BiasFilterConfig, ConfigError, Estimator, ImuReading, Method, Phase, Q,
    QuadraticMap, Sample, SegmentConfig,
};

const RATE_HZ: u32 = 10;
const DRIFT_DEG_PER_S: f64 = 0.05;

/// Counts of a sensor that reads 1.5 V when straight.
fn counts(theta: f64) -> u16 {
    ((1.5 + theta) / 3.3 * 4095.0).round() as u16
}

fn main() -> Result<(), ConfigError> {
    // θ = c2 V² + c1 V + c0, fitted from 0.5 V to 2.5 V.
    let map = BendMap::Quadratic(QuadraticMap::from_volts(0.0, 1.0, -1.5, [0.5, 2.5]));
    let sensor = BendSensorConfig { map, memory: None };
    // 80 mm of arc and a connector of 17 mm.
    let segment = SegmentConfig::<Q> { bend: [Some(sensor), None], ..SegmentConfig::uncalibrated(0.080, 0.017) };
    let segments = [segment; 2];
    let config = ArmConfig {
        tare_samples: RATE_HZ,
        bias_filter: Some(BiasFilterConfig::BNO055),
        ..ArmConfig::uncalibrated(&segments)
    };
    let mut estimator = Estimator::<Q, 2, 100>::new(&config)?;

    println!("time_s  method  tip_x_mm  tip_y_mm");
    for k in 0..=20 * RATE_HZ {
        let time_s = f64::from(k) / f64::from(RATE_HZ);
        // The arm is straight for 2 s, of which the first is the tare.
        let theta = 0.5 * (1.2 * (time_s - 2.0).max(0.0)).sin();
        let mut sample = Sample::missing(u64::from(k) * 1_000_000 / u64::from(RATE_HZ));
        for (i, (bend, imu)) in sample.bend.iter_mut().zip(&mut sample.imu).enumerate() {
            bend[0] = Some(counts(theta));
            let drift_deg = DRIFT_DEG_PER_S * time_s * i as f64;
            let heading_deg = (theta * (i + 1) as f64).to_degrees() + drift_deg;
            *imu = Some(ImuReading::Heading(Phase::from_degrees(heading_deg)));
        }
        let estimate = estimator.update_full(&sample);
        if k % (5 * RATE_HZ) != 0 {
            continue;
        }
        for method in Method::ALL {
            let shape = estimator.shape(&estimate, method);
            match shape.last().and_then(|tip| tip.end) {
                Some(end) => {
                    let [x_mm, y_mm] = [end.x, end.y].map(|coordinate| 1000.0 * coordinate.to_f64());
                    println!("{time_s:6.1}  {:<6}  {x_mm:8.2}  {y_mm:8.2}", method.name());
                }
                None => println!("{time_s:6.1}  {:<6}         -         -", method.name()),
            }
        }
    }
    Ok(())
}
