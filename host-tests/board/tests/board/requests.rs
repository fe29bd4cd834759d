//! Requests over the serial line.

use board_tests::{Board, UART};
use rig_twin::Scenario;
use telemetry::{
    Command, Encoder, Event, MAX_FRAME, Message, PressureLimit, Rates, Refusal, Request, RequestOutcome, ResetCause,
    SetPressures, TareMode, protocol_2,
};
use virtual_due::{CYCLES_PER_SECOND, WiredRig};

fn ready() -> Board {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(1500);
    board
}

#[test]
fn a_ping_is_answered_with_a_hello() {
    let mut board = ready();
    let before = board.hellos().count();
    board.send(Command::Ping);
    board.run_ms(40);
    assert!(board.hellos().count() > before);
}

#[test]
fn rates_slow_the_stream_down() {
    let mut board = ready();
    assert_eq!(
        board.request(Command::Rates(Rates { sample: 0, estimate: 10, health: 0, uncertainty: 0 })),
        RequestOutcome::Ack
    );
    let before = (board.samples().count(), board.estimates().count(), board.healths().count());
    board.run_ms(1000);
    let after = (board.samples().count(), board.estimates().count(), board.healths().count());
    assert_eq!((after.0 - before.0, after.1 - before.1, after.2 - before.2), (0, 10, 0));
}

#[test]
fn a_repeated_request_acts_once_and_is_answered_again() {
    let mut board = ready();
    let tares = board.samples().next_back().expect("samples come").tare_epoch;
    board.begin_session();
    let before = board.received().len();
    let request = Request { id: 77, session: board.session(), command: Command::Tare(TareMode::Force) };
    for _ in 0..3 {
        board.send_again(&request);
        board.run_ms(50);
    }
    assert_eq!(board.samples().next_back().expect("samples come").tare_epoch, tares + 1);
    let replies = board.received()[before..].iter().filter(|received| matches!(received.message, Message::Reply(_)));
    assert_eq!(replies.count(), 3);
}

#[test]
fn a_pressure_over_the_range_is_refused() {
    let mut board = ready();
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    let over = SetPressures { pressures_pa: [0, 0, 0, 280_001, 0, 0].into_iter().collect(), valid_ms: 100 };
    assert_eq!(board.request(Command::SetPressures(over)), RequestOutcome::Nack(Refusal::OverRange));
}

#[test]
fn a_reboot_is_answered_and_then_done() {
    let mut board = ready();
    assert_eq!(board.request(Command::Reboot), RequestOutcome::Ack);
    board.run_ms(200);
    let hello = board.hellos().next_back().expect("a board sends `Hello`");
    assert_eq!((hello.reset, hello.boot), (ResetCause::Software, 2));
}

#[test]
fn a_flood_of_noise_changes_nothing_but_a_count() {
    let mut board = ready();
    // Half a second of the line, zeros among them.
    let noise: Vec<u8> = (0_u32..12_500).map(|n| (n.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let now = board.machine.now();
    board.machine.world_mut().send(UART, &noise, now);
    board.run_ms(1000);
    let health = board.healths().next_back().expect("health comes");
    assert!(health.damaged_frames > 10, "{health:?}");
    assert_eq!((health.overruns, health.dropped_frames), (0, 0));
    assert_eq!(board.request(Command::Ping), RequestOutcome::Ack);
}

#[test]
fn a_flood_of_requests_delays_no_tick() {
    let mut board = ready();
    for _ in 0..200 {
        board.send(Command::Ping);
    }
    board.run_ms(1000);
    let ticks: Vec<_> = board.samples().map(|sample| sample.tick).collect();
    assert!(ticks.windows(2).all(|pair| pair[1] == pair[0] + 1), "a tick is missing");
    assert_eq!(board.healths().next_back().expect("health comes").overruns, 0);
}

#[test]
fn bytes_of_an_earlier_session_that_arrive_again_move_nothing() {
    let mut board = ready();
    board.begin_session();
    let (session, mut bytes) = (board.session(), Vec::new());
    let pressures = SetPressures { pressures_pa: [100_000; 6].into_iter().collect(), valid_ms: 1000 };
    let commands = [Command::Ping, Command::Arm, Command::SetPressures(pressures)];
    let mut encoder = Encoder::new();
    for (id, command) in (1000..).zip(commands) {
        let mut buffer = [0; MAX_FRAME];
        bytes.extend_from_slice(encoder.encode(&Request { id, session, command }, &mut buffer).expect("it fits"));
    }
    let send = |board: &mut Board| {
        let now = board.machine.now();
        board.machine.world_mut().send(UART, &bytes, now);
    };
    send(&mut board);
    board.run_ms(100);
    assert!(!board.is_vented(), "the first time they move the arm");
    board.run_ms(2900);
    assert!(board.is_vented());
    for _ in 0..30 {
        send(&mut board);
        board.run_ms(100);
        assert!(board.is_vented());
    }
}

#[test]
fn a_disarm_vents_whatever_its_number_and_session() {
    let mut board = ready();
    board.pressurise(100_000);
    assert!(!board.is_vented());
    board.send_again(&Request { id: 1, session: board.session() - 1, command: Command::Disarm });
    board.run_ms(30);
    assert!(board.is_vented());
}

#[test]
fn set_points_that_would_rise_without_imus_are_answered_as_limited() {
    let mut board = ready();
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    for imu in 1..=6 {
        board.inject(&format!("imu{imu}:unplugged"));
    }
    board.run_ms(100);
    let set =
        |pa: u32| Command::SetPressures(SetPressures { pressures_pa: [pa; 6].into_iter().collect(), valid_ms: 1000 });
    assert_eq!(board.request(set(50_000)), RequestOutcome::Limited);
    assert_eq!(board.request(set(0)), RequestOutcome::Ack);
    board.run_ms(300);
    let health = board.healths().next_back().expect("health comes");
    assert_eq!(health.limit, PressureLimit::SensorsLost);
    assert!(board.is_vented());
}

#[test]
fn frames_of_an_unknown_version_or_topic_are_counted() {
    let mut board = ready();
    let count =
        |board: &Board| board.healths().next_back().map(|health| (health.damaged_frames, health.unknown_frames));
    let before = count(&board).expect("health comes");
    // A Ping of version 2, and a message of the board, which is no request.
    let mut buffer = [0; MAX_FRAME];
    let ping = Request { id: 1, session: 0, command: Command::Ping };
    let foreign = Encoder::for_version(protocol_2::VERSION).encode(&ping, &mut buffer).expect("it fits").to_vec();
    let event = Encoder::new().encode(&Message::Event(Event::BusRecovery), &mut buffer).expect("it fits").to_vec();
    let now = board.machine.now();
    board.machine.world_mut().send(UART, &[foreign, event].concat(), now);
    board.run_ms(300);
    assert_eq!(count(&board), Some((before.0, before.1 + 2)));
}

#[test]
fn a_flood_of_pings_gets_one_hello_in_100_ms_at_most() {
    let mut board = ready();
    for _ in 0..100 {
        board.send(Command::Ping);
        board.run_ms(10);
    }
    board.run_ms(200);
    let hellos = board.received().iter().filter(|received| matches!(received.message, Message::Hello(_)));
    let times: Vec<_> = hellos.map(|received| received.at).collect();
    let closest = times.windows(2).map(|pair| pair[1] - pair[0]).min().expect("several hellos");
    assert!(times.len() >= 8, "{} hellos", times.len());
    // 95 ms: the frame before it on the line may delay the first one.
    assert!(closest >= 95 * CYCLES_PER_SECOND / 1000, "{closest} cycles");
}
