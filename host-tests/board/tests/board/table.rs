//! The table in the board's flash: transfer, use, damage, loss of power.

use board_tests::{Board, flash_with, stored_table};
use proprio_link::table::StoredTable;
use rig_twin::{MotionProgram, Scenario};
use telemetry::{Command, Health, Message, Refusal, RequestOutcome, TABLE_CHUNK_BYTES, TableChunk, TableStatus};
use virtual_due::{CYCLES_PER_SECOND, Cycles, FLASH_BYTES, WiredRig};

use crate::replay::assert_replays;

/// Offset of the first slot in the flash, and length of a slot.
const SLOTS: usize = FLASH_BYTES - 64 * 1024;

fn rig() -> WiredRig {
    WiredRig::new(Scenario::FreeSwing, 5)
}

fn empty_board() -> Board {
    let mut board = Board::with_flash(rig(), &vec![0xFF; FLASH_BYTES]);
    board.run_ms(300);
    board
}

/// The pieces of a table, from the first to the last.
fn pieces(table: &StoredTable) -> Vec<Command> {
    let body = table.body();
    let piece = |(index, bytes): (usize, &[u8])| {
        let offset = (index * TABLE_CHUNK_BYTES) as u32;
        Command::TableWrite(TableChunk { offset, bytes: bytes.try_into().expect("it fits") })
    };
    body.chunks(TABLE_CHUNK_BYTES).enumerate().map(piece).collect()
}

/// Sends a request and runs the board until it replies, as a host does without a delay of its own.
fn request(board: &mut Board, command: Command) -> RequestOutcome {
    board.begin_session();
    let before = board.received().len();
    let id = board.send(command);
    for _ in 0..500 {
        board.run_ms(1);
        let reply = board.received()[before..].iter().find_map(|received| match received.message {
            Message::Reply(reply) if reply.id == id => Some(reply.outcome),
            _ => None,
        });
        if let Some(outcome) = reply {
            return outcome;
        }
    }
    panic!("no reply within 500 ms");
}

/// Sends a table; returns the time until the board has restarted with it.
fn push(board: &mut Board, table: &StoredTable) -> Cycles {
    board.begin_session();
    let start = board.machine.now();
    assert_eq!(request(board, table.begin()), RequestOutcome::Ack);
    // Two pieces ahead of their replies, as `proprio table push` sends them.
    let acknowledged = |board: &Board| {
        let is_ack =
            |message: &Message| matches!(message, Message::Reply(reply) if reply.outcome == RequestOutcome::Ack);
        board.received().iter().filter(|received| is_ack(&received.message)).count()
    };
    let before = acknowledged(board);
    for (sent, piece) in pieces(table).into_iter().enumerate() {
        board.send(piece);
        while acknowledged(board) < before + sent {
            board.run_ms(1);
        }
    }
    assert_eq!(request(board, Command::TableCommit), RequestOutcome::Ack);
    let boot = |board: &Board| board.hellos().next_back().map(|hello| hello.boot);
    let before = boot(board);
    while boot(board) == before {
        board.run_ms(1);
    }
    board.machine.now() - start
}

/// The reference arm's table under another name.
fn other_table() -> StoredTable {
    let file = calibration_tables::ArmFile { arm: "another arm".to_owned(), ..board_tests::table() };
    StoredTable::new(&file, file.to_toml().as_bytes()).expect("it can be stored")
}

fn arm_of(board: &Board) -> String {
    board.hellos().next_back().expect("a Hello comes").arm.as_str().to_owned()
}

#[test]
fn a_table_is_pushed_within_a_second_and_its_estimates_are_the_hosts() {
    let mut board = empty_board();
    let took = push(&mut board, &stored_table());
    assert!(took < CYCLES_PER_SECOND, "{} ms", took * 1000 / CYCLES_PER_SECOND);
    let hello = board.hellos().next_back().expect("a Hello comes");
    assert_eq!((hello.arm.as_str(), hello.table), ("planar-6", stored_table().checksum));
    assert_eq!(board.table_states().next_back().map(|state| state.status), Some(TableStatus::InUse));
    let restarted = board.samples().count();
    board.run_ms(2000);
    board.swing(&MotionProgram::new(Scenario::FreeSwing, 5), 5);
    assert_replays(&board, restarted);
}

#[test]
fn a_board_without_a_table_sends_samples_and_no_estimates_and_does_not_arm() {
    let mut board = empty_board();
    board.run_ms(2000);
    assert!(board.samples().count() > 200);
    assert_eq!((board.estimates().count(), board.uncertainties().count()), (0, 0));
    assert_eq!(board.request(Command::Arm), RequestOutcome::Nack(Refusal::NoTable));
    assert_eq!(board.request(Command::TableRead(0)), RequestOutcome::Nack(Refusal::NoTable));
    assert_eq!(board.table_states().next_back().map(|state| state.status), Some(TableStatus::Missing));
    assert_eq!(arm_of(&board), "");
}

#[test]
fn a_flipped_bit_of_the_table_is_noticed_at_boot() {
    let good = flash_with(&stored_table());
    let length = stored_table().body().len();
    // Header, image and source.
    for place in [5, 9, 20, 256, 256 + 3000, 256 + length - 1] {
        let mut flash = good.clone();
        flash[SLOTS + place] ^= 4;
        let mut board = Board::with_flash(rig(), &flash);
        board.run_ms(500);
        let state = board.table_states().next().expect("it comes with the Hello");
        assert_eq!(state.status, TableStatus::Damaged, "byte {place}");
        assert!(board.samples().count() > 20 && board.estimates().count() == 0);
    }
}

