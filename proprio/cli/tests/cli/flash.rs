//! `proprio flash`, with programs that write down how they were called in place of the real ones.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;

use super::common::{Folder, Run, error_of, table};

const BUILD: &str = "cargo build --profile firmware -p firmware --target thumbv7m-none-eabi";
const ELF: &str = "target/thumbv7m-none-eabi/firmware/firmware";
const PROBE: &str = "echo 'The following debug probes were found:'; echo '[0]: J-Link -- 1366:0101:1 (J-Link)'";

/// A folder with a source and programs. The one that runs is written, with the table that it is given, into `called`.
struct Bench(Folder);

impl Bench {
    fn new() -> Self {
        let bench = Self(Folder::new());
        let programs = bench.0.path("bin");
        fs::create_dir_all(bench.0.path("source/firmware")).expect("there is room");
        fs::create_dir_all(bench.0.path("sysroot/lib/rustlib/host/bin")).expect("there is room");
        fs::create_dir_all(&programs).expect("there is room");
        bench.0.write("source/firmware/Cargo.toml", "");
        // The scripts need a shell, and no other program of this machine.
        symlink("/bin/sh", programs.join("sh")).expect("there is room");
        let sysroot = bench.0.path("sysroot");
        let rustc = format!("case $2 in sysroot) echo {};; host-tuple) echo host;; esac", sysroot.display());
        bench.script("bin/rustc", &rustc);
        bench.logged("bin/cargo", "");
        bench.logged("bin/bossac", "");
        bench.logged("sysroot/lib/rustlib/host/bin/rust-objcopy", "");
        bench
    }

    fn script(&self, name: &str, body: &str) {
        self.0.write(name, format!("#!/bin/sh\n{body}\n"));
        fs::set_permissions(self.0.path(name), fs::Permissions::from_mode(0o755)).expect("it is ours");
    }

    fn logged(&self, name: &str, then: &str) {
        let called = self.0.path("called");
        let log = format!("echo \"$PWD ${{PROPRIO_TABLE-}} ${{0##*/}} $*\" >> {}", called.display());
        self.script(name, &format!("{log}\n{then}"));
    }

    fn with_probe(self) -> Self {
        self.logged("bin/probe-rs", &format!("if [ $1 = list ]; then {PROBE}; fi"));
        self
    }

    fn flash(&self, arguments: &[&str]) -> Run {
        let arguments = [&["flash", "--table", table(), "--port", "/dev/no-such-port"], arguments].concat();
        let mut command = self.0.command(&arguments);
        fs::create_dir_all(self.0.path("tmp")).expect("there is room");
        command.env("PATH", self.0.path("bin")).env("TMPDIR", self.0.path("tmp")).env_remove("CARGO_TARGET_DIR");
        command.output().expect("the tool starts").into()
    }

    fn source(&self) -> String {
        self.0.path("source").display().to_string()
    }

