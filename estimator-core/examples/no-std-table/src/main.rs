//! Estimates the tip of the reference arm by a table that `build.rs` has compiled into the program.
//!
//! For a Cortex-M3 it is a `no_std` program:
//! `cargo build --release -p no-std-table --target thumbv7m-none-eabi`. On a host it prints the tip:
//! `cargo run -p no-std-table`.
#![cfg_attr(target_os = "none", no_std, no_main)]

use estimator_core::nalgebra::Vector2;
use estimator_core::{Estimator, ImuReading, Phase, Q, Sample};

#[expect(clippy::unreadable_literal, reason = "generated")]
mod table {
    include!(concat!(env!("OUT_DIR"), "/table.rs"));
}

/// Samples at 100 Hz: a tare of one second, and a slow bend.
const SAMPLES: i32 = 400;
/// 10° in units of 2⁻³² turns.
const TEN_DEGREES: i32 = 119_304_647;

/// Readings at sample `k`: after the tare each segment bends to 10°. The bend sensors are missing.
fn sample(k: i32) -> Sample<6> {
    let mut sample = Sample::missing(10_000 * u64::from(k.unsigned_abs()));
    let bend = TEN_DEGREES / SAMPLES * (k - 100).max(0);
    let mut heading = 0;
    for imu in &mut sample.imu {
        heading += bend;
        *imu = Some(ImuReading::Heading(Phase::from_bits(heading)));
    }
    sample
}

/// Tip of the arm in {W} after all samples, m.
fn tip() -> Option<Vector2<Q>> {
    let mut estimator = Estimator::<Q, 6, 100>::new(&table::TABLE).ok()?;
    let mut tip = None;
    for k in 0..SAMPLES {
        tip = estimator.update(&sample(k)).last().and_then(|segment| segment.end);
    }
    tip
}

#[cfg(not(target_os = "none"))]
fn main() {
    let tip = tip().expect("the table is that of an arm of six segments");
    println!("tip at {:.1} mm, {:.1} mm", 1000.0 * tip.x.to_f64(), 1000.0 * tip.y.to_f64());
}

#[cfg(target_os = "none")]
mod board {
    use core::hint::black_box;
    use core::panic::PanicInfo;

    use cortex_m::asm::wfi;
    use defmt as _;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        // A real program sends it.
        black_box(super::tip());
        loop {
            wfi();
        }
    }

    #[panic_handler]
    fn panic(_: &PanicInfo) -> ! {
        loop {
            wfi();
        }
    }
}
