//! Faults of bus, multiplexer, converter, line, memory, power and processor.

use telemetry::{Command, Message, ResetCause, TableStatus};

use super::measured::{Measured, Row, bend_noticed_ms, swinging, text_of, tip, with, within};
use crate::flash::table_addresses;
use crate::trial::Trial;

pub(super) const ROWS: &[(&str, Row)] = &[
    ("sda_held", sda_held),
    ("scl_held", scl_held),
    ("mux_silent", mux_silent),
    ("mux_stuck", mux_stuck),
    ("mux_wrong", mux_wrong),
    ("mux_lying", mux_lying),
    ("adc_stopped", adc_stopped),
    ("adc_tags", adc_tags),
    ("adc_tags_every_other", adc_tags_every_other),
    ("line_noise", line_noise),
    ("line_flood", line_flood),
    ("line_cut", line_cut),
    ("line_replay", line_replay),
    ("line_reorder", line_reorder),
    ("flash_flip", flash_flip),
    ("power_cut", power_cut),
    ("tick_held", tick_held),
    ("stack_overflow", stack_overflow),
];

/// Promise about scans that are all lost.
const SCANS_LOST: &str = "bend sensors not ok within 50 ms, scans counted as stale, no overrun";

fn overruns(trial: &Trial) -> u32 {
    trial.board.healths().next_back().map_or(u32::MAX, |health| health.overruns)
}

fn bus_held(row: &'static str, injected: &'static str) -> Measured {
    let trial = with(injected, 6_000);
    let has_imu =
        |message: &Message| matches!(message, Message::Sample(sample) if sample.imu.iter().any(Option::is_some));
    let last_ms = trial.timed(0.0, 6e3).filter(|(_, message)| has_imu(message)).map(|(ms, _)| ms).last().unwrap_or(0.0);
    let is_whole = |message: &Message| match message {
        Message::Estimate(estimate) => estimate.segments.iter().all(Option::is_some),
        _ => true,
    };
    let (is_whole, overruns) = (trial.received(0.0, 6e3).all(is_whole), overruns(&trial));
    let (tip, _) = tip(&trial, 0.0, 6e3);
    Measured {
        row,
        injected,
        promise: "no IMU used after 25 ms, an estimate of every segment by bend sensors, no overrun",
        measured: format!("last sample with an IMU after {last_ms:.1} ms; {overruns} overruns; {tip}"),
        holds: last_ms <= 25.0 && is_whole && overruns == 0,
    }
}

fn sda_held() -> Measured {
    bus_held("SDA held low", "sda:held")
}

fn scl_held() -> Measured {
    bus_held("SCL held low", "scl:held")
}

/// Samples after the fault in which an IMU's reading is nearer to another unit than to its own.
fn exchanged(row: &'static str, injected: &'static str) -> Measured {
    let mut trial = swinging();
    trial.inject(injected);
    let (mut wrong, mut samples) = (0, 0);
    for _ in 0..100 {
        trial.run_ms(10);
        let units = trial.board.machine.world().twin().imu_quaternions();
        let Some(sample) = trial.board.samples().next_back() else { continue };
        let distance = |read: [i16; 4], unit: usize| {
            let unit = units[unit].unwrap_or_default();
            read.iter().zip(unit).map(|(read, unit)| (f64::from(*read) - f64::from(unit)).abs()).sum::<f64>()
        };
        let is_exchanged = |(imu, read): (usize, &Option<[i16; 4]>)| {
            read.is_some_and(|read| (0..6).any(|other| distance(read, other) < distance(read, imu) - 400.0))
        };
        samples += 1;
        wrong += usize::from(sample.imu.iter().enumerate().any(is_exchanged));
    }
    let (tip, _) = tip(&trial, 0.0, 1e3);
    Measured {
        row,
        injected,
        promise: "never one IMU's reading under another's name",
        measured: format!("{wrong} of {samples} samples with another IMU's reading; {tip}"),
        holds: wrong == 0 && samples == 100,
    }
}

