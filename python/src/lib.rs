//! The extension module of the Python package `proprio`: the program and its libraries.
//!
//! Arrays cross the border as bytes with a type and a shape, of which `proprio/_arrays.py` makes NumPy arrays; other results as
//! JSON. The package's own Python gives them their names and documentation.
//!
//! | file | purpose |
//! |---|---|
//! | `array.rs` | arrays, and their names |
//! | `error.rs` | errors as Python exceptions |
//! | `program.rs` | the program `proprio` |
//! | `table.rs` | tables and arm descriptions |
//! | `session.rs`, `rows.rs` | sessions as arrays; arrays as the rows of a session |
//! | `estimates.rs`, `replay.rs`, `estimator.rs` | estimates as arrays, of a session or step by step |
//! | `feed.rs` | the feed of a running monitor |
//! | `findings.rs`, `interrupt.rs` | warnings of the session check; Ctrl-C during long work |
//! | `check.rs`, `calibrate.rs`, `tune.rs`, `align.rs` | the other commands |

#![expect(clippy::needless_pass_by_value, reason = "PyO3 gives a function arguments of its own")]

mod align;
mod array;
mod calibrate;
mod check;
mod error;
mod estimates;
mod estimator;
mod feed;
mod findings;
mod interrupt;
mod program;
mod replay;
mod rows;
mod session;
mod table;
mod tune;

use pyo3::prelude::*;

/// Functions in Rust for the Python package `proprio`.
#[pymodule]
mod _proprio {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::align::align;
    #[pymodule_export]
    use crate::calibrate::calibrate;
    #[pymodule_export]
    use crate::check::check;
    #[pymodule_export]
    use crate::estimator::PyEstimator;
    #[pymodule_export]
    use crate::feed::Feed;
    #[pymodule_export]
    use crate::program::run;
    #[pymodule_export]
    use crate::replay::replay;
    #[pymodule_export]
    use crate::session::{read, write};
    #[pymodule_export]
    use crate::table::{load_table, parse_table, reference_arm, reference_table};
    #[pymodule_export]
    use crate::tune::tune;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
