//! Pressures are armed explicitly, within limits, and vented when no set-points are received.

use board_core::{Actuator, Execution, HOLD_MS, Pressures, VALID_MS_MAX, VENTED_MS};
use board_table::{REFERENCE_FULL_SCALE_PA as FULL_SCALE_PA, RegulatorWiring, Wiring};
use proptest::prelude::*;
use telemetry::{Actuation, Event, Refusal, SetPressures};

const MS: u64 = 1000;
const VENTED_US: u64 = VENTED_MS as u64 * MS;
const REGULATORS: usize = 6;
const PRESSURES_PA: [u32; REGULATORS] = [280_000, 140_000, 70_000, 1, 0, 200_000];

/// Pressures as in a message.
fn pressures(pressures_pa: [u32; REGULATORS]) -> Pressures {
    pressures_pa.into_iter().collect()
}

/// Regulators of these full scales.
fn regulators(full_scales_pa: [u32; REGULATORS]) -> Wiring {
    let mut wiring = Wiring::reference(6);
    for (RegulatorWiring { full_scale_pa, .. }, full_scale) in wiring.regulators.iter_mut().zip(full_scales_pa) {
        *full_scale_pa = full_scale;
    }
    wiring
}

fn armed() -> Actuator {
    let mut actuator = Actuator::new(&Wiring::reference(6));
    actuator.arm();
    actuator
}

fn request(valid_ms: u16) -> SetPressures {
    SetPressures { pressures_pa: pressures(PRESSURES_PA), valid_ms }
}

fn at(actuator: &mut Actuator, now_us: u64) -> (Actuation, [u32; REGULATORS]) {
    actuator.advance(now_us);
    now(actuator)
}

fn now(actuator: &Actuator) -> (Actuation, [u32; REGULATORS]) {
    let pressures_pa = actuator.pressures_pa().as_slice().try_into().expect("six regulators");
    (actuator.state(), pressures_pa)
}

#[test]
fn actuator_starts_vented_and_refuses_set_points_until_armed() {
    let mut actuator = Actuator::new(&Wiring::reference(6));
    assert_eq!(actuator.set(&request(100), 0), Err(Refusal::Disarmed));
    assert_eq!(at(&mut actuator, 0), (Actuation::Disarmed, [0; REGULATORS]));
    actuator.arm();
    assert_eq!(at(&mut actuator, 0), (Actuation::Armed, [0; REGULATORS]));
    assert_eq!(actuator.set(&request(100), 0), Ok(Execution::Done));
    assert_eq!(at(&mut actuator, 0), (Actuation::Armed, PRESSURES_PA));
}

#[test]
fn an_armed_arm_without_set_points_stays_vented_and_armed() {
    let mut actuator = armed();
    assert_eq!(at(&mut actuator, 3_600_000 * MS), (Actuation::Armed, [0; REGULATORS]));
    assert_eq!(actuator.set(&request(1), 3_600_000 * MS), Ok(Execution::Done));
}

#[test]
fn each_regulator_has_its_own_full_scale_and_none_is_over_it() {
    let mut full_scales_pa = [FULL_SCALE_PA; REGULATORS];
    full_scales_pa[2] = 50_000;
    let mut actuator = Actuator::new(&regulators(full_scales_pa));
    actuator.arm();
    for (regulator, pressure, outcome) in [
        (0, FULL_SCALE_PA, Ok(Execution::Done)),
        (0, FULL_SCALE_PA + 1, Err(Refusal::OverRange)),
        (0, u32::MAX, Err(Refusal::OverRange)),
        (2, 50_000, Ok(Execution::Done)),
        (2, 50_001, Err(Refusal::OverRange)),
    ] {
        let mut pressures_pa = [0; REGULATORS];
        pressures_pa[regulator] = pressure;
        assert_eq!(
            actuator.set(&SetPressures { pressures_pa: pressures(pressures_pa), valid_ms: 100 }, 0),
            outcome,
            "{regulator}: {pressure} Pa"
        );
    }
}

