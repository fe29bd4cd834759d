//! `proprio status`.

use proprio_link::status::{KnownShape, Status};
use proprio_session::recording::chip_number;
use proprio_session::{Ellipse, degradations};
use telemetry::{Health, Hello, Rates, SensorHealth, SensorState, TICK_HZ, protocol_2};

use super::link;
use crate::error::Error;
use crate::terminal;
use crate::{args, text_tables};

pub fn run(args: &args::StatusArgs) -> Result<(), Error> {
    let status = if let Some(monitor) = link::monitor(&args.link) {
        let checksum = args.link.table.as_deref().map(link::table_checksum).transpose()?;
        let status = monitor.status()?;
        let table_matches = checksum.map(|checksum| checksum == status.hello.table);
        Status { table_matches, ..status }
    } else {
        let (table, link, events) = link::open(&args.link)?;
        link::status(&link, &events, table.is_some())?
    };
    terminal::print(&if args.json { terminal::json(&status) } else { screen(&status) })
}

/// The status on one screen.
fn screen(status: &Status) -> String {
    let Status { hello, health, rates, received, .. } = status;
    let table = match status.table_matches {
        Some(true) => ", the one given",
        Some(false) => ", NOT the one given",
        None => "",
    };
    let kpa = health.pressures_pa.iter().map(|pressure_pa| format!(" {:.1}", f64::from(*pressure_pa) / 1e3));
    let pressures: String = kpa.collect();
    let lines = [
        ("line", format!("{}, {}", status.port, if status.answers { "answers" } else { "does NOT answer requests" })),
        ("firmware", format!("{} ({}), proprio {}", hello.firmware, hello.revision, status.proprio)),
        ("arm", arm(hello, table)),
        ("wiring", wiring(hello)),
        ("chip", chip_number(&hello.chip)),
        ("boot", format!("number {} since power-on, by {:?}, {}", hello.boot, hello.reset, up(health.tick))),
        ("last panic", hello.last_panic.as_deref().unwrap_or("none").to_owned()),
        (
            "rates",
            format!(
                "{:.1} samples/s, {:.1} estimates/s, {:.1} kB/s{}",
                rates.samples_hz,
                rates.estimates_hz,
                rates.bytes_per_s / 1e3,
                slower(hello)
            ),
        ),
        ("received", format!("{} frames, {} damaged, {} lost", received.frames, received.damaged, received.lost)),
        (
            "load",
            format!(
                "{:.1} %, estimate {} µs and IMUs {} µs after the tick at most",
                f64::from(health.load_permille) / 10.0,
                health.max_estimate_latency_us,
                health.longest_imu_read_us
            ),
        ),
        (
            "counters",
            format!(
                "{} overruns, {} stale scans, {} dropped, {} damaged and {} unknown frames, {} bus recoveries, {} saturations",
                health.overruns,
                health.stale_scans,
                health.dropped_frames,
                health.damaged_frames,
                health.unknown_frames,
                health.bus_recoveries,
                health.saturations
            ),
        ),
        ("degraded", degraded(health)),
        ("tip", tip(status.shape.as_ref())),
        ("contact", contact(status.shape.as_ref())),
        ("pressures", format!("{:?},{pressures} kPa", health.actuation)),
        ("bend sensors", sensors(&health.bend, |i| format!("{}{}", i / 2 + 1, ['a', 'b'][i % 2]))),
        ("IMUs", sensors(&health.imu, |i| (i + 1).to_string())),
    ];
    let notes = status.mismatches.iter().map(|mismatch| format!("\nnote: {mismatch}\n"));
    text_tables::pairs(&lines) + &notes.collect::<String>()
}

/// Reasons why the estimate is degraded, or the pressures limited.
fn degraded(health: &Health) -> String {
    let reasons: Vec<String> = degradations(health).collect();
    if reasons.is_empty() { "no".to_owned() } else { reasons.join("; ") }
}

