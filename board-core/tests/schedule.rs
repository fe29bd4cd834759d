//! Messages are due at their rates.

use board_core::Schedule;
use telemetry::Rates;

/// Counts of samples, estimates, healths, uncertainties and hellos in ten seconds.
fn in_ten_seconds(schedule: Schedule) -> [usize; 5] {
    let mut count = [0; 5];
    for tick in 0..1000 {
        let due = schedule.due(tick);
        for (count, due) in count.iter_mut().zip([due.sample, due.estimate, due.health, due.uncertainty, due.hello]) {
            *count += usize::from(due);
        }
    }
    count
}

/// The schedule of an arm of so many segments after a request.
fn scheduled(segments: usize, rates: Rates) -> Schedule {
    let mut schedule = Schedule::of_arm(segments, 6);
    schedule.set(rates);
    schedule
}

#[test]
fn for_six_segments_all_is_sent_at_100_hz_and_health_and_uncertainty_at_4_hz() {
    assert_eq!(in_ten_seconds(Schedule::of_arm(6, 6)), [1000, 1000, 40, 40, 10]);
}

#[test]
fn each_message_has_its_own_rate_and_zero_is_never() {
    let rates = Rates { sample: 10, estimate: 0, health: u16::MAX, uncertainty: 50 };
    assert_eq!(in_ten_seconds(scheduled(6, rates)), [100, 0, 1, 20, 10]);
}

#[test]
fn samples_and_estimates_of_the_same_rate_are_of_the_same_ticks() {
    let schedule = scheduled(6, Rates { sample: 7, estimate: 7, health: 0, uncertainty: 0 });
    assert!((0..1000).all(|tick| schedule.due(tick).sample == schedule.due(tick).estimate));
}

#[test]
fn estimates_of_eight_segments_are_sent_every_second_tick_whatever_the_host_requests() {
    assert_eq!(in_ten_seconds(Schedule::of_arm(8, 6)), [1000, 500, 40, 40, 10]);
    let every_tick = Rates { sample: 1, estimate: 1, health: 25, uncertainty: 25 };
    assert_eq!(in_ten_seconds(scheduled(8, every_tick)), [1000, 500, 40, 40, 10]);
    assert_eq!(in_ten_seconds(scheduled(8, Rates { estimate: 0, ..every_tick })), [1000, 0, 40, 40, 10]);
    assert_eq!(in_ten_seconds(scheduled(8, Rates { estimate: 10, ..every_tick })), [1000, 100, 40, 40, 10]);
}
