//! Recordings of a board: what a replay makes of them, whole, cut, with losses and restarts.

use proprio_session::HostNs;
use proprio_session::recording::Recorder;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde_json::Value;
use telemetry::{Decoder, Encoder, Event, MAX_FRAME, Message};

use super::board::SyntheticBoard;
use super::common::{Folder, error_of, estimates, json, table};

/// 2025-11-25, ns since 1970.
const START_NS: u64 = 1_764_000_000_000_000_000;

/// Records pieces of a stream, one every 10 ms.
pub fn record(pieces: impl IntoIterator<Item = Vec<u8>>) -> Vec<u8> {
    let mut recorder = Recorder::new(Vec::new(), HostNs(START_NS), "a test").expect("memory takes all");
    let mut decoder = Decoder::<Message>::new();
    for (at, piece) in (START_NS..).step_by(10_000_000).map(HostNs).zip(pieces) {
        recorder.bytes(at, &piece).expect("memory takes all");
        for message in piece.into_iter().filter_map(|byte| decoder.push(byte)).filter_map(Result::ok) {
            recorder.message(at, &message).expect("memory takes all");
        }
    }
    recorder.finish().expect("memory takes all")
}

pub fn ticks(board: SyntheticBoard) -> Vec<Vec<u8>> {
    board.map(|(frames, _)| frames.concat()).collect()
}

/// Report of `replay --json` about the recorded estimates, and its line on stderr.
pub fn recorded(folder: &Folder, name: &str) -> (Value, String) {
    let run = folder.done(&["replay", name, "--table", table(), "--json"]);
    (json(&run)["sessions"][0]["recorded"].clone(), run.stderr)
}

fn replayed(recording: Vec<u8>) -> (Value, String) {
    recorded(&Folder::with("session.mcap", recording), "session.mcap")
}

/// The same of five seconds of a board whose messages are changed.
fn replayed_with(change: impl Fn(&mut Message)) -> (Value, String) {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::<Message>::new());
    let messages = SyntheticBoard::new(1, 5.0).bytes().into_iter().filter_map(|byte| decoder.push(byte));
    let changed = messages.map(|message| {
        let mut message = message.expect("nothing is damaged");
        change(&mut message);
        encoder.encode(&message, &mut [0; MAX_FRAME]).expect("it fits").to_vec()
    });
    replayed(record(changed))
}

#[test]
fn a_replay_gives_the_recorded_estimates_bit_for_bit_and_reports_it() {
    let (recorded, stderr) = replayed(record(ticks(SyntheticBoard::new(1, 20.0))));
    assert_eq!(
        (&recorded["estimates"], &recorded["equal"], &recorded["not_compared"]),
        (&2000.into(), &2000.into(), &0.into())
    );
    assert_eq!((&recorded["first_difference"], &recorded["table_matches"]), (&Value::Null, &true.into()));
    assert_eq!(
        stderr,
        "session.mcap: the 2000 recorded estimates, 80 uncertainties and 0 changes of contact are, bit for bit, those of this \
         replay\n"
    );
}

#[test]
fn the_estimator_restarts_where_the_board_did() {
    let mut board = SyntheticBoard::new(1, 10.0);
    let mut pieces = Vec::new();
    for tick in 0..1000 {
        if tick == 400 {
            board.tare();
        }
        pieces.push(board.tick().expect("it runs for 10 s").0.concat());
    }
    // Then it restarts, twice: in the middle of a frame.
    for boot in [2, 3] {
        let cut = pieces.pop().map(|last| last[..50].to_vec()).expect("it has run");
        pieces.push([cut, vec![0]].concat());
        pieces.extend(ticks(SyntheticBoard::new(boot, 5.0)));
    }
    let (recorded, _) = replayed(record(pieces));
    assert_eq!((&recorded["equal"], &recorded["not_compared"]), (&1998.into(), &0.into()));
    assert_eq!(recorded["first_difference"], Value::Null);
}

