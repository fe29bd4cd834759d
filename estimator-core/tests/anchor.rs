//! The drift anchor: exact means over windows with holes.

use estimator_core::{AnchorConfig, Decimator, MovingAverageAnchor, Turns};
use proptest::prelude::*;

fn config(window: u16, decimation: u16) -> AnchorConfig {
    let sample_rate_millihertz = 10_000 * u32::from(decimation);
    AnchorConfig { window, rate_millihertz: 10_000, sample_rate_millihertz, threshold: Turns::ZERO }
}

/// Mean of the values that are present, rounded down as [`Turns::mean_of`] is.
fn mean(values: &[Option<i64>]) -> Option<i64> {
    let there: Vec<_> = values.iter().flatten().map(|value| i128::from(*value)).collect();
    (!there.is_empty()).then(|| there.iter().sum::<i128>().div_euclid(there.len() as i128) as i64)
}

fn pushed<const W: usize>(config: &AnchorConfig, values: &[Option<i64>]) -> Vec<Option<i64>> {
    let (mut decimator, mut anchor) = (Decimator::new(), MovingAverageAnchor::<W>::new());
    let push = |value: &Option<i64>| {
        anchor.push(decimator.advance(config), value.map(Turns::from_bits));
        anchor.offset().map(Turns::bits)
    };
    values.iter().map(push).collect()
}

proptest! {
    /// By the definition: groups of `decimation` samples, the mean of each, the mean of the newest `window` of them.
    #[test]
    fn the_offset_is_the_mean_of_the_groups_means(
        window in 1_u16..=7,
        decimation in 1_u16..=5,
        values in prop::collection::vec(prop::option::of(-1_i64 << 50..1 << 50), 0..150),
    ) {
        let mut groups = Vec::new();
        let mut expected = Vec::new();
        let mut newest = None;
        for t in 1..=values.len() {
            if t % usize::from(decimation) == 0 {
                groups.push(mean(&values[t - usize::from(decimation)..t]));
                newest = mean(&groups[groups.len().saturating_sub(usize::from(window))..]).or(newest);
            }
            expected.push(newest);
        }
        prop_assert_eq!(pushed::<7>(&config(window, decimation), &values), expected);
    }
}

#[test]
fn there_is_no_offset_before_the_first_difference() {
    assert_eq!(MovingAverageAnchor::<3>::new().offset(), None);
    assert_eq!(pushed::<3>(&config(3, 1), &[None, None, Some(5)]), [None, None, Some(5)]);
}

#[test]
fn a_window_that_is_not_full_is_the_mean_of_what_there_is() {
    assert_eq!(pushed::<3>(&config(3, 1), &[Some(2), Some(4), Some(6)]), [Some(2), Some(3), Some(4)]);
}

#[test]
fn the_newest_is_included_and_the_oldest_leaves() {
    assert_eq!(pushed::<2>(&config(2, 1), &[Some(100), Some(2), Some(4)]), [Some(100), Some(51), Some(3)]);
}

#[test]
fn a_missing_difference_keeps_its_place_empty() {
    let values = [Some(10), None, Some(20), Some(30)];
    assert_eq!(pushed::<3>(&config(3, 1), &values), [Some(10), Some(10), Some(15), Some(25)]);
}

#[test]
fn the_offset_holds_through_an_empty_window_and_starts_afresh_after_it() {
    let values = [Some(10), Some(20), None, None, None, Some(-8)];
    let expected = [Some(10), Some(15), Some(20), Some(20), Some(20), Some(-8)];
    assert_eq!(pushed::<2>(&config(2, 1), &values), expected);
}

#[test]
fn a_window_shorter_than_the_room_forgets_as_early() {
    let values = [Some(9), Some(1), Some(3), Some(5)];
    assert_eq!(pushed::<100>(&config(2, 1), &values), pushed::<2>(&config(2, 1), &values));
}

#[test]
fn decimation_averages_whole_groups() {
    let values = [Some(1), Some(2), Some(6), Some(30), Some(30), Some(30), Some(-99)];
    let expected = [None, None, Some(3), Some(3), Some(3), Some(16), Some(16)];
    assert_eq!(pushed::<10>(&config(10, 3), &values), expected);
}

#[test]
fn a_rate_that_does_not_divide_keeps_its_pace() {
    let config = AnchorConfig { sample_rate_millihertz: 25_000, ..config(10, 1) };
    let values = [1, 2, 3, 10, 12, 1, 2, 3, 10, 12].map(Some);
    // 25 Hz to 10 Hz: groups of 3 and 2 in turn, of means 2 and 11.
    let expected = [None, None, Some(2), Some(2), Some(6), Some(6), Some(6), Some(5), Some(5), Some(6)];
    assert_eq!(pushed::<10>(&config, &values), expected);
}

#[test]
fn a_rate_above_the_samples_takes_every_sample() {
    let config = AnchorConfig { sample_rate_millihertz: 3_000, ..config(2, 1) };
    assert_eq!(pushed::<2>(&config, &[1, 3, 5].map(Some)), [Some(1), Some(2), Some(4)]);
}

#[test]
fn a_group_counts_what_it_has_and_without_any_leaves_its_place_empty() {
    let values = [None, Some(4), None, None, Some(6), Some(8), None, None];
    let expected = [None, Some(4), Some(4), Some(4), Some(4), Some(7), Some(7), Some(7)];
    assert_eq!(pushed::<2>(&config(2, 2), &values), expected);
}

/// 10⁸ samples at 100 Hz are 11 days; a drift of 45° in 15 min adds 5965 units to each, and every thousandth is
/// missing. Running sums in f32 would have lost all digits.
#[test]
fn sums_stay_exact_over_100_million_samples() {
    const SAMPLES: u64 = 100_000_000;
    const WINDOW: u16 = 100;
    let config = config(WINDOW, 1);
    let (mut decimator, mut anchor) = (Decimator::new(), MovingAverageAnchor::<{ WINDOW as usize }>::new());
    let mut newest = [None; WINDOW as usize];
    let mut noise = 1_u64;
    for t in 0..SAMPLES {
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let value = (t % 1000 != 7).then_some((noise >> 35) as i64 + t as i64 * 5965);
        anchor.push(decimator.advance(&config), value.map(Turns::from_bits));
        newest[t as usize % newest.len()] = value;
    }
    assert_eq!(anchor.offset().map(Turns::bits), mean(&newest));
}
