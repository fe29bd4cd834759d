//! The median.

/// The middle of the values; of an even number the upper one of the two. `None` without a value.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
