//! Root mean square and quantiles.

/// Root mean square.
pub(super) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0_f64), |(sum, count), value| (sum + value * value, count + 1.0));
    (sum / count.max(1.0)).sqrt()
}

/// Quantile of sorted values, linear between two.
pub(super) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    let below = place as usize;
    let (Some(a), b) = (sorted.get(below), sorted.get(below + 1)) else { return 0.0 };
    b.map_or(*a, |b| a + (b - a) * (place - below as f64))
}
