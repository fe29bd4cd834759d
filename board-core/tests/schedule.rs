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

#[test]
fn by_default_all_is_sent_at_100_hz_health_at_5_hz_and_uncertainty_at_4_hz() {
    assert_eq!(in_ten_seconds(Schedule::default()), [1000, 1000, 50, 40, 10]);
}

#[test]
fn each_message_has_its_own_rate_and_zero_is_never() {
    let rates = Rates { sample: 10, estimate: 0, health: u16::MAX, uncertainty: 50 };
    assert_eq!(in_ten_seconds(Schedule::new(rates)), [100, 0, 1, 20, 10]);
}

#[test]
fn samples_and_estimates_of_the_same_rate_are_of_the_same_ticks() {
    let schedule = Schedule::new(Rates { sample: 7, estimate: 7, health: 0, uncertainty: 0 });
    assert!((0..1000).all(|tick| schedule.due(tick).sample == schedule.due(tick).estimate));
}