/// The recorded estimates of one tick are changed by the least there is.
#[test]
fn the_first_estimate_that_differs_is_named() {
    let (recorded, stderr) = replayed_with(|message| {
        if let Message::Estimate(estimate) = message
            && estimate.tick >= 300
        {
            estimate.segments[2].as_mut().expect("it is known").end[1] += 1;
        }
    });
    assert_eq!(recorded["equal"], 300);
    let first = &recorded["first_difference"];
    assert_eq!((&first["tick"], &first["segment"]), (&300.into(), &3.into()));
    let difference = |name: &str| {
        let [recorded, computed] = ["recorded", "computed"].map(|of| first[of][name].as_f64().expect("a number"));
        // Units of 2⁻²⁶, of which both are whole numbers.
        ((recorded - computed) * 67_108_864.0) as i64
    };
    assert_eq!(["theta_rad", "x_m", "y_m"].map(difference), [0, 0, 1]);
    assert!(stderr.contains("200 of 500 recorded estimates are not those of this replay"), "{stderr}");
    assert!(stderr.contains("tick 300, segment 3, recorded θ "), "{stderr}");
}

#[test]
fn an_uncertainty_that_differs_by_a_bit_is_reported() {
    let (recorded, stderr) = replayed_with(|message| {
        if let Message::Uncertainty(uncertainty) = message
            && uncertainty.tick == 300
        {
            uncertainty.segments[5].end.as_mut().expect("it is known")[1] += 1;
        }
    });
    assert_eq!((&recorded["equal"], &recorded["first_difference"]), (&500.into(), &Value::Null));
    let compared = &recorded["uncertainties"];
    assert_eq!(
        (&compared["compared"], &compared["equal"], &compared["first_difference"]),
        (&20.into(), &19.into(), &300.into())
    );
    assert!(stderr.contains("1 of 20 uncertainties are not, the first: tick 300"), "{stderr}");
}

#[test]
fn a_recorded_contact_that_the_replay_lacks_is_reported() {
    let (recorded, stderr) = replayed_with(|message| {
        // In an event's place, which costs nothing else.
        if let Message::Health(health) = message
            && health.tick == 340
        {
            *message = Message::Event(Event::Contact(health.tick, 0b11_1111));
        }
    });
    let compared = &recorded["contacts"];
    assert_eq!(
        (&compared["compared"], &compared["equal"], &compared["first_difference"]),
        (&1.into(), &0.into(), &340.into())
    );
    assert!(stderr.contains("1 of 1 changes of contact are not, the first: tick 340"), "{stderr}");
}

#[test]
fn estimates_after_a_lost_sample_are_not_compared_until_the_next_tare() {
    let mut board = SyntheticBoard::new(1, 6.0);
    let mut pieces = Vec::new();
    for tick in 0..600 {
        if tick == 500 {
            board.tare();
        }
        let (mut frames, _) = board.tick().expect("it runs for 6 s");
        if tick == 300 {
            frames.remove(1);
        }
        pieces.extend(frames);
    }
    let (recorded, stderr) = replayed(record(pieces));
    assert_eq!(recorded["first_difference"], Value::Null);
    // The estimate of tick 300 has no sample, and those of 301 to 499 no history.
    assert_eq!((&recorded["equal"], &recorded["not_compared"]), (&400.into(), &199.into()), "{stderr}");
    assert!(stderr.contains("199 more are not compared"), "{stderr}");
}

/// Its rate is the board's, however many samples are missing.
#[test]
fn a_recording_that_lacks_every_third_sample_is_replayed_at_the_boards_rate() {
    let board = SyntheticBoard::new(1, 12.0);
    let pieces = board.enumerate().map(|(tick, (mut frames, _))| {
        if tick >= 100 && tick % 3 == 0 {
            // The first frame of every hundredth tick is the Hello.
            frames.remove(usize::from(tick % 100 == 0));
        }
        frames.concat()
    });
    let (recorded, stderr) = replayed(record(pieces));
    assert_eq!((&recorded["equal"], &recorded["first_difference"]), (&102.into(), &Value::Null), "{stderr}");
}