fn mux_silent() -> Measured {
    exchanged("multiplexer silent", "mux:silent")
}

fn mux_stuck() -> Measured {
    exchanged("multiplexer stuck", "mux:stuck")
}

fn mux_wrong() -> Measured {
    exchanged("multiplexer on the wrong channel, true read-back", "mux:wrong=1")
}

fn mux_lying() -> Measured {
    exchanged("multiplexer on the wrong channel, lying read-back", "mux:lying=1")
}

/// Scans that are lost: `promise` gives the limit, ms, within which the bend sensors are reported.
fn scans_lost(row: &'static str, injected: &'static str, promise: &'static str, limit_ms: f64) -> Measured {
    let mut trial = with(injected, 1_000);
    trial.board.clear(injected);
    trial.run_ms(1_000);
    let noticed = bend_noticed_ms(&trial, 0);
    let stale = trial.board.healths().next_back().map_or(0, |health| health.stale_scans);
    Measured {
        row,
        injected,
        promise,
        measured: format!("not ok after {}; {stale} stale scans; {} overruns", text_of(noticed), overruns(&trial)),
        holds: within(noticed, limit_ms) && stale > 0 && overruns(&trial) == 0,
    }
}

fn adc_stopped() -> Measured {
    scans_lost("converter stopped for 1 s", "adc:stopped", SCANS_LOST, 50.0)
}

fn adc_tags() -> Measured {
    scans_lost("PDC words with wrong tags for 1 s", "adc:tags", SCANS_LOST, 50.0)
}

fn adc_tags_every_other() -> Measured {
    let promise = "bend sensors not ok within 200 ms, scans counted as stale, no overrun";
    scans_lost("wrong tags in every second scan for 1 s", "adc:tags-every-other", promise, 200.0)
}

fn line_noise() -> Measured {
    let injected = "line:noise=0.002";
    let trial = with(injected, 8_000);
    let counts = trial.board.counts();
    let (tip, is_near) = tip(&trial, 0.0, 8e3);
    Measured {
        row: "noise on the serial line",
        injected,
        promise: "damaged frames are counted, no bad one is accepted, no overrun",
        measured: format!("{} damaged, {} lost; {} overruns; {tip}", counts.damaged, counts.lost, overruns(&trial)),
        holds: counts.damaged > 0 && overruns(&trial) == 0 && is_near,
    }
}

fn line_flood() -> Measured {
    let injected = "line:flood";
    let mut trial = swinging();
    let before = trial.board.samples().count();
    trial.inject(injected);
    trial.board.run_ms(4_000);
    let samples = trial.board.samples().count() - before;
    let latency_us = trial.board.healths().next_back().map_or(u32::MAX, |health| health.max_estimate_latency_us);
    Measured {
        row: "random bytes at line rate",
        injected,
        promise: "no overrun, every sample arrives, vented 1.5 s after the last set-point",
        measured: format!(
            "{} overruns, {samples} samples in 4 s, longest tick {latency_us} µs, vented: {}",
            overruns(&trial),
            trial.board.is_vented()
        ),
        holds: overruns(&trial) == 0 && samples >= 399 && trial.board.is_vented(),
    }
}

/// Time until the regulators are vented, ms.
fn vented_ms(trial: &mut Trial, limit_ms: u64) -> Option<u64> {
    (1..=limit_ms).find(|_| {
        trial.board.run_ms(1);
        trial.board.is_vented()
    })
}

fn line_cut() -> Measured {
    let injected = "line:cut";
    let mut trial = swinging();
    trial.inject(injected);
    let vented = vented_ms(&mut trial, 3_000);
    Measured {
        row: "host gone",
        injected,
        promise: "vented within 1.5 s",
        measured: format!("vented after {}", text_of(vented.map(|ms| ms as f64))),
        holds: vented.is_some_and(|ms| ms <= 1_500),
    }
}

