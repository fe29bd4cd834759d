//! Standard output and error: nothing where it does not belong, and an orderly end where they take no more.

use std::fs::File;

use super::common::{Folder, Run, error_of, json, session, table};

const SLOW: [&str; 11] =
    ["simulate", "--scenario", "1", "--seconds", "6000", "--seed", "1", "--rate", "1", "-o", "session.csv"];

fn with_session() -> Folder {
    Folder::with("session.csv", session().to_string())
}

fn to_stdout(folder: &Folder, args: &[&str], stdout: impl Into<std::process::Stdio>) -> Run {
    folder.command(args).stdout(stdout).output().expect("the tool starts").into()
}

#[cfg(target_os = "linux")]
fn full() -> File {
    File::options().write(true).open("/dev/full").expect("Linux has /dev/full")
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_refused() {
    for args in [&["replay", "session.csv", "--table", table(), "--json"][..], &["completions", "bash"]] {
        let run = to_stdout(&with_session(), args, full());
        assert_eq!(run.code, Some(2), "{}", run.stderr);
        assert!(error_of(&run.stderr).starts_with("standard output cannot be written"), "{}", run.stderr);
    }
}

/// As `proprio … | head -1` does when `head` has gone.
#[test]
fn a_closed_pipe_is_no_failure() {
    for args in [&["replay", "session.csv", "--table", table(), "--json"][..], &["completions", "bash"]] {
        let (reader, writer) = std::io::pipe().expect("the system has pipes");
        drop(reader);
        let run = to_stdout(&with_session(), args, writer);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    }
}

#[test]
fn an_error_with_a_closed_stderr_still_has_status_2() {
    let (reader, writer) = std::io::pipe().expect("the system has pipes");
    drop(reader);
    let folder = Folder::new();
    let mut command = folder.command(&["replay", "none.csv", "--table", table()]);
    let status = command.stderr(writer).status().expect("the tool starts");
    assert_eq!(status.code(), Some(2));
}

#[cfg(target_os = "linux")]
#[test]
fn an_error_on_a_full_standard_error_still_has_status_2() {
    let folder = Folder::new();
    let mut command = folder.command(&["replay", "none.csv", "--table", table()]);
    assert_eq!(command.stderr(full()).status().expect("the tool starts").code(), Some(2));
}

#[test]
fn a_good_replay_prints_nothing_on_stderr() {
    let run = with_session().done(&["replay", "session.csv", "--table", table()]);
    assert_eq!(run.stderr, "");
}

#[test]
fn work_of_seconds_draws_no_bar_where_stderr_is_no_terminal() {
    let run = Folder::new().done(&SLOW);
    assert_eq!((run.stdout.as_str(), run.warnings().len()), ("", 0), "{}", run.stderr);
}

#[test]
fn an_error_has_no_escape_codes_where_stderr_is_no_terminal() {
    let run = Folder::new().run(&["replay", "none.csv", "--table", table()]);
    assert!(run.stderr.starts_with("error: ") && !run.stderr.contains('\u{1b}'), "{:?}", run.stderr);
}

/// Colours are forced and forbidden at once: forbidden wins, as <https://no-color.org> requires.
#[test]
fn no_color_wins_over_forced_colours() {
    let folder = Folder::new();
    let mut command = folder.command(&["replay", "none.csv", "--table", table()]);
    let command = command.env("CLICOLOR_FORCE", "1");
    let coloured = Run::from(command.output().expect("the tool starts"));
    assert!(coloured.stderr.contains('\u{1b}'), "else this test shows nothing: {:?}", coloured.stderr);
    let plain = Run::from(command.env("NO_COLOR", "1").output().expect("the tool starts"));
    assert!(!plain.stderr.contains('\u{1b}'), "{:?}", plain.stderr);
}

#[test]
fn a_table_for_people_has_no_escape_codes() {
    let run = with_session().done(&["replay", "session.csv", "--table", table()]);
    assert!(!run.stdout.contains('\u{1b}'));
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_name_that_is_not_utf8_can_be_replayed() {
    use std::os::unix::ffi::OsStrExt;

    let folder = Folder::new();
    let name = std::ffi::OsStr::from_bytes(b"s\xffssion.csv");
    std::fs::write(folder.path("").join(name), session().to_string()).expect("Linux takes any name");
    let mut command = folder.command(&["replay", "--table", table(), "--json"]);
    let run = Run::from(command.arg(name).output().expect("the tool starts"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert_eq!(json(&run)["sessions"][0]["samples"], 150);
}