#[test]
fn a_lost_estimate_costs_nothing_else() {
    let board = SyntheticBoard::new(1, 5.0);
    let pieces = board.enumerate().map(|(tick, (mut frames, _))| {
        if tick == 251 {
            frames.pop();
        }
        frames.concat()
    });
    let (recorded, _) = replayed(record(pieces));
    assert_eq!((&recorded["estimates"], &recorded["equal"]), (&499.into(), &499.into()));
}

#[test]
fn another_table_is_reported_as_the_cause_of_different_estimates() {
    let folder = Folder::with("session.mcap", record(ticks(SyntheticBoard::new(1, 5.0))));
    let other = std::fs::read_to_string(table()).expect("the reference table").replacen(
        "length_mm = 80.0",
        "length_mm = 81.0",
        1,
    );
    folder.write("other.toml", other);
    let run = folder.done(&["replay", "session.mcap", "--table", "other.toml", "--json"]);
    assert_eq!(json(&run)["sessions"][0]["recorded"]["table_matches"], false);
    assert!(run.stderr.contains("the board had another table"), "{}", run.stderr);
}

#[test]
fn a_replay_in_floats_is_not_compared_with_the_boards_estimates() {
    let folder = Folder::with("session.mcap", record(ticks(SyntheticBoard::new(1, 2.0))));
    let run = folder.done(&["replay", "session.mcap", "--table", table(), "--json", "--float"]);
    assert_eq!(json(&run)["sessions"][0].get("recorded"), None);
    assert_eq!(run.stderr, "");
}

#[test]
fn a_recording_is_known_by_its_content_and_read_from_a_pipe() {
    let recording = record(ticks(SyntheticBoard::new(1, 3.0)));
    let folder = Folder::with("session.csv", &recording);
    let of_file = folder.done(&["replay", "session.csv", "--table", table(), "--json"]);
    assert_eq!(json(&of_file)["sessions"][0]["recorded"]["equal"], 300);
    #[cfg(unix)]
    {
        let input = std::fs::File::open(folder.path("session.csv")).expect("it is there");
        let mut cat = std::process::Command::new("cat")
            .stdin(input)
            .stdout(std::process::Stdio::piped())
            .spawn()
            .expect("cat starts");
        let mut command = folder.command(&["replay", "/dev/stdin", "--table", table(), "--json"]);
        let output = command.stdin(cat.stdout.take().expect("a pipe")).output().expect("the tool starts");
        cat.wait().expect("cat ends");
        let of_pipe = json(&output.into());
        assert_eq!(of_pipe["sessions"][0]["recorded"]["equal"], 300);
    }
}

#[test]
fn a_recording_gives_the_estimates_of_the_same_session_as_csv() {
    let folder = Folder::with("session.mcap", record(ticks(SyntheticBoard::new(1, 12.0))));
    folder.done(&["convert", "session.mcap", "session.csv"]);
    folder.done(&["replay", "session.mcap", "--table", table(), "--out", "est.csv"]);
    assert_eq!(folder.csv("est.csv"), estimates(folder.read("session.csv")));
}

#[test]
fn a_recording_of_a_longer_arm_is_refused() {
    let folder = Folder::with("session.mcap", record(ticks(SyntheticBoard::new(1, 2.0))));
    let mut long = std::fs::read_to_string(table()).expect("the reference table");
    long += "[[segment]]\nlength_mm = 80.0\noffset_mm = 17.0\noffset_at = \"end\"\nbend = []\n";
    folder.write("long.toml", long);
    let error = folder.refused(&["replay", "session.mcap", "--table", "long.toml"]);
    assert!(error.contains("a board with 6 segments, the arm has 7"), "{error}");
}