fn line_replay() -> Measured {
    let injected = "line:replay=3";
    let mut trial = swinging();
    trial.inject(injected);
    trial.board.send(Command::Arm);
    trial.run_ms(1_000);
    // The host falls silent: the board vents and disarms, and the bytes of the last second arrive again.
    trial.board.run_ms(2_000);
    let is_vented_before = trial.board.is_vented();
    let mut is_moved = false;
    for _ in 0..300 {
        trial.board.run_ms(10);
        is_moved |= !trial.board.is_vented();
    }
    Measured {
        row: "bytes that arrive again 3 s later",
        injected,
        promise: "nothing moves",
        measured: format!("vented before: {is_vented_before}; pressure again: {is_moved}"),
        holds: is_vented_before && !is_moved,
    }
}

fn line_reorder() -> Measured {
    let injected = "line:reorder";
    let mut trial = with(injected, 4_000);
    let is_armed = !trial.board.is_vented();
    trial.board.send(Command::Disarm);
    trial.board.send(Command::Ping);
    trial.board.run_ms(100);
    Measured {
        row: "frames to the board in another order",
        injected,
        promise: "set-points go on, Disarm vents even when it is late",
        measured: format!("under pressure after 4 s: {is_armed}; vented by Disarm: {}", trial.board.is_vented()),
        holds: is_armed && trial.board.is_vented(),
    }
}

fn flash_flip() -> Measured {
    let mut trial = swinging();
    let stored = table_addresses();
    let (mut refused, mut flips) = (0, 0);
    for place in 0..12 {
        let fault = format!("flash:flip={}", stored[place * (stored.len() - 1) / 11]);
        trial.inject(&fault);
        trial.board.machine.press_reset();
        trial.board.run_ms(400);
        flips += 1;
        let status = trial.board.table_states().next_back().map(|state| state.status);
        refused += usize::from(status.is_some_and(|status| status != TableStatus::InUse));
        // The same bit again: whole.
        trial.inject(&fault);
    }
    Measured {
        row: "bits of the stored table flipped",
        injected: "flash:flip=…, 12 places of the table, each before a reset",
        promise: "the table is refused at boot",
        measured: format!("{refused} of {flips} refused"),
        holds: refused == flips,
    }
}

/// `Hello` after the fault, and its time, ms.
fn hello_after(trial: &Trial) -> Option<(f64, telemetry::Hello)> {
    trial.timed(0.0, 1e6).find_map(|(ms, message)| match message {
        Message::Hello(hello) => Some((ms, hello.clone())),
        _ => None,
    })
}

/// A fault that restarts the board.
fn restarted(row: &'static str, injected: &'static str, cause: ResetCause) -> Measured {
    let mut trial = swinging();
    trial.inject(injected);
    let vented = vented_ms(&mut trial, 1_000).map(|ms| ms as f64);
    trial.board.run_ms(2_000);
    let hello = hello_after(&trial);
    let found = hello.as_ref().map(|(_, hello)| hello.reset);
    Measured {
        row,
        injected,
        promise: "vented within 250 ms, the cause is reported, no pressure by itself",
        measured: format!(
            "vented after {}, `Hello` after {} with {found:?}, {:?}; vented 2 s later: {}",
            text_of(vented),
            text_of(hello.as_ref().map(|(ms, _)| *ms)),
            hello.as_ref().and_then(|(_, hello)| hello.last_panic.as_deref().map(ToOwned::to_owned)),
            trial.board.is_vented()
        ),
        holds: within(vented, 250.0) && found == Some(cause) && trial.board.is_vented(),
    }
}

fn power_cut() -> Measured {
    restarted("power cut", "power:cut", ResetCause::PowerOn)
}

fn tick_held() -> Measured {
    restarted("the tick's task held up", "irq27:masked", ResetCause::Watchdog)
}

fn stack_overflow() -> Measured {
    restarted("stack overflow", "stack:overflow", ResetCause::Software)
}