#[test]
fn the_deadline_is_one_millisecond_to_one_second() {
    let mut actuator = armed();
    for (valid_ms, outcome) in [
        (0, Err(Refusal::Deadline)),
        (1, Ok(Execution::Done)),
        (VALID_MS_MAX, Ok(Execution::Done)),
        (VALID_MS_MAX + 1, Err(Refusal::Deadline)),
        (u16::MAX, Err(Refusal::Deadline)),
    ] {
        assert_eq!(actuator.set(&request(valid_ms), 0), outcome, "{valid_ms} ms");
    }
}

#[test]
fn refused_set_points_leave_the_old_ones_and_their_deadline() {
    let mut actuator = armed();
    actuator.set(&request(100), 0).unwrap();
    let over_range = SetPressures { pressures_pa: pressures([FULL_SCALE_PA + 1; REGULATORS]), valid_ms: 100 };
    assert_eq!(actuator.set(&over_range, 90 * MS), Err(Refusal::OverRange));
    assert_eq!(actuator.set(&request(0), 90 * MS), Err(Refusal::Deadline));
    assert_eq!(at(&mut actuator, 100 * MS), (Actuation::Armed, PRESSURES_PA));
    assert_eq!(at(&mut actuator, 100 * MS + 1), (Actuation::Holding, PRESSURES_PA));
}

#[test]
fn silence_holds_then_ramps_then_vents_at_the_stated_times() {
    for valid_ms in [1, 100, 500, VALID_MS_MAX] {
        let mut actuator = armed();
        let start_us = 71 * 60_000 * MS;
        actuator.set(&request(valid_ms), start_us).unwrap();
        let hold = start_us + u64::from(valid_ms) * MS;
        let ramp = hold + u64::from(HOLD_MS) * MS;
        let vented = start_us + VENTED_US;
        assert_eq!(at(&mut actuator, hold), (Actuation::Armed, PRESSURES_PA), "{valid_ms} ms");
        assert_eq!(at(&mut actuator, hold + 1), (Actuation::Holding, PRESSURES_PA), "{valid_ms} ms");
        assert_eq!(at(&mut actuator, ramp), (Actuation::Holding, PRESSURES_PA), "{valid_ms} ms");
        let halfway = [140_000, 70_000, 35_000, 0, 0, 100_000];
        assert_eq!(at(&mut actuator, ramp.midpoint(vented)), (Actuation::Ramping, halfway), "{valid_ms} ms");
        assert_eq!(at(&mut actuator, vented - 1).0, Actuation::Ramping, "{valid_ms} ms");
        assert_eq!(at(&mut actuator, vented), (Actuation::Disarmed, [0; REGULATORS]), "{valid_ms} ms");
    }
}

#[test]
fn set_points_are_followed_again_while_holding_and_ramping() {
    for (late_ms, state) in [(200, Actuation::Holding), (900, Actuation::Ramping)] {
        let mut actuator = armed();
        actuator.set(&request(100), 0).unwrap();
        assert_eq!(at(&mut actuator, late_ms * MS).0, state);
        actuator.set(&request(100), late_ms * MS).unwrap();
        assert_eq!(at(&mut actuator, late_ms * MS + 100 * MS), (Actuation::Armed, PRESSURES_PA));
        assert_eq!(at(&mut actuator, late_ms * MS + VENTED_US), (Actuation::Disarmed, [0; REGULATORS]));
    }
}

#[test]
fn after_silence_it_stays_vented_until_armed_again() {
    let mut actuator = armed();
    actuator.set(&request(100), 0).unwrap();
    // It was not advanced meanwhile: the set-points are too late.
    assert_eq!(actuator.set(&request(100), VENTED_US), Err(Refusal::Disarmed));
    assert_eq!(at(&mut actuator, VENTED_US + 1), (Actuation::Disarmed, [0; REGULATORS]));
    actuator.arm();
    assert_eq!(at(&mut actuator, VENTED_US + 2), (Actuation::Armed, [0; REGULATORS]));
}

#[test]
fn arming_again_does_not_extend_the_deadline() {
    let mut actuator = armed();
    actuator.set(&request(100), 0).unwrap();
    for ms in 0..u64::from(VENTED_MS) {
        actuator.advance(ms * MS);
        actuator.arm();
    }
    assert_eq!(at(&mut actuator, VENTED_US), (Actuation::Disarmed, [0; REGULATORS]));
}