/// The arm and the table of the board; `compared`: with the table that was given.
fn arm(hello: &Hello, compared: &str) -> String {
    if hello.arm.is_empty() {
        return "none: the board has no valid table and sends samples alone; see `proprio table show`".to_owned();
    }
    format!("{}, table {:08x}{compared}", hello.arm, hello.table)
}

/// Numbers of what the arm has.
fn wiring(hello: &Hello) -> String {
    format!("{} segments, {} bend sensors, {} regulators", hello.segments, hello.bend_sensors, hello.regulators)
}

/// The reason of a rate of estimates that is lower than that of samples.
fn slower(hello: &Hello) -> String {
    let ticks = Rates::of_arm(hello.segments.into(), hello.regulators.into()).estimate;
    if ticks <= 1 || hello.protocol == protocol_2::VERSION {
        return String::new();
    }
    let rate_hz = TICK_HZ / f64::from(ticks);
    format!("; estimates at {rate_hz:.0} Hz, as the line has no room for {TICK_HZ:.0}")
}

fn up(tick: u32) -> String {
    format!("up for {:.1} s", f64::from(tick) / TICK_HZ)
}

/// Uncertainty of the tip.
fn tip(shape: Option<&KnownShape>) -> String {
    match shape.and_then(|shape| shape.tip) {
        Some(Ellipse { major_mm, minor_mm }) => {
            format!("95 % within an ellipse of {major_mm:.1} mm by {minor_mm:.1} mm about the estimate")
        }
        None => "the board has sent no uncertainty".to_owned(),
    }
}

/// Segments in contact.
fn contact(shape: Option<&KnownShape>) -> String {
    let touched = (1..).zip(shape.iter().flat_map(|shape| &shape.touched)).filter(|(_, touched)| **touched);
    let numbers: Vec<String> = touched.map(|(number, _): (u32, _)| number.to_string()).collect();
    if numbers.is_empty() { "none".to_owned() } else { format!("segment {}", numbers.join(", ")) }
}

/// Number of the wired sensors that are ok; name, state and missed readings of each other one.
fn sensors(sensors: &[SensorHealth], name: impl Fn(usize) -> String) -> String {
    let wired = sensors.iter().enumerate().filter(|(_, sensor)| sensor.state != SensorState::NotWired);
    let count = wired.clone().count();
    let ok = wired.clone().filter(|(_, sensor)| sensor.state == SensorState::Ok).count();
    let others = wired.filter(|(_, sensor)| sensor.state != SensorState::Ok);
    let others = others.map(|(i, sensor)| format!("{} {} ({} missed)", name(i), sensor.state, sensor.missed));
    [format!("{ok} of {count} ok")].into_iter().chain(others).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use telemetry::{Hello, PROTOCOL_VERSION, ResetCause, SensorHealth, SensorState, Text, protocol_2};

    use super::{sensors, slower, wiring};

    fn hello(segments: u8) -> Hello {
        Hello {
            protocol: PROTOCOL_VERSION,
            schema: 0,
            firmware: Text::new(),
            revision: Text::new(),
            arm: Text::new(),
            table: 0,
            segments,
            bend_sensors: segments,
            regulators: 6,
            chip: [0; 16],
            reset: ResetCause::Pin,
            boot: 1,
            last_panic: None,
        }
    }

    #[test]
    fn the_line_has_no_room_for_the_estimates_of_seven_segments_at_100_hz() {
        assert_eq!(wiring(&hello(7)), "7 segments, 7 bend sensors, 6 regulators");
        let slow = "; estimates at 50 Hz, as the line has no room for 100";
        assert_eq!([6, 7, 8].map(|segments| slower(&hello(segments))), ["", slow, slow]);
        assert_eq!(slower(&Hello { protocol: protocol_2::VERSION, ..hello(7) }), "");
    }

    #[test]
    fn sensors_that_are_not_wired_are_not_lost() {
        let states = [SensorState::Ok, SensorState::NotWired, SensorState::NoResponse, SensorState::NotWired];
        let health = states.map(|state| SensorHealth { state, missed: 3 });
        assert_eq!(sensors(&health, |i| i.to_string()), "1 of 2 ok, 2 Off (3 missed)");
    }
}
