//! Messages are due at the rates asked for.

use board_core::Schedule;
use telemetry::Rates;

/// How many samples, estimates, healths and hellos ten seconds bring.
fn in_ten_seconds(schedule: Schedule) -> [usize; 4] {
    let mut count = [0; 4];
    for tick in 0..1000 {
        let due = schedule.due(tick);
        for (count, due) in count.iter_mut().zip([due.sample, due.estimate, due.health, due.hello]) {
            *count += usize::from(due);
        }
    }
    count
}

#[test]
fn by_default_all_is_sent_at_100_hz_and_health_at_5_hz() {
    assert_eq!(in_ten_seconds(Schedule::default()), [1000, 1000, 50, 10]);
}

#[test]
fn each_message_has_its_own_rate_and_zero_is_never() {
    let rates = Rates { sample: 10, estimate: 0, health: u16::MAX };
    assert_eq!(in_ten_seconds(Schedule::new(rates)), [100, 0, 1, 10]);
}

#[test]
fn samples_and_estimates_of_the_same_rate_are_of_the_same_ticks() {
    let schedule = Schedule::new(Rates { sample: 7, estimate: 7, health: 0 });
    assert!((0..1000).all(|tick| schedule.due(tick).sample == schedule.due(tick).estimate));
}
