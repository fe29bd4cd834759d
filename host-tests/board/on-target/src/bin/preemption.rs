//! The order in which tasks run, as a trace with a letter for each step.
//!
//! Capitals are where a task begins, small letters where it ends: low, middle, neighbour (of the middle's priority) and
//! high. Brackets are where a lock or a critical section begins and ends: `(` up to the middle's priority, `{` up to the
//! highest, `[` everything. A dot is the instruction after an interrupt was pended.
#![no_std]
#![no_main]

use core::sync::atomic::{AtomicU8, AtomicUsize, Ordering::Relaxed};

use on_target_tests as _;

const ROOM: usize = 32;
static TRACE: [AtomicU8; ROOM] = [const { AtomicU8::new(0) }; ROOM];
static LENGTH: AtomicUsize = AtomicUsize::new(0);
static SCENE: AtomicU8 = AtomicU8::new(0);

/// Writes a letter; any task may, at any time.
fn note(letter: u8) {
    TRACE[LENGTH.fetch_add(1, Relaxed)].store(letter, Relaxed);
}

fn scene() -> u8 {
    SCENE.load(Relaxed)
}

#[rtic::app(device = atsam3x8e_hal::pac)]
mod app {
    use core::fmt::Write;
    use core::sync::atomic::Ordering::Relaxed;

    use atsam3x8e_hal::pac::Interrupt;
    use cortex_m::interrupt;
    use cortex_m::peripheral::NVIC;
    use on_target_tests::line::Line;

    use crate::{LENGTH, SCENE, TRACE, note, scene};

    const LOW: Interrupt = Interrupt::SSC;
    const MIDDLE: Interrupt = Interrupt::HSMCI;
    const NEIGHBOUR: Interrupt = Interrupt::SPI0;
    const HIGH: Interrupt = Interrupt::DACC;

    #[shared]
    struct Shared {
        with_middle: (),
        with_high: (),
    }

    #[local]
    struct Local {
        line: Line,
    }

    #[init]
    fn init(cx: init::Context) -> (Shared, Local) {
        (Shared { with_middle: (), with_high: () }, Local { line: Line::open(cx.device) })
    }

    #[idle(local = [line])]
    fn idle(cx: idle::Context) -> ! {
        let line = cx.local.line;
        let mut play = |name, start: fn()| {
            LENGTH.store(0, Relaxed);
            SCENE.store(scene() + 1, Relaxed);
            start();
            let _ = write!(line, "{name} ");
            for letter in TRACE.iter().take(LENGTH.load(Relaxed)) {
                let _ = line.write_char(letter.load(Relaxed).into());
            }
            let _ = line.write_char('\n');
        };
        play("lock", || rtic::pend(LOW));
        play("nested", || rtic::pend(LOW));
        play("chain", || rtic::pend(LOW));
        play("from-above", || rtic::pend(HIGH));
        play("again", || rtic::pend(MIDDLE));
        play("critical", || with_interrupts_off(&[LOW, HIGH, MIDDLE]));
        play("equals", || with_interrupts_off(&[NEIGHBOUR, MIDDLE]));
        play("unpended", || {
            interrupt::free(|_| {
                rtic::pend(LOW);
                rtic::pend(HIGH);
                NVIC::unpend(HIGH);
            });
        });
        let _ = line.write_str("end\n");
        loop {
            cortex_m::asm::wfi();
        }
    }

    fn with_interrupts_off(pended: &[Interrupt]) {
        interrupt::free(|_| {
            note(b'[');
            for interrupt in pended {
                rtic::pend(*interrupt);
                note(b'.');
            }
            note(b']');
        });
    }

    #[task(binds = SSC, priority = 1, shared = [with_middle, with_high])]
    fn low(mut cx: low::Context) {
        note(b'L');
        match scene() {
            1 => cx.shared.with_middle.lock(|()| {
                note(b'(');
                rtic::pend(MIDDLE);
                note(b'.');
                rtic::pend(HIGH);
                note(b')');
            }),
            2 => cx.shared.with_middle.lock(|()| {
                note(b'(');
                cx.shared.with_high.lock(|()| {
                    note(b'{');
                    rtic::pend(MIDDLE);
                    rtic::pend(HIGH);
                    note(b'.');
                    note(b'}');
                });
                note(b')');
            }),
            3 => rtic::pend(MIDDLE),
            _ => {}
        }
        note(b'l');
    }

    #[task(binds = HSMCI, priority = 2, shared = [with_middle])]
    fn middle(_: middle::Context) {
        note(b'M');
        match scene() {
            3 => rtic::pend(HIGH),
            // It ends before it begins again.
            5 if LENGTH.load(Relaxed) == 1 => {
                rtic::pend(MIDDLE);
                note(b'.');
            }
            _ => {}
        }
        note(b'm');
    }

    #[task(binds = SPI0, priority = 2)]
    fn neighbour(_: neighbour::Context) {
        note(b'N');
        note(b'n');
    }

    #[task(binds = DACC, priority = 3, shared = [with_high])]
    fn high(_: high::Context) {
        note(b'H');
        if scene() == 4 {
            rtic::pend(LOW);
            rtic::pend(MIDDLE);
            note(b'.');
        }
        note(b'h');
    }
}
