//! `proprio flash`, with programs that write down how they were called in place of the real ones.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;

use super::common::{Folder, Run, error_of, json, table};

const BUILD: &str = "cargo build --profile firmware -p firmware --target thumbv7m-none-eabi";
const PROBE: &str = "echo 'The following debug probes were found:'; echo '[0]: J-Link -- 1366:0101:1 (J-Link)'";
const ARDUINO: &str = if cfg!(target_os = "macos") { "Library/Arduino15" } else { ".arduino15" };

/// Start of every image here: a stack pointer in SRAM and a reset vector in flash.
const VECTORS: [u8; 8] = [0x00, 0x80, 0x00, 0x20, 0xF9, 0x00, 0x08, 0x00];

/// The image of [`elf`] at the start of the flash.
fn image() -> Vec<u8> {
    [&VECTORS[..], &[0xFF; 8], b"data"].concat()
}

/// An ELF file for ARM with two loadable segments: the vectors at `start`, and four bytes, eight bytes behind them.
fn elf(start: u32) -> Vec<u8> {
    let mut file = b"\x7FELF\x01\x01\x01\0\0\0\0\0\0\0\0\0\x02\0\x28\0\x01\0\0\0".to_vec();
    // Entry, program headers, section headers, flags; then sizes and counts of the headers.
    let mut words = |words: &[u32]| words.iter().for_each(|word| file.extend(word.to_le_bytes()));
    words(&[start + 0xF9, 52, 0, 0x0500_0000, 0x0020_0034, 2, 0]);
    words(&[1, 116, start, start, 8, 8, 5, 4]);
    words(&[1, 124, 0x2000_8000, start + 16, 4, 4, 6, 4]);
    [&file[..], &VECTORS, b"data"].concat()
}

/// A folder with firmware and programs, which write down their calls in `called`.
struct Bench(Folder);

impl Bench {
    fn new() -> Self {
        let bench = Self(Folder::new());
        for folder in ["bin", "home", "tmp"] {
            fs::create_dir_all(bench.0.path(folder)).expect("there is room");
        }
        bench.0.write("firmware.elf", elf(0x0008_0000));
        bench.0.write("firmware.bin", image());
        // The scripts need a shell, and no other program of this machine.
        symlink("/bin/sh", bench.0.path("bin/sh")).expect("there is room");
        bench.logged("bin/bossac", "for last; do :; done; /bin/cp \"$last\" flashed");
        bench
    }

    fn script(&self, name: &str, body: &str) {
        let path = self.0.path(name);
        fs::create_dir_all(path.parent().expect("it is in the folder")).expect("there is room");
        self.0.write(name, format!("#!/bin/sh\n{body}\n"));
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("it is ours");
    }

    fn logged(&self, name: &str, then: &str) {
        let called = self.0.path("called");
        self.script(name, &format!("echo \"${{0##*/}} $*\" >> {}\n{then}", called.display()));
    }

    fn with_probe(self) -> Self {
        self.script(
            "bin/probe-rs",
            &format!("if [ $1 = list ]; then {PROBE}; exit; fi\necho \"probe-rs $*\" >> called"),
        );
        self
    }

    /// Without bossac on the PATH, with those of an Arduino IDE.
    fn with_arduino(self, versions: &[&str], then: &str) -> Self {
        fs::remove_file(self.0.path("bin/bossac")).expect("it is there");
        for version in versions {
            self.logged(&format!("home/{ARDUINO}/packages/arduino/tools/bossac/{version}/bossac"), then);
        }
        self
    }

    fn with_source(self, folder: &str, then: &str) -> Self {
        fs::create_dir_all(self.0.path(folder).join("firmware")).expect("there is room");
        self.0.write(&format!("{folder}/firmware/Cargo.toml"), "");
        let built = "target/thumbv7m-none-eabi/firmware";
        let build = format!("/bin/mkdir -p {built}; /bin/cp {} {built}/firmware", self.path("firmware.elf"));
        self.logged("bin/cargo", &format!("{build}; {then}"));
        self
    }

    fn flash(&self, arguments: &[&str]) -> Run {
        self.flash_port("/dev/no-such-port", arguments)
    }

    fn flash_port(&self, port: &str, arguments: &[&str]) -> Run {
        let arguments = [&["flash", "--table", table(), "--port", port], arguments].concat();
        self.run(&mut self.0.command(&arguments))
    }

