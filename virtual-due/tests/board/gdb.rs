//! The GDB server, as a debugger sees it: packets of the remote protocol over TCP.

use crate::program::{ENTRY, firmware};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

/// movs r0, #0; loop: adds r0, #1; ldr r1, =0x20070000; str r0, [r1]; b loop
const COUNTER: [u16; 8] = [0x2000, 0x3001, 0x4901, 0x6008, 0xE7FB, 0xBF00, 0x0000, 0x2007];
const LOOP: u32 = ENTRY + 2;
const RAM: u32 = 0x2007_0000;

/// A debugger that is connected to a board.
struct Debugger {
    board: Child,
    stream: TcpStream,
}

impl Debugger {
    fn connect(name: &str) -> Self {
        let elf = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&elf, firmware(&COUNTER, 0)).expect("a place for the file");
        let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-due"));
        command.args(["run", "--seconds", "3", "--gdb", "0"]).arg(&elf).stdin(Stdio::null()).stderr(Stdio::piped());
        let mut board = command.spawn().expect("the command");
        let mut line = String::new();
        let messages = board.stderr.as_mut().expect("its messages");
        BufReader::with_capacity(1, messages).read_line(&mut line).expect("where it waits");
        let address = line.trim().strip_prefix("waiting for GDB: target remote ").expect("where it waits");
        let stream = TcpStream::connect(address).expect("the server");
        Self { board, stream }
    }

    fn byte(&mut self) -> u8 {
        let mut byte = [0];
        self.stream.read_exact(&mut byte).expect("an answer");
        byte[0]
    }

    /// Sends a packet; returns the answer.
    fn request(&mut self, packet: &str) -> String {
        self.send(packet);
        self.answer()
    }

    fn send(&mut self, packet: &str) {
        let sum = packet.bytes().fold(0, u8::wrapping_add);
        self.stream.write_all(format!("${packet}#{sum:02x}").as_bytes()).expect("the server");
        assert_eq!(self.byte(), b'+', "{packet}");
    }

    fn answer(&mut self) -> String {
        while self.byte() != b'$' {}
        let mut text = Vec::new();
        loop {
            match self.byte() {
                b'#' => break,
                byte => text.push(byte),
            }
        }
        let (_, _) = (self.byte(), self.byte());
        self.stream.write_all(b"+").expect("the server");
        expand(&text)
    }

    /// Runs until the board stops; the answer is a signal, here that of a breakpoint or a step.
    fn resume(&mut self, packet: &str) {
        let answer = self.request(packet);
        assert!(answer.starts_with("T05") || answer == "S05", "{packet}: {answer}");
    }

    /// A register, of GDB's numbers.
    fn register(&mut self, number: usize) -> u32 {
        let all = self.request("g");
        let bytes = u32::from_str_radix(&all[8 * number..8 * number + 8], 16).expect("hexadecimal");
        bytes.swap_bytes()
    }

    fn word(&mut self, address: u32) -> u32 {
        let answer = self.request(&format!("m{address:x},4"));
        u32::from_str_radix(&answer, 16).expect("hexadecimal").swap_bytes()
    }
}

impl Drop for Debugger {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.board.kill();
        let _ = self.board.wait();
    }
}

/// Expands run lengths: a character, `*`, and a count with 29 added.
fn expand(text: &[u8]) -> String {
    let mut expanded = Vec::new();
    let mut bytes = text.iter().copied();
    while let Some(byte) = bytes.next() {
        if byte == b'*' {
            let count = bytes.next().expect("a run's length") - 29;
            let last = *expanded.last().expect("what is repeated");
            expanded.extend((0..count).map(|_| last));
        } else {
            expanded.push(byte);
        }
    }
    String::from_utf8(expanded).expect("text")
}

#[test]
fn board_waits_at_its_first_instruction_and_steps_one_by_one() {
    let mut debugger = Debugger::connect("gdb-step.elf");
    assert_eq!(debugger.register(15), ENTRY);
    debugger.resume("s");
    assert_eq!((debugger.register(15), debugger.register(0)), (LOOP, 0));
    debugger.resume("s");
    assert_eq!((debugger.register(15), debugger.register(0)), (LOOP + 2, 1));
}

#[test]
fn board_stops_at_a_breakpoint_each_time_until_it_is_removed() {
    let mut debugger = Debugger::connect("gdb-breakpoint.elf");
    assert_eq!(debugger.request(&format!("Z0,{LOOP:x},2")), "OK");
    for count in 0..3 {
        debugger.resume("c");
        assert_eq!((debugger.register(15), debugger.register(0)), (LOOP, count));
    }
    assert_eq!(debugger.request(&format!("z0,{LOOP:x},2")), "OK");
    // To the end of the run.
    assert_eq!(debugger.request("c"), "W00");
}

#[test]
fn memory_and_registers_are_read_and_written() {
    let mut debugger = Debugger::connect("gdb-memory.elf");
    assert_eq!(debugger.request(&format!("Z0,{LOOP:x},2")), "OK");
    debugger.resume("c");
    debugger.resume("c");
    assert_eq!(debugger.word(RAM), 1);
    assert_eq!(debugger.request(&format!("M{RAM:x},4:78563412")), "OK");
    assert_eq!(debugger.word(RAM), 0x1234_5678);
    // r0 = 41, and the loop adds one.
    let all = debugger.request("g");
    assert_eq!(debugger.request(&format!("G29000000{}", &all[8..])), "OK");
    debugger.resume("c");
    assert_eq!(debugger.word(RAM), 42);
    // CHIPID_CIDR, PMC_IMR and SCB_CPUID.
    assert_eq!((debugger.word(0x400E_0940), debugger.word(0xE000_ED00)), (0x285E_0A60, 0x412F_C230));
    assert_eq!(debugger.request("m60000000,4").get(..1), Some("E"));
}

#[test]
fn ctrl_c_stops_a_running_board_and_a_detached_one_runs_to_its_end() {
    let mut debugger = Debugger::connect("gdb-interrupt.elf");
    debugger.send("c");
    debugger.stream.write_all(&[3]).expect("the server");
    let answer = debugger.answer();
    assert!(answer.starts_with("T02") || answer == "S02" || answer == "W00", "{answer}");
    if answer != "W00" {
        assert_eq!(debugger.request("D"), "OK");
        assert_eq!(debugger.board.wait().expect("its end").code(), Some(0));
    }
}