    /// Environment variable with which rust-objcopy finds the toolchain's LLVM.
    fn libraries(&self) -> String {
        let name = if cfg!(target_os = "macos") { "DYLD_LIBRARY_PATH" } else { "LD_LIBRARY_PATH" };
        format!("{name}={}/lib", self.0.path("sysroot").display())
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

/// The last line but one, without its `error: `: programs may have printed lines before.
fn error(run: &Run) -> String {
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    let begin = run.stderr.find("error: ").unwrap_or_else(|| panic!("no error: {}", run.stderr));
    error_of(&run.stderr[begin..])
}

#[test]
fn a_dry_run_without_a_probe_prints_the_commands_of_the_programming_port() {
    let bench = Bench::new();
    let run = bench.flash(&["--source", "source", "--dry-run"]);
    let (source, table) = (bench.source(), table());
    let objcopy = bench.0.path("sysroot/lib/rustlib/host/bin/rust-objcopy");
    let image = bench.0.path("tmp/firmware.bin");
    let (libraries, objcopy, image) = (bench.libraries(), objcopy.display(), image.display());
    let expected = format!(
        "cd {source}\nPROPRIO_TABLE={table} {BUILD}\n{libraries} {objcopy} -O binary {ELF} {image}\n\
         bossac -a -p no-such-port -U0 -e -w -v -b -R {image}\n"
    );
    assert_eq!((run.stdout, run.code), (expected, Some(0)), "{}", run.stderr);
    assert!(bench.called().is_empty(), "nothing ran");
}

#[test]
fn a_dry_run_with_a_probe_prints_the_commands_of_probe_rs() {
    let bench = Bench::new().with_probe();
    let run = bench.flash(&["--source", "source", "--dry-run"]);
    let expected = format!(
        "cd {}\nPROPRIO_TABLE={} {BUILD}\nprobe-rs download --chip ATSAM3X8E --verify {ELF}\n\
         probe-rs reset --chip ATSAM3X8E\n",
        bench.source(),
        table()
    );
    assert_eq!((run.stdout, run.code), (expected, Some(0)), "{}", run.stderr);
    assert_eq!(bench.called().len(), 1, "the probes were listed, and nothing else ran");
}

#[test]
fn probe_rs_without_a_probe_leaves_it_to_bossac() {
    let bench = Bench::new();
    bench.script("bin/probe-rs", "echo 'No debug probes were found.'");
    let run = bench.flash(&["--source", "source", "--dry-run"]);
    assert!(run.stdout.contains("\nbossac -a -p no-such-port "), "{}{}", run.stdout, run.stderr);
}

#[test]
fn a_path_with_a_space_is_quoted_for_the_shell() {
    let bench = Bench::new();
    fs::rename(bench.0.path("source"), bench.0.path("my source")).expect("it is ours");
    let run = bench.flash(&["--source", "my source", "--dry-run"]);
    let expected = format!("cd '{}'\n", bench.0.path("my source").display());
    assert!(run.stdout.starts_with(&expected), "{}{}", run.stdout, run.stderr);
}

#[test]
fn what_a_dry_run_prints_is_what_runs_and_then_the_board_is_listened_to() {
    let bench = Bench::new();
    let run = bench.flash(&["--source", "source"]);
    let called = bench.called();
    let source = fs::canonicalize(bench.source()).expect("it is there").display().to_string();
    let [build, objcopy, bossac] = &called[..] else { panic!("{called:?}: {}", run.stderr) };
    assert_eq!(*build, format!("{source} {} {BUILD}", table()));
    let image = objcopy.strip_prefix(&format!("{source}  rust-objcopy -O binary {ELF} ")).expect("objcopy is second");
    assert_eq!(*bossac, format!("{source}  bossac -a -p no-such-port -U0 -e -w -v -b -R {image}"));
    assert!(!Path::new(image).exists(), "the image is gone");
    assert_eq!(bench.left_over(), 0);
    assert!(error(&run).contains("flashed, but not verified: /dev/no-such-port: cannot be opened"), "{}", run.stderr);
}

#[test]
fn a_command_that_fails_is_named_with_its_status_and_is_the_last() {
    let bench = Bench::new();
    bench.logged("bin/cargo", "echo 'it does not build'; exit 101");
    let run = bench.flash(&["--source", "source"]);
    let expected = format!("PROPRIO_TABLE={} {BUILD}: has failed (exit status: 101)", table());
    assert_eq!((error(&run), run.stdout.as_str()), (expected, ""));
    assert!(run.stderr.contains("it does not build"), "{}", run.stderr);
    assert_eq!((bench.called().len(), bench.left_over()), (1, 0), "{:?}", bench.called());
}

#[test]
fn without_bossac_nothing_is_built() {
    let bench = Bench::new();
    fs::remove_file(bench.0.path("bin/bossac")).expect("it is there");
    let run = bench.flash(&["--source", "source"]);
    assert_eq!(error(&run), "the program bossac is not on the PATH");
    assert!(run.stderr.contains("apt install bossa-cli"), "{}", run.stderr);
    assert_eq!((bench.called().len(), bench.left_over()), (0, 0));
}

#[test]
fn a_folder_that_is_not_the_source_is_refused() {
    let bench = Bench::new();
    let run = bench.flash(&["--source", "bin"]);
    assert_eq!(error(&run), "bin: is not the source of proprio, it has no firmware/Cargo.toml");
    assert!(run.stderr.contains("--source"), "{}", run.stderr);
    assert!(bench.called().is_empty());
}

#[test]
fn a_table_that_cannot_be_used_is_refused_before_anything_runs() {
    let bench = Bench::new().with_probe();
    bench.0.write("bad.toml", "arm = 1\n");
    let mut command = bench.0.command(&["flash", "--table", "bad.toml", "--source", "source"]);
    let run = command.env("PATH", bench.0.path("bin")).output().expect("the tool starts").into();
    assert!(error(&run).starts_with("bad.toml: "), "{}", run.stderr);
    assert!(bench.called().is_empty());
}

#[test]
fn an_interrupt_ends_it_after_the_command_that_runs_and_leaves_nothing() {
    let bench = Bench::new();
    // As Ctrl-C in a terminal, which both receive.
    bench.logged("bin/cargo", "kill -INT $PPID; /bin/sleep 1");
    let run = bench.flash(&["--source", "source"]);
    assert_eq!((run.code, run.stdout.as_str()), (Some(130), ""), "{}", run.stderr);
    assert_eq!((bench.called().len(), bench.left_over()), (1, 0), "{:?}", bench.called());
}