    fn run(&self, command: &mut std::process::Command) -> Run {
        command.env("PATH", self.0.path("bin")).env("TMPDIR", self.0.path("tmp")).env("HOME", self.0.path("home"));
        command.env_remove("CARGO_TARGET_DIR").output().expect("the tool starts").into()
    }

    fn path(&self, name: &str) -> String {
        self.0.path(name).display().to_string()
    }

    /// Programs that ran, in their order, with their arguments.
    fn called(&self) -> Vec<String> {
        let log = fs::read_to_string(self.0.path("called")).unwrap_or_default();
        log.lines().map(str::to_owned).collect()
    }

    fn left_over(&self) -> usize {
        fs::read_dir(self.0.path("tmp")).expect("it is there").count()
    }
}

/// The lines of a dry run, which has run nothing, without the last.
fn dry_run(bench: &Bench, arguments: &[&str]) -> Vec<String> {
    let run = bench.flash(&[arguments, &["--dry-run"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(bench.called().is_empty(), "{:?}", bench.called());
    let mut lines: Vec<String> = run.stdout.lines().map(str::to_owned).collect();
    assert_eq!(lines.pop(), Some(format!("proprio table push {} --port /dev/no-such-port", table())));
    lines
}

/// The last line but one, without its `error: `: programs may have printed lines before.
fn error(run: &Run) -> String {
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    let begin = run.stderr.find("error: ").unwrap_or_else(|| panic!("no error: {}", run.stderr));
    error_of(&run.stderr[begin..])
}

#[test]
fn a_dry_run_without_a_probe_prints_the_command_of_bossac() {
    let bench = Bench::new();
    let (image, bossac) = (bench.path("tmp/firmware.bin"), "bossac -a -p no-such-port -U0 -e -w -v -b");
    assert_eq!(
        dry_run(&bench, &["--firmware", "firmware.elf"]),
        [format!("# proprio writes the plain image of firmware.elf to {image}"), format!("{bossac} {image}")]
    );
    assert_eq!(dry_run(&bench, &["--firmware", "firmware.bin"]), [format!("{bossac} firmware.bin")]);
}

#[test]
fn a_dry_run_with_a_probe_prints_the_commands_of_probe_rs() {
    let bench = Bench::new().with_probe();
    let reset = "probe-rs reset --chip ATSAM3X8E";
    let download = "probe-rs download --chip ATSAM3X8E --verify";
    assert_eq!(dry_run(&bench, &["--firmware", "firmware.elf"]), [&format!("{download} firmware.elf"), reset]);
    let plain = format!("{download} --binary-format bin --base-address 0x80000 firmware.bin");
    assert_eq!(dry_run(&bench, &["--firmware", "firmware.bin"]), [&plain, reset]);
}

#[test]
fn a_dry_run_without_a_board_stands_in_for_its_port() {
    let bench = Bench::new();
    let ports = json(&bench.0.done(&["ports", "--json"]));
    if ports.as_array().expect("a list").iter().any(|port| port["kind"] == "due_programming") {
        return;
    }
    let arguments = ["flash", "--table", table(), "--firmware", "firmware.bin", "--dry-run"];
    let run = bench.run(&mut bench.0.command(&arguments));
    let expected =
        format!("bossac -a -p PORT -U0 -e -w -v -b firmware.bin\nproprio table push {} --port PORT\n", table());
    assert_eq!((run.stdout, run.code), (expected, Some(0)), "{}", run.stderr);
}

#[test]
fn probe_rs_without_a_probe_leaves_it_to_bossac() {
    let bench = Bench::new();
    bench.script("bin/probe-rs", "echo 'No debug probes were found.'");
    assert!(dry_run(&bench, &["--firmware", "firmware.bin"])[0].starts_with("bossac -a "));
}

#[test]
fn without_bossac_on_the_path_that_of_an_arduino_ide_for_the_due_is_used() {
    // Its versions for other boards have other arguments.
    let bench = Bench::new().with_arduino(&["1.9.1-arduino5", "1.7.0-arduino3", "1.6.1-arduino"], "");
    let bossac = bench.path(&format!("home/{ARDUINO}/packages/arduino/tools/bossac/1.6.1-arduino/bossac"));
    assert_eq!(
        dry_run(&bench, &["--firmware", "firmware.bin"]),
        [
            "# proprio opens /dev/no-such-port at 1200 Bd with DTR off, and closes it".to_owned(),
            format!("{bossac} --port=no-such-port -U false -e -w -v -b firmware.bin -R")
        ]
    );
}

#[cfg(target_os = "linux")]
#[test]
fn before_the_bossac_of_an_arduino_ide_the_port_is_opened_at_1200_bd() {
    use serialport::SerialPort;
    let bench = Bench::new().with_arduino(&["1.6.1-arduino"], "exit 1");
    let (board, host) = serialport::TTYPort::pair().expect("pseudo-terminals are there");
    let port = host.name().expect("it has a path");
    drop(host);
    let run = bench.flash_port(&port, &["--firmware", "firmware.bin"]);
    let name = port.strip_prefix("/dev/").expect("a path of Linux");
    assert_eq!(bench.called(), [format!("bossac --port={name} -U false -e -w -v -b firmware.bin -R")]);
    assert!(error(&run).ends_with("-R: has failed (exit status: 1)"), "{}", run.stderr);
    assert_eq!(board.baud_rate().expect("the last speed of the line"), 1200);
}

#[test]
fn a_port_that_cannot_be_touched_is_named_and_bossac_does_not_run() {
    let bench = Bench::new().with_arduino(&["1.6.1-arduino"], "");
    let run = bench.flash(&["--firmware", "firmware.bin"]);
    assert!(error(&run).starts_with("/dev/no-such-port: cannot be opened at 1200 Bd"), "{}", run.stderr);
    assert!(bench.called().is_empty());
}

#[test]
fn without_a_program_that_flashes_nothing_runs_not_even_a_dry_run() {
    // The IDE has a bossac, but not that of the Due.
    let bench = Bench::new().with_arduino(&["1.9.1-arduino5"], "").with_source("source", "");
    for arguments in [&["--from-source", "source"][..], &["--firmware", "firmware.elf", "--dry-run"]] {
        let run = bench.flash(arguments);
        let message = error(&run);
        assert!(message.contains("bossac is neither on the PATH nor"), "{message}");
        assert!(message.ends_with(&bench.path(&format!("home/{ARDUINO}/packages/arduino/tools/bossac"))), "{message}");
        assert!(run.stderr.contains("apt install bossa-cli"), "{}", run.stderr);
        assert_eq!((bench.called().len(), bench.left_over()), (0, 0));
    }
}

#[test]
fn what_a_dry_run_prints_is_what_runs_and_then_the_board_is_listened_to() {
    let bench = Bench::new();
    let run = bench.flash(&["--firmware", "firmware.elf"]);
    let called = bench.called();
    let [bossac] = &called[..] else { panic!("{called:?}: {}", run.stderr) };
    let file = bossac.strip_prefix("bossac -a -p no-such-port -U0 -e -w -v -b ").expect("the command of the dry run");
    assert!(!Path::new(file).exists(), "the image is gone");
    assert_eq!(bench.left_over(), 0);
    assert_eq!(fs::read(bench.0.path("flashed")).expect("bossac ran"), image());
    assert!(error(&run).contains("flashed, but not verified: /dev/no-such-port: cannot be opened"), "{}", run.stderr);
}

#[test]
fn with_a_probe_the_elf_file_is_downloaded_and_the_chip_reset() {
    let bench = Bench::new().with_probe();
    bench.flash(&["--firmware", "firmware.elf"]);
    assert_eq!(
        bench.called(),
        ["probe-rs download --chip ATSAM3X8E --verify firmware.elf", "probe-rs reset --chip ATSAM3X8E"]
    );
}

#[test]
fn from_source_the_firmware_is_built_in_its_folder_and_then_flashed() {
    let bench = Bench::new().with_source("my source", "");
    let built = "my source/target/thumbv7m-none-eabi/firmware/firmware";
    assert_eq!(
        dry_run(&bench, &["--from-source", "my source"])[..2],
        [
            format!("(cd 'my source' && {BUILD})"),
            format!("# proprio writes the plain image of {built} to {}", bench.path("tmp/firmware.bin"))
        ]
    );
    // The name of the option in version 0.1.
    assert_eq!(dry_run(&bench, &["--source", "my source"]), dry_run(&bench, &["--from-source", "my source"]));
    bench.flash(&["--from-source", "my source"]);
    assert_eq!(bench.called()[0], BUILD);
    assert_eq!(fs::read(bench.0.path("flashed")).expect("bossac ran"), image());
    assert!(bench.0.path(built).is_file(), "it was built in that folder");
}

#[test]
fn a_folder_that_is_not_the_source_is_refused() {
    let bench = Bench::new();
    let run = bench.flash(&["--from-source", "bin"]);
    assert_eq!(error(&run), "bin: is not the source of proprio, it has no firmware/Cargo.toml");
    assert!(bench.called().is_empty());
}

#[test]
fn the_firmware_beside_the_program_is_the_default() {
    let bench = Bench::new();
    let release = bench.0.path("release");
    fs::create_dir(&release).expect("there is room");
    fs::copy(env!("CARGO_BIN_EXE_proprio"), release.join("proprio")).expect("there is room");
    let flash = || {
        let mut command = std::process::Command::new(release.join("proprio"));
        command.current_dir(bench.0.path("home"));
        bench.run(command.args(["flash", "--table", table(), "--port", "p", "--dry-run"]))
    };
    let missing = error(&flash());
    assert!(
        missing.starts_with("target/thumbv7m-none-eabi/firmware/firmware: the firmware cannot be read"),
        "{missing}"
    );
    fs::rename(bench.0.path("firmware.elf"), release.join("firmware.elf")).expect("it is ours");
    let run = flash();
    let beside = fs::canonicalize(release.join("firmware.elf")).expect("it is there");
    assert!(run.stdout.contains(&format!("image of {} to", beside.display())), "{}{}", run.stdout, run.stderr);
}

#[test]
fn a_file_that_is_no_firmware_for_the_due_is_refused_before_anything_runs() {
    let bench = Bench::new();
    // An STM32's flash.
    bench.0.write("other.elf", elf(0x0800_0000));
    bench.0.write("cut.elf", &elf(0x0008_0000)[..60]);
    bench.0.write("other.bin", [0; 64]);
    let reasons = [
        ("other.elf", "8 bytes are linked to 0x08000000, outside flash (0x00080000 to 0x000fffff)"),
        ("cut.elf", "not a 32-bit ELF file"),
        ("other.bin", "begins with the words 0x00000000 and 0x00000000"),
    ];
    for (file, reason) in reasons {
        let run = bench.flash(&["--firmware", file]);
        assert!(error(&run).starts_with(&format!("{file}: {reason}")), "{}", run.stderr);
        assert!(bench.called().is_empty(), "{:?}", bench.called());
    }
}

#[test]
fn a_command_that_fails_is_named_with_its_status_and_is_the_last() {
    let bench = Bench::new().with_source("source", "echo 'it does not build'; exit 101");
    let run = bench.flash(&["--from-source", "source"]);
    let expected = format!("(cd source && {BUILD}): has failed (exit status: 101)");
    assert_eq!((error(&run), run.stdout.as_str()), (expected, ""));
    assert!(run.stderr.contains("it does not build"), "{}", run.stderr);
    assert_eq!((bench.called().len(), bench.left_over()), (1, 0), "{:?}", bench.called());
}

#[test]
fn a_table_that_cannot_be_used_is_refused_before_anything_runs() {
    let bench = Bench::new().with_probe();
    bench.0.write("bad.toml", "arm = 1\n");
    let run = bench.run(&mut bench.0.command(&["flash", "--table", "bad.toml", "--firmware", "firmware.bin"]));
    assert!(error(&run).starts_with("bad.toml: "), "{}", run.stderr);
    assert!(bench.called().is_empty());
}

#[test]
fn an_interrupt_ends_it_after_the_command_that_runs_and_leaves_nothing() {
    // As Ctrl-C in a terminal, which both receive.
    let bench = Bench::new().with_source("source", "kill -INT $PPID; /bin/sleep 1");
    let run = bench.flash(&["--from-source", "source"]);
    assert_eq!((run.code, run.stdout.as_str()), (Some(130), ""), "{}", run.stderr);
    assert_eq!((bench.called().len(), bench.left_over()), (1, 0), "{:?}", bench.called());
}
