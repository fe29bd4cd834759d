//! A measured figure of the benchmark.

/// A measured figure.
pub struct Figure {
    /// Its name in `budgets.toml`.
    pub name: &'static str,
    /// In the unit that the file states.
    pub value: f64,
}
