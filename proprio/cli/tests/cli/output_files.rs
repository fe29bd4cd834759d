//! Files that are written whole or not at all, and never over something else than what was named.

use super::common::{Folder, arm, session, sweep, table};

fn with_session() -> Folder {
    Folder::with("session.csv", session().to_string())
}

fn replay_to(out: &str) -> [&str; 6] {
    ["replay", "session.csv", "--table", table(), "--out", out]
}

/// The same with `--force`.
fn force_to(out: &str) -> [&str; 7] {
    ["replay", "session.csv", "--table", table(), "--force", "--out", out]
}

#[test]
fn a_complete_file_leaves_no_part_behind() {
    let folder = with_session();
    folder.done(&replay_to("est.csv"));
    let entries = std::fs::read_dir(folder.path("")).expect("the folder is there");
    let mut names: Vec<_> = entries.map(|entry| entry.expect("it can be listed").file_name()).collect();
    names.sort();
    assert_eq!(names, ["est.csv", "session.csv"]);
}

#[test]
fn an_older_file_is_replaced_with_force() {
    let folder = with_session();
    folder.write("est.csv", "old");
    folder.done(&force_to("est.csv"));
    assert!(folder.read("est.csv").starts_with("time_s,"));
}

#[test]
fn no_command_replaces_a_file_unasked() {
    let folder = with_session();
    folder.write("old", "edited by a person");
    folder.write("old.mcap", "edited by a person");
    let simulate = ["simulate", "--scenario", "1", "--seconds", "1", "--seed", "1"];
    let report = ["report", "session.csv", "--table", table()];
    for args in [
        &replay_to("old")[..],
        &[&simulate[..], &["-o", "old"]].concat(),
        &[&simulate[..], &["-o", "new", "--camera", "old"]].concat(),
        &["align", "session.csv", "--camera", "session.csv", "--arm", arm(), "-o", "old"],
        &["calibrate", "session.csv", "--arm", arm(), "-o", "old"],
        &["tune", "session.csv", "--table", table(), "-o", "old"],
        &[&report[..], &["-o", "old"]].concat(),
        &[&report[..], &["-o", "new", "--json", "old"]].concat(),
        &[&report[..], &["-o", "new", "--csv", "old"]].concat(),
        &["convert", "session.csv", "old.mcap"],
        &["recover", "session.csv", "-o", "old"],
    ] {
        let error = folder.refused(args);
        assert!(error.ends_with("is there already and is not replaced"), "{args:?}: {error}");
    }
}

/// As `mktemp` leaves one.
#[test]
fn an_empty_file_is_filled() {
    let folder = Folder::with("session.csv", "");
    folder.done(&["simulate", "--scenario", "1", "--seconds", "1", "--seed", "1", "-o", "session.csv"]);
    assert_eq!(folder.csv("session.csv").rows.len(), 10);
}

#[test]
fn a_command_names_each_file_that_it_has_written_and_its_length() {
    let folder = with_session();
    let run = folder.done(&["report", "session.csv", "--table", table(), "-o", "r.html", "--csv", "r.csv"]);
    let line = |name: &str| format!("{name}: {} bytes written\n", folder.read(name).len());
    assert_eq!(run.stderr, line("r.html") + &line("r.csv"));
}

#[test]
fn a_dash_writes_the_estimates_to_standard_output_and_the_figures_to_standard_error() {
    let folder = with_session();
    let figures = folder.done(&replay_to("est.csv")).stdout;
    let run = folder.done(&replay_to("-"));
    assert_eq!(run.stdout, folder.read("est.csv"));
    assert_eq!(run.stderr, format!("{figures}standard output: {} bytes written\n", run.stdout.len()));
    assert!(!folder.path("-").exists());
}

#[test]
fn a_dash_converts_to_csv() {
    let folder = Folder::with("a.csv", super::common::quaternion_session().to_string());
    folder.done(&["convert", "a.csv", "a.mcap"]);
    folder.done(&["convert", "a.mcap", "b.csv"]);
    assert_eq!(folder.done(&["convert", "a.mcap", "-"]).stdout, folder.read("b.csv"));
}

/// As `proprio simulate -o - | head -1` does when `head` has gone.
#[test]
fn a_reader_of_standard_output_that_goes_early_is_no_failure() {
    let (reader, writer) = std::io::pipe().expect("the system has pipes");
    drop(reader);
    let folder = Folder::new();
    let args = ["simulate", "--scenario", "1", "--seconds", "100", "--seed", "1", "-o", "-"];
    assert!(folder.command(&args).stdout(writer).status().expect("the tool starts").success());
}

