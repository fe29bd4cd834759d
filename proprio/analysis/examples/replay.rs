//! Replays a session that has truth, and prints the error of the tip for each method.
//!
//! ```text
//! cargo run --release -p proprio-analysis --example replay
//! cargo run --release -p proprio-analysis --example replay -- session.csv table.toml
//! ```
//!
//! Without arguments it takes a recorded session of this repository: the simulated arm, pushed by a stick.

use std::env;
use std::error::Error;
use std::path::{Path, PathBuf};

use estimator_core::{Method, Q};
use proprio_analysis::metrics::ErrorMetrics;
use proprio_analysis::replay::replay;
use proprio_session::{LoadedTable, NoProgress};

fn main() -> Result<(), Box<dyn Error>> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut arguments = env::args_os().skip(1).map(PathBuf::from);
    let session = arguments.next().unwrap_or_else(|| repository.join("host-tests/sessions/scenario-2.csv"));
    let table = arguments.next().unwrap_or_else(|| repository.join("calibration-tables/planar-6.toml"));

    let table = LoadedTable::load(&table)?;
    let mut errors = ErrorMetrics::new(table.file.length_mm());
    let mut samples = 0;
    // `Q` is the board's fixed point; `f64` runs the float reference.
    replay::<Q>(&session, &table, &mut NoProgress, |row, outcome| {
        errors.add(row, outcome);
        samples += 1;
        Ok(())
    })?;

    println!("{samples} samples; tip error, RMSE in mm:");
    for (method, metrics) in Method::ALL.into_iter().zip(errors.metrics()) {
        match metrics.tip_rmse_mm {
            Some(rmse_mm) => println!("{:>8} {rmse_mm:6.2}", method.name()),
            None => println!("{:>8}      –", method.name()),
        }
    }
    Ok(())
}