#[test]
fn disarming_vents_at_once_until_armed_again() {
    for ms in [0, 200, 900] {
        let mut actuator = armed();
        actuator.set(&request(100), 0).unwrap();
        actuator.advance(ms * MS);
        actuator.disarm();
        assert_eq!(now(&actuator), (Actuation::Disarmed, [0; REGULATORS]));
        assert_eq!(at(&mut actuator, ms * MS + 1), (Actuation::Disarmed, [0; REGULATORS]));
        assert_eq!(actuator.set(&request(100), ms * MS + 1), Err(Refusal::Disarmed));
    }
}

#[test]
fn while_degraded_pressures_go_down_and_not_up() {
    let mut actuator = armed();
    let all = |pressure| SetPressures { pressures_pa: pressures([pressure; REGULATORS]), valid_ms: 100 };
    actuator.set(&all(100_000), 0).unwrap();
    actuator.set_degraded(true);
    assert_eq!(actuator.set(&all(150_000), 1), Ok(Execution::Limited));
    assert_eq!(now(&actuator).1, [100_000; REGULATORS]);
    assert_eq!(actuator.set(&all(60_000), 2), Ok(Execution::Done));
    actuator.set(&all(100_000), 3).unwrap();
    assert_eq!(now(&actuator).1, [60_000; REGULATORS]);
    actuator.set_degraded(false);
    assert_eq!(now(&actuator).1, [60_000; REGULATORS]);
    actuator.set(&all(100_000), 4).unwrap();
    assert_eq!(now(&actuator).1, [100_000; REGULATORS]);
}

#[test]
fn while_degraded_a_ramp_continues_from_the_present_pressures() {
    let mut actuator = armed();
    actuator.set(&request(100), 0).unwrap();
    actuator.set_degraded(true);
    let (state, ramped) = at(&mut actuator, 900 * MS);
    assert_eq!(state, Actuation::Ramping);
    actuator.set(&request(100), 900 * MS).unwrap();
    assert_eq!(at(&mut actuator, 900 * MS), (Actuation::Armed, ramped));
}

#[test]
fn set_points_for_another_number_of_regulators_are_refused() {
    let mut wiring = Wiring::reference(2);
    wiring.regulators.truncate(2);
    let mut actuator = Actuator::new(&wiring);
    actuator.arm();
    for (count, outcome) in [
        (0, Err(Refusal::Regulators)),
        (1, Err(Refusal::Regulators)),
        (2, Ok(Execution::Done)),
        (3, Err(Refusal::Regulators)),
    ] {
        let request = SetPressures { pressures_pa: (0..count).map(|_| 100_000).collect(), valid_ms: 100 };
        assert_eq!(actuator.set(&request, 0), outcome, "{count}");
    }
    assert_eq!(actuator.pressures_pa(), &[100_000; 2]);
}

#[test]
fn an_arm_without_regulators_is_armed_and_has_no_pressures() {
    let mut wiring = Wiring::reference(1);
    wiring.regulators.clear();
    let mut actuator = Actuator::new(&wiring);
    actuator.arm();
    assert_eq!(actuator.set(&SetPressures { pressures_pa: Pressures::new(), valid_ms: 100 }, 0), Ok(Execution::Done));
    assert_eq!((actuator.state(), actuator.duties(4200).len()), (Actuation::Armed, 0));
}

#[test]
fn each_change_of_state_is_reported_once() {
    let mut actuator = armed();
    assert_eq!(actuator.event(), Some(Event::Actuation(Actuation::Armed)));
    actuator.set(&request(100), 0).unwrap();
    let mut events = Vec::new();
    for ms in 0..2 * u64::from(VENTED_MS) {
        actuator.advance(ms * MS);
        events.extend(actuator.event());
    }
    let states = [Actuation::Holding, Actuation::Ramping, Actuation::Disarmed];
    assert_eq!(events, states.map(Event::Actuation));
}

