//! Noise on the firmware's own line costs the host's link frames, each of them counted, and nothing else.

use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::process::Command;
use std::rc::Rc;
use std::time::Duration;

use proprio_link::{Baud, EventKind, Link, LinkState, PortSource, Subscription};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use telemetry::{Decoder, Message};

use crate::terminal::Terminal;
use crate::tools::{Running, done, folder, proprio, replayed, table};

/// Frames that are disturbed together, 40 ms of the stream.
const STRETCH: usize = 8;

/// A line that flips a bit, cuts a run of bytes out, or lets one come twice, once in every [`STRETCH`] of frames.
struct Noise {
    random: ChaCha8Rng,
    /// Frames before the noise begins.
    quiet: usize,
    /// Bytes of the frame that the board is sending.
    frame: Vec<u8>,
    stretch: Vec<Vec<u8>>,
    /// Frames that the board has sent, and bytes that came out of the line.
    sent: Vec<Vec<u8>>,
    received: Vec<u8>,
    /// Number of disturbances of each kind.
    done: [usize; 3],
}

impl Noise {
    fn new(seed: u64, quiet: usize) -> Self {
        let (random, frame, stretch) = (ChaCha8Rng::seed_from_u64(seed), Vec::new(), Vec::new());
        Self { random, quiet, frame, stretch, sent: Vec::new(), received: Vec::new(), done: [0; 3] }
    }

    /// Disturbs bytes of the board; returns those that come out, a stretch at a time.
    fn disturb(&mut self, bytes: Vec<u8>, is_noisy: bool) -> Vec<u8> {
        let mut out = Vec::new();
        for byte in bytes {
            self.frame.push(byte);
            if byte == 0 {
                self.stretch.push(std::mem::take(&mut self.frame));
            }
            if self.stretch.len() == STRETCH {
                out.extend(self.stretch_out(is_noisy));
            }
        }
        self.received.extend(&out);
        out
    }

    /// The first and the last frame of a stretch are not touched, so that a piece that comes twice has come whole before.
    fn stretch_out(&mut self, is_noisy: bool) -> Vec<u8> {
        let frames = std::mem::take(&mut self.stretch);
        let mut bytes = frames[1..STRETCH - 1].concat();
        if is_noisy && self.sent.len() >= self.quiet {
            let at = self.below(bytes.len());
            let run = at..bytes.len().min(at + 1 + self.below(300));
            let kind = self.below(3);
            self.done[kind] += 1;
            match kind {
                0 => bytes[at] ^= 1 << self.below(8),
                1 => drop(bytes.drain(run)),
                _ => {
                    let copy = bytes[run.clone()].to_vec();
                    bytes.splice(run.end..run.end, copy);
                }
            }
        }
        let out = [frames[0].clone(), bytes, frames[STRETCH - 1].clone()].concat();
        // A zero alone is no frame.
        self.sent.extend(frames.into_iter().filter(|frame| *frame != [0]));
        out
    }

    fn below(&mut self, end: usize) -> usize {
        self.random.next_u32() as usize % end
    }

    /// Runs of bytes between zeros that came out of the line.
    fn blocks(&self) -> impl Iterator<Item = &[u8]> {
        self.received.split_inclusive(|byte| *byte == 0).filter(|block| *block != [0])
    }
}