#[test]
fn an_older_file_stays_when_the_replay_fails() {
    let mut bad = session();
    bad.set(120, "bend1a_adc", "high");
    let folder = Folder::with("session.csv", bad.to_string());
    folder.write("est.csv", "old");
    folder.refused(&force_to("est.csv"));
    assert_eq!(folder.read("est.csv"), "old");
}

#[test]
fn an_older_table_stays_when_the_calibration_fails() {
    let mut still = session();
    still.rows.truncate(40);
    let folder = Folder::with("session.csv", still.to_string());
    folder.write("table.toml", "old");
    folder.refused(&["calibrate", "session.csv", "--arm", arm(), "--force", "-o", "table.toml"]);
    assert_eq!(folder.read("table.toml"), "old");
}

#[test]
fn a_folder_that_does_not_exist_is_refused_by_the_name_that_was_typed() {
    let error = with_session().refused(&replay_to("none/est.csv"));
    assert!(error.starts_with("none/est.csv: cannot be written"), "{error}");
    assert!(!error.contains(".part"), "the name aside means nothing to the user: {error}");
}

#[test]
fn calibrate_refuses_a_folder_that_does_not_exist() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    let error = folder.refused(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "none/table.toml"]);
    assert!(error.starts_with("none/table.toml: cannot be written"), "{error}");
}

#[test]
fn simulate_refuses_a_folder_that_does_not_exist() {
    let args = ["simulate", "--scenario", "1", "--seconds", "1", "--seed", "1", "-o", "none/session.csv"];
    let error = Folder::new().refused(&args);
    assert!(error.starts_with("none/session.csv: cannot be written"), "{error}");
}

#[test]
fn a_directory_as_output_is_refused() {
    let folder = with_session();
    std::fs::create_dir(folder.path("est")).expect("a temporary folder can be written to");
    let error = folder.refused(&replay_to("est"));
    assert!(error.starts_with("est: cannot be written"), "{error}");
}

#[test]
fn out_takes_one_session() {
    let folder = with_session();
    let error = folder.refused(&["replay", "session.csv", "session.csv", "--table", table(), "--out", "est.csv"]);
    assert!(error.contains("--out") && error.contains('2'), "{error}");
}

/// A slip of the hand must not cost a recording.
#[test]
fn the_session_itself_is_no_place_for_the_estimates() {
    with_session().refused(&force_to("session.csv"));
}

#[test]
fn the_session_by_another_name_is_no_place_for_the_estimates() {
    let folder = with_session();
    std::fs::create_dir(folder.path("sub")).expect("a temporary folder can be written to");
    folder.refused(&force_to("sub/../session.csv"));
}

#[cfg(unix)]
#[test]
fn a_link_to_the_session_is_no_place_for_the_estimates() {
    let folder = with_session();
    std::os::unix::fs::symlink("session.csv", folder.path("link.csv")).expect("a temporary folder can have links");
    folder.refused(&force_to("link.csv"));
}

#[test]
fn the_session_itself_is_no_place_for_the_table() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    folder.refused(&["calibrate", "sweep.csv", "--arm", arm(), "--force", "-o", "sweep.csv"]);
}