#[test]
fn duties_are_zero_when_vented_and_the_whole_period_at_full_scale() {
    let mut actuator = armed();
    assert_eq!(actuator.duties(u16::MAX), [0; REGULATORS]);
    let all = |pressure| SetPressures { pressures_pa: pressures([pressure; REGULATORS]), valid_ms: 100 };
    for period in [0, 1, 4200, u16::MAX] {
        actuator.set(&all(FULL_SCALE_PA), 0).unwrap();
        assert_eq!(actuator.duties(period), [period; REGULATORS]);
        actuator.set(&all(FULL_SCALE_PA / 4), 0).unwrap();
        assert_eq!(actuator.duties(period), [period / 4; REGULATORS]);
    }
}

/// Action of a host at a time.
#[derive(Debug, Clone)]
enum Step {
    Arm,
    Disarm,
    Degraded(bool),
    Set(SetPressures),
    Wait,
}

fn step() -> impl Strategy<Value = Step> {
    let set = (prop::array::uniform6(0_u32..300_000), 0_u16..1100).prop_map(|(pressures_pa, valid_ms)| {
        Step::Set(SetPressures { pressures_pa: pressures(pressures_pa), valid_ms })
    });
    prop_oneof![
        2 => Just(Step::Arm),
        1 => Just(Step::Disarm),
        1 => any::<bool>().prop_map(Step::Degraded),
        6 => set,
        6 => Just(Step::Wait),
    ]
}

proptest! {
    #[test]
    fn whatever_comes_pressures_keep_their_limits_and_end_vented(
        steps in prop::collection::vec((step(), 0_u64..700 * MS), 1..60),
        limits_pa in prop::array::uniform6(0_u32..=FULL_SCALE_PA),
    ) {
        let mut actuator = Actuator::new(&regulators(limits_pa));
        let (mut now_us, mut accepted_us, mut degraded) = (0, None, false);
        for (step, later_us) in steps {
            now_us += later_us;
            actuator.advance(now_us);
            let before_pa = now(&actuator).1;
            match step {
                Step::Arm => actuator.arm(),
                Step::Disarm => actuator.disarm(),
                Step::Degraded(now) => {
                    degraded = now;
                    actuator.set_degraded(now);
                }
                Step::Set(request) => {
                    if actuator.set(&request, now_us).is_ok() {
                        accepted_us = Some(now_us);
                    } else {
                        prop_assert_eq!(now(&actuator).1, before_pa);
                    }
                }
                Step::Wait => {}
            }
            let pressures_pa = now(&actuator).1;
            for ((now, before), limit) in pressures_pa.into_iter().zip(before_pa).zip(limits_pa) {
                prop_assert!(now <= limit);
                prop_assert!(!degraded || now <= before);
            }
            let silent = accepted_us.is_none_or(|accepted_us| now_us - accepted_us >= VENTED_US);
            if silent || actuator.state() == Actuation::Disarmed {
                prop_assert_eq!(pressures_pa, [0; REGULATORS]);
            }
        }
        actuator.advance(now_us + VENTED_US);
        prop_assert_eq!(now(&actuator).1, [0; REGULATORS]);
    }

    #[test]
    fn without_set_points_pressures_only_go_down(
        pressures_pa in prop::array::uniform6(0..=FULL_SCALE_PA),
        valid_ms in 1..=VALID_MS_MAX,
        tick_us in 1000_u64..50_000,
    ) {
        let mut actuator = armed();
        actuator.set(&SetPressures { pressures_pa: pressures(pressures_pa), valid_ms }, 0).unwrap();
        let mut before_pa = pressures_pa;
        for now_us in (0..=1500 * MS).step_by(tick_us as usize) {
            let (_, now_pa) = at(&mut actuator, now_us);
            prop_assert!(now_pa.iter().zip(before_pa).all(|(now, before)| *now <= before));
            before_pa = now_pa;
        }
        prop_assert_eq!(before_pa, [0; REGULATORS]);
    }

    #[test]
    fn duties_rise_with_the_pressure(low in 0..=FULL_SCALE_PA, high in 0..=FULL_SCALE_PA, period in any::<u16>()) {
        let duty = |pressure| {
            let mut actuator = armed();
            actuator.set(&SetPressures { pressures_pa: pressures([pressure; REGULATORS]), valid_ms: 1 }, 0).unwrap();
            actuator.duties(period)[0]
        };
        prop_assert!(duty(low.min(high)) <= duty(low.max(high)));
        prop_assert!(duty(high) <= period);
    }
}