#[test]
fn a_table_of_another_format_version_is_not_used() {
    let mut flash = flash_with(&stored_table());
    flash[SLOTS + 4] = 0xEE;
    let crc = board_table::body_crc([&flash[SLOTS..SLOTS + 24]]);
    flash[SLOTS + 24..SLOTS + 28].copy_from_slice(&crc.to_le_bytes());
    let mut board = Board::with_flash(rig(), &flash);
    board.run_ms(500);
    assert_eq!(board.table_states().next().map(|state| state.status), Some(TableStatus::Foreign));
    assert_eq!(board.estimates().count(), 0);
}

#[test]
fn a_loss_of_power_in_a_transfer_leaves_the_old_table() {
    let mut board = Board::new(rig());
    board.run_ms(300);
    assert_eq!(request(&mut board, other_table().begin()), RequestOutcome::Ack);
    let pieces = pieces(&other_table());
    for (index, piece) in pieces.iter().enumerate() {
        // The power goes while the last piece is on the line or being written.
        board.send(piece.clone());
        board.run_ms(if index % 2 == 0 { 8 } else { 13 });
        if index % 16 == 15 {
            let mut after = Board::with_flash(rig(), &board.machine.flash());
            after.run_ms(300);
            assert_eq!(arm_of(&after), "planar-6", "after piece {index}");
            assert_eq!(after.table_states().next().map(|state| state.status), Some(TableStatus::InUse));
        }
        board.run_ms(30);
    }
    assert_eq!(request(&mut board, Command::TableCommit), RequestOutcome::Ack);
    let mut after = Board::with_flash(rig(), &board.machine.flash());
    after.run_ms(300);
    assert_eq!(arm_of(&after), "another arm", "the new one counts from the reply on");
}

#[test]
fn pieces_that_are_repeated_or_missing_are_noticed_and_the_transfer_is_resumed() {
    let mut board = empty_board();
    let table = stored_table();
    let pieces = pieces(&table);
    assert_eq!(request(&mut board, table.begin()), RequestOutcome::Ack);
    assert_eq!(request(&mut board, pieces[0].clone()), RequestOutcome::Ack);
    assert_eq!(request(&mut board, pieces[0].clone()), RequestOutcome::Ack, "under another number");
    assert_eq!(request(&mut board, pieces[2].clone()), RequestOutcome::Nack(Refusal::TableOrder));
    assert_eq!(request(&mut board, Command::TableCommit), RequestOutcome::Nack(Refusal::TableOrder));
    assert_eq!(request(&mut board, table.begin()), RequestOutcome::Ack);
    board.run_ms(20);
    let received = board.table_states().next_back().map(|state| state.received_bytes);
    assert_eq!(received, Some(TABLE_CHUNK_BYTES as u32));
    for piece in &pieces[1..] {
        assert_eq!(request(&mut board, piece.clone()), RequestOutcome::Ack);
    }
    assert_eq!(request(&mut board, Command::TableCommit), RequestOutcome::Ack);
}

#[test]
fn an_armed_board_refuses_another_table_and_goes_on() {
    let mut board = Board::new(rig());
    board.run_ms(1500);
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    for command in [other_table().begin(), Command::TableCommit, Command::TableErase] {
        assert_eq!(request(&mut board, command), RequestOutcome::Nack(Refusal::Armed));
    }
    assert_eq!(arm_of(&board), "planar-6");
    assert_eq!(board.estimates().next_back().map(|estimate| estimate.segments[0].is_some()), Some(true));
}

#[test]
fn a_transfer_disturbs_neither_ticks_nor_imus() {
    let mut board = Board::new(rig());
    board.run_ms(1500);
    let (from, before) = (board.samples().count(), board.healths().next_back().expect("it comes at 5 Hz").clone());
    assert_eq!(request(&mut board, other_table().begin()), RequestOutcome::Ack);
    for piece in pieces(&other_table()) {
        assert_eq!(request(&mut board, piece), RequestOutcome::Ack);
    }
    board.run_ms(300);
    let ticks: Vec<u32> = board.samples().skip(from).map(|sample| sample.tick).collect();
    assert!(ticks.windows(2).all(|pair| pair[1] == pair[0] + 1), "a tick is missing");
    let after = board.healths().next_back().expect("it comes at 5 Hz");
    assert_eq!((after.overruns, after.stale_scans), (before.overruns, before.stale_scans));
    let missed = |health: &Health| -> Vec<_> { health.imu.iter().map(|imu| imu.missed).collect() };
    assert_eq!(missed(after), missed(&before));
}

#[test]
fn an_erased_board_has_no_table_after_its_restart() {
    let mut board = Board::new(rig());
    board.run_ms(500);
    assert_eq!(request(&mut board, Command::TableErase), RequestOutcome::Ack);
    board.run_ms(300);
    assert_eq!(board.table_states().next_back().map(|state| state.status), Some(TableStatus::Missing));
    assert_eq!(arm_of(&board), "");
}