#[test]
fn calibrate_refuses_a_recording_without_truth() {
    let folder = Folder::with("session.mcap", record(ticks(SyntheticBoard::new(1, 12.0))));
    let error = folder.refused(&["calibrate", "session.mcap", "--arm", super::common::arm(), "-o", "table.toml"]);
    assert!(error.contains("has no truth"), "{error}");
}

#[test]
fn a_cut_recording_is_refused_with_the_way_to_save_it() {
    let recording = record(ticks(SyntheticBoard::new(1, 5.0)));
    let folder = Folder::with("cut.mcap", &recording[..recording.len() / 2]);
    let run = folder.run(&["replay", "cut.mcap", "--table", table()]);
    assert_eq!(run.code, Some(2));
    assert!(error_of(&run.stderr).contains("was cut"), "{}", run.stderr);
    assert!(run.stderr.contains("proprio recover"), "{}", run.stderr);
}

/// All but the last chunk of a file that is cut at any byte is recovered, and replays bit for bit.
#[test]
fn a_recording_that_is_cut_at_any_byte_loses_no_more_than_its_last_second() {
    let recording = record(ticks(SyntheticBoard::new(1, 20.0)));
    let footer = recording.len() - mcap::MAGIC.len() - 20;
    let index = u64::from_le_bytes(*recording[footer..].first_chunk().expect("it has eight bytes")) as usize;
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..25 {
        let cut = 4096 + random.next_u32() as usize % (recording.len() - 4096);
        let folder = Folder::with("cut.mcap", &recording[..cut]);
        let run = folder.run(&["recover", "cut.mcap", "-o", "whole.mcap"]);
        // The index repeats what is before it.
        let loses_data = cut < index;
        assert_eq!(run.code, Some(loses_data.into()), "cut at {cut}: {}", run.stderr);
        assert_eq!(run.stderr.contains("the end is missing: all after "), loses_data, "cut at {cut}: {}", run.stderr);
        assert!(run.stderr.contains("recovered from a file "), "{}", run.stderr);
        let (recorded, stderr) = recorded(&folder, "whole.mcap");
        assert_eq!(recorded["first_difference"], Value::Null, "cut at {cut}: {stderr}");
        assert_eq!(recorded["equal"], recorded["estimates"], "cut at {cut}: {stderr}");
        let saved = recorded["equal"].as_u64().expect("a count");
        let at_best = 2000 * cut as u64 / recording.len() as u64;
        assert!(saved + 200 > at_best, "cut at {cut}: {saved} recovered of about {at_best}");
    }
}

#[test]
fn a_recording_of_another_protocol_version_is_refused_with_both_versions() {
    // COBS( 1 | CRC-32 ): a frame of version 1 without anything in it.
    let frame = [[6, 1].as_slice(), &0xa505_df1b_u32.to_le_bytes(), &[0]].concat();
    let folder = Folder::with("old.mcap", record([frame]));
    let error = folder.refused(&["replay", "old.mcap", "--table", table()]);
    assert!(error.contains("its board used protocol version 1, and this proprio reads versions 2 and 3"), "{error}");
}

#[test]
fn what_is_no_recording_is_not_recovered() {
    let folder = Folder::with("session.csv", "time_s\n0\n");
    let error = folder.refused(&["recover", "session.csv", "-o", "whole.mcap"]);
    assert!(error.contains("no MCAP file"), "{error}");
    let run = folder.run(&["recover", "session.csv", "-o", "whole.mcap"]);
    assert!(run.stderr.contains("only recordings (.mcap) are recovered"), "{}", run.stderr);
    folder.write("short.mcap", &record(ticks(SyntheticBoard::new(1, 2.0)))[..300]);
    let error = folder.refused(&["recover", "short.mcap", "-o", "whole.mcap"]);
    assert!(error.contains("nothing in it is whole"), "{error}");
}