/// Messages and state of the link after ten seconds of noise.
fn listen(noise: &Rc<RefCell<Noise>>) -> (Vec<Message>, LinkState) {
    let mut terminal = Terminal::new();
    let source = PortSource::new(Some(terminal.port().to_owned()), Baud::default());
    let (link, events) = Link::start(Box::new(source), None).expect("a pseudo-terminal opens");
    let (is_noisy, is_over) = (Rc::new(Cell::new(true)), Rc::new(Cell::new(false)));
    let (line, noisy, over) = (Rc::clone(noise), Rc::clone(&is_noisy), Rc::clone(&is_over));
    terminal.disturb =
        Box::new(move |bytes| if over.get() { Vec::new() } else { line.borrow_mut().disturb(bytes, noisy.get()) });
    let mut messages = Vec::new();
    terminal.run_until(|machine| {
        is_noisy.set(machine.seconds() < 10.0);
        // Frames after the last disturbance reveal the frames that it has destroyed.
        is_over.set(machine.seconds() > 10.5);
        take(&events, &mut messages);
        is_over.get() && link.state().bytes == noise.borrow().received.len() as u64
    });
    take(&events, &mut messages);
    (messages, link.state())
}

fn take(events: &Subscription, messages: &mut Vec<Message>) {
    while let Some(event) = events.next(Duration::ZERO) {
        match event.kind {
            EventKind::Message(message) => messages.push(message),
            EventKind::Opened(_) | EventKind::Bytes(_) | EventKind::SetPoints(_) | EventKind::Undecoded(_) => {}
            other => panic!("one run of one board: {other:?}"),
        }
    }
}

#[test]
fn noise_on_the_firmwares_line_costs_frames_that_are_counted_and_no_bad_one_is_accepted() {
    // The first frames contain the `Hello`, from which frames are counted.
    let noise = Rc::new(RefCell::new(Noise::new(6, 8)));
    let (accepted, state) = listen(&noise);
    let noise = noise.borrow();
    assert!(noise.done.iter().all(|times| *times > 40), "{:?}", noise.done);

    // Decided by the bytes alone: a frame has arrived whole where its bytes stand between two zeros.
    let sent: HashSet<&[u8]> = noise.sent.iter().map(Vec::as_slice).collect();
    assert_eq!(sent.len(), noise.sent.len(), "frames are numbered");
    let whole: Vec<&[u8]> = noise.blocks().filter(|block| sent.contains(block)).collect();
    let mut decoder = Decoder::new();
    let decoded =
        |frame: &&[u8]| frame.iter().find_map(|byte| decoder.push(*byte)).expect("a frame").expect("it is whole");
    assert_eq!(accepted, whole.iter().map(decoded).collect::<Vec<Message>>());

    let arrived: HashSet<&[u8]> = whole.into_iter().collect();
    let destroyed = sent.difference(&arrived).count();
    assert!(destroyed > 100, "{destroyed} frames");
    assert_eq!(state.counts.lost as usize, destroyed);
    assert_eq!(state.counts.damaged as usize, noise.blocks().filter(|block| !sent.contains(block)).count());
    assert_eq!((state.restarts, state.reopened), (0, 0));
}

#[test]
fn a_recording_over_a_noisy_line_replays_bit_for_bit_what_has_no_gap_before_it() {
    let folder = folder("noise");
    let mut terminal = Terminal::new();
    let arguments = ["record", "--port", terminal.port(), "-o", "noisy.mcap", "--table", &table()];
    let mut recorder = Running(proprio(&folder, &arguments).spawn().expect("the tool starts"));
    let noise = Rc::new(RefCell::new(Noise::new(7, 800)));
    let line = Rc::clone(&noise);
    terminal.disturb = Box::new(move |bytes| line.borrow_mut().disturb(bytes, true));
    terminal.run_until(|machine| machine.seconds() > 10.0);
    assert!(Command::new("kill").args(["-INT", &recorder.0.id().to_string()]).status().expect("kill starts").success());
    assert!(recorder.0.wait().expect("it has ended").success());
    let (equal, report) = replayed(&folder, "noisy.mcap");
    assert!(equal > 300, "{report}");
    assert!(report.contains("\"table_matches\":true"), "{report}");
    done(&folder, &["convert", "noisy.mcap", "noisy.bin"]);
    let recorded = std::fs::read(folder.join("noisy.bin")).expect("it was written");
    assert!(noise.borrow().received.starts_with(&recorded), "every byte is recorded as it came");
}