#[test]
fn the_table_itself_is_no_place_for_the_estimates() {
    let folder = with_session();
    std::fs::copy(table(), folder.path("table.toml")).expect("the reference table is committed");
    folder.refused(&["replay", "session.csv", "--table", "table.toml", "--force", "--out", "table.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_refused_and_stays_a_device() {
    use std::os::unix::fs::FileTypeExt;

    let is_device =
        || std::fs::symlink_metadata("/dev/full").is_ok_and(|metadata| metadata.file_type().is_char_device());
    assert!(is_device(), "Linux has /dev/full");
    let error = with_session().refused(&replay_to("/dev/full"));
    assert!(error.starts_with("/dev/full: cannot be written"), "{error}");
    assert!(is_device());
}

#[cfg(unix)]
#[test]
fn a_link_stays_a_link() {
    let folder = with_session();
    folder.write("real.csv", "old");
    std::os::unix::fs::symlink("real.csv", folder.path("link.csv")).expect("a temporary folder can have links");
    folder.done(&force_to("link.csv"));
    assert!(folder.path("link.csv").is_symlink());
    assert!(folder.read("real.csv").starts_with("time_s,"));
}

/// `--out /dev/stdout > est.csv`: the name is a link to a file that is open elsewhere.
#[cfg(target_os = "linux")]
#[test]
fn a_link_to_standard_output_stays_a_link() {
    let folder = with_session();
    std::os::unix::fs::symlink("/proc/self/fd/1", folder.path("stdout")).expect("a temporary folder can have links");
    let redirected = std::fs::File::create(folder.path("est.csv")).expect("a temporary folder can be written to");
    let status = folder.command(&replay_to("stdout")).stdout(redirected).status().expect("the tool starts");
    assert!(folder.path("stdout").is_symlink());
    assert!(status.success());
}

#[cfg(unix)]
#[test]
fn a_pipe_is_written_to_directly() {
    let folder = with_session();
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe")).status();
    if !made.is_ok_and(|status| status.success()) {
        println!("skipped: there is no mkfifo here");
        return;
    }
    let pipe = folder.path("pipe");
    let reader = std::thread::spawn(move || std::fs::read_to_string(pipe).expect("the pipe can be read"));
    folder.done(&replay_to("pipe"));
    let found = reader.join().expect("the reader ends with the pipe");
    folder.done(&replay_to("est.csv"));
    assert_eq!(found, folder.read("est.csv"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_whose_figures_cannot_be_printed_leaves_no_estimates() {
    let folder = with_session();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has /dev/full");
    let status = folder.command(&replay_to("est.csv")).stdout(full).status().expect("the tool starts");
    assert_eq!(status.code(), Some(2));
    assert!(!folder.path("est.csv").exists());
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_behind() {
    let folder = Folder::new();
    let arguments = ["simulate", "--scenario", "1", "--seconds", "1000000", "--seed", "1", "-o", "long.csv"];
    let mut child = folder.command(&arguments).spawn().expect("the tool starts");
    let files = || std::fs::read_dir(folder.path("")).expect("the folder is there").count();
    while files() == 0 {
        assert!(child.try_wait().expect("the tool runs").is_none(), "it ends before it has begun a file");
        std::thread::yield_now();
    }
    let interrupt = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(interrupt.expect("unix has kill").success());
    assert_eq!(child.wait().expect("the tool ends").code(), Some(130));
    assert_eq!(files(), 0);
}

#[test]
fn estimates_are_written_although_standard_output_is_closed() {
    let (reader, writer) = std::io::pipe().expect("the system has pipes");
    drop(reader);
    let folder = with_session();
    let status = folder.command(&replay_to("est.csv")).stdout(writer).status().expect("the tool starts");
    assert!(status.success());
    assert!(folder.read("est.csv").starts_with("time_s,"));
}

/// Bash's `--out >(gzip > est.csv.gz)`: a name under `/dev/fd` that links to a pipe.
#[cfg(target_os = "linux")]
#[test]
fn a_link_to_a_pipe_is_written_to_directly() {
    use std::io::Read;
    use std::os::fd::AsRawFd;

    let folder = with_session();
    let (mut reader, writer) = std::io::pipe().expect("the system has pipes");
    let name = format!("/proc/{}/fd/{}", std::process::id(), writer.as_raw_fd());
    let mut child = folder.command(&replay_to(&name)).stdout(std::process::Stdio::null()).spawn().expect("it starts");
    let mut begin = [0; 7];
    reader.read_exact(&mut begin).expect("the estimates come");
    std::thread::spawn(move || std::io::copy(&mut reader, &mut std::io::sink()));
    assert!(child.wait().expect("the tool ends").success());
    assert_eq!(&begin, b"time_s,");
}

/// A folder under `/dev` may hold ordinary files, as `/dev/shm` does.
#[cfg(target_os = "linux")]
#[test]
fn a_longer_file_in_shared_memory_is_replaced_whole() {
    let shared = tempfile::Builder::new().tempdir_in("/dev/shm").expect("Linux has /dev/shm");
    let path = shared.path().join("est.csv");
    std::fs::write(&path, "old\n".repeat(1_000_000)).expect("there is room");
    with_session().done(&force_to(path.to_str().expect("a plain name")));
    let estimates = std::fs::read_to_string(&path).expect("the estimates are there");
    assert!(estimates.starts_with("time_s,") && !estimates.contains("old"));
}

#[test]
fn each_command_has_a_manual_page_and_a_filled_folder_is_kept() {
    let folder = Folder::new();
    folder.done(&["man", "pages"]);
    let page = |name: &str| folder.read(&format!("pages/{name}.1"));
    let overview = page("proprio");
    let commands: Vec<&str> =
        overview.lines().filter_map(|line| line.strip_prefix(r"proprio\-")?.strip_suffix("(1)")).collect();
    assert!(commands.len() >= 20, "{overview}");
    for command in commands {
        let name = command.replace(r"\-", "-");
        assert!(name == "help" || page(&format!("proprio-{name}")).contains(".SH SYNOPSIS"), "{name}");
    }
    let error = folder.refused(&["man", "pages"]);
    assert!(error.starts_with("pages: "), "{error}");
}
