//! Seeds of texts: sessions, cameras' files, profiles, tables, and messages of the page.

use std::error::Error;

use calibration_tables::ArmFile;

use crate::seed::{Seed, TABLES, seed, text_of};

/// Rows of a session.
const ROWS: usize = 5;

/// First bytes of an input for arms of six and of one segments, and the flag that requires truth.
const SIX: u8 = 5;
const ONE: u8 = 0;
const TRUTH: u8 = 0x10;

/// The begin of a session's text: the columns that are kept, in each of its first rows.
fn begin(text: &str, rows: usize, keep: impl Fn(&str) -> bool) -> String {
    let names: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
    let row = |line: &str| {
        let cells = line.split(',').zip(&names).filter(|(_, name)| keep(name)).map(|(cell, _)| cell);
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    text.lines().take(rows + 1).map(row).collect()
}

fn is_first(name: &str) -> bool {
    name == "time_s" || ["bend1", "imu1", "truth1"].iter().any(|of| name.starts_with(of))
}

/// The begin of the repository's sessions: all of it, one segment, without truth, with missing readings, and in other forms.
pub fn sessions() -> Result<Vec<Seed>, Box<dyn Error>> {
    let mut seeds = Vec::new();
    for name in ["scenario-1", "scenario-2", "scenario-3", "board-rate"] {
        let text = text_of(&format!("host-tests/sessions/{name}.csv"))?;
        seeds.push(seed(name, SIX | TRUTH, begin(&text, ROWS, |_| true).as_bytes()));
        let one = begin(&text, ROWS, is_first);
        seeds.push(seed(format!("{name}-one"), ONE | TRUTH, one.as_bytes()));
        let bare = begin(&text, ROWS, |name| is_first(name) && !name.starts_with("truth"));
        seeds.push(seed(format!("{name}-bare"), ONE, bare.as_bytes()));
        seeds.push(seed(format!("{name}-windows"), ONE, bare.replace('\n', "\r\n").as_bytes()));
        let places = begin(&text, ROWS, |name| is_first(name) && !name.ends_with("heading_deg"));
        seeds.push(seed(format!("{name}-places"), ONE, places.as_bytes()));
        let gaps = begin(&bare, 1, |_| true);
        let cells = ",".repeat(bare.lines().next().unwrap_or_default().matches(',').count());
        seeds.push(seed(format!("{name}-gaps"), ONE, format!("{gaps}7{cells}\n").as_bytes()));
    }
    let tares = b"time_s,tare,imu1_rad,bend1a_adc\n0,0,0.5,100\n0.01,0,0.6,101.0\n0.02,1, ,\n";
    seeds.push(seed("tares", ONE, tares));
    seeds.push(seed("semicolons", ONE, b"time_s;imu1_deg;bend1a_adc\n0;1;2\n"));
    seeds.push(seed("similar", ONE, b"time_s,IMU1_deg,bend1a_adc\n0,1,2\n"));
    Ok(seeds)
}

/// Cameras' files with the truth of the sessions, and exports of motion-capture programs.
pub fn cameras() -> Result<Vec<Seed>, Box<dyn Error>> {
    let mut seeds = Vec::new();
    for name in ["scenario-1", "scenario-2", "scenario-3", "board-rate"] {
        let text = text_of(&format!("host-tests/sessions/{name}.csv"))?;
        let all = begin(&text, ROWS, |name| name == "time_s" || name.starts_with("truth"));
        seeds.push(seed(name, SIX, all.as_bytes()));
        let one = begin(&text, ROWS, |name| name == "time_s" || name.starts_with("truth1"));
        seeds.push(seed(format!("{name}-one"), ONE, one.as_bytes()));
        let metres = one.replace("_mm", "_m").replace("_deg", "_rad");
        seeds.push(seed(format!("{name}-metres"), ONE, metres.as_bytes()));
    }
    let base = "time_s,base_x_m,base_y_m,base_heading_rad,truth1_x_mm,truth1_y_mm,truth1_heading_deg\n\
                -3.5,1,2,0.5,97,0,-1e-3\n-3.4,,,,98.5,0.25,12\n-3.3,1,2,0.5,,,\n";
    seeds.push(seed("base", ONE, base.as_bytes()));
    seeds.push(seed("base-alone", ONE, b"time_s,base_x_m\n1,2\n"));
    for name in ["motive.csv", "vicon.csv", "qualisys.tsv"] {
        seeds.push(seed(name, ONE, text_of(&format!("host-tests/motion-capture/{name}"))?.as_bytes()));
    }
    Ok(seeds)
}

/// Profiles in both units, with ramps, steps, holds, and faults.
pub fn profiles() -> Vec<Seed> {
    let profiles = [
        ("ramp", "time_s,pressure1_kpa\n0,0\n2,40\n4,40\n6,0\n"),
        ("step", "time_s,pressure1_kpa,pressure2_kpa\n1,0,0\n3,10,0\n3,30,0\n4,30,0\n"),
        ("pascals", "time_s,pressure1_pa,pressure2_kpa\n0,1000,1\n0.5,1e6,999.5\n"),
        (
            "eight",
            "time_s,pressure1_kpa,pressure2_kpa,pressure3_kpa,pressure4_kpa,pressure5_kpa,pressure6_kpa,pressure7_kpa,pressure8_kpa\n0,1,2,3,4,5,6,7,8\n1,0,0,0,0,0,0,0,0\n",
        ),
        ("one-point", "time_s,pressure1_kpa\n0,0\n"),
        ("late", "time_s,pressure1_kpa\n1e6,5\n3e9,7\n"),
        ("windows", "time_s,pressure1_kpa\r\n0,0\r\n2,40\r\n"),
        ("quoted", "\"time_s\", \"pressure1_kpa\"\n\"0\", 1 \n"),
        ("backwards", "time_s,pressure1_kpa\n1,0\n0,0\n"),
        ("too-high", "time_s,pressure1_kpa\n0,1000.1\n"),
        ("empty-cell", "time_s,pressure1_kpa\n0,\n"),
        ("header-alone", "time_s,pressure1_kpa\n"),
    ];
    profiles.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec())).into()
}

/// The repository's tables and arm descriptions, whole, of one segment, and without one section each.
pub fn tables() -> Result<Vec<Seed>, Box<dyn Error>> {
    let mut seeds = Vec::new();
    for (name, path) in TABLES {
        let text = text_of(path)?;
        let mut file = ArmFile::parse(&text)?;
        seeds.push((name.to_owned(), text.into_bytes()));
        file.segments.truncate(1);
        seeds.push((format!("{name}-one"), file.to_toml().into_bytes()));
        (file.board, file.tuning, file.contact) = (None, None, None);
        seeds.push((format!("{name}-short"), file.to_toml().into_bytes()));
        (file.drift, file.uncertainty) = (None, None);
        seeds.push((format!("{name}-bare"), file.to_toml().into_bytes()));
    }
    let wiring = "format = 1\narm = \"a\"\nrate_hz = 100.0\n[board]\n[[board.segment]]\nbend = [\"A0\", \"A1\"]\n\
                  imu = { channel = 0, address = 0x28 }\n[[board.regulator]]\npin = \"D6\"\nfull_scale_kpa = 280.0\n\
                  [[segment]]\nlength_mm = 80.0\noffset_mm = 17.0\noffset_at = \"end\"\n";
    seeds.push(("wiring".to_owned(), wiring.as_bytes().to_vec()));
    Ok(seeds)
}

/// Requests of the page's scripts, each with access and without; messages of the feed; and bytes of connections.
pub fn page_messages() -> Vec<Seed> {
    let requests = [
        ("record", 0, r#"{"on":true}"#),
        ("record-off", 0, r#"{"on":false}"#),
        ("mark", 1, r#"{"text":"a mark \u00b5"}"#),
        ("unlock", 2, "{}"),
        ("arm", 3, r#""arm""#),
        ("vent", 3, r#""vent""#),
        ("set-pressures", 3, r#"{"set_pressures":{"kpa":[40,0,12.5,1e300,-1,0]}}"#),
        ("nine-pressures", 3, r#"{"set_pressures":{"kpa":[1,2,3,4,5,6,7,8,9]}}"#),
        ("tare", 4, r#"{"force":false}"#),
        ("tare-anyway", 4, r#"{"force":true}"#),
        ("table", 5, "{}"),
        ("shown", 6, r#"{"shown_us":1764000000000000}"#),
        ("taken", 6, r#"{"taken_us":1764000000000000}"#),
        ("session", 7, "name=session.mcap&from_s=1.5&to_s=2e3"),
        ("session-outside", 7, "name=..%2Fsession.csv"),
        ("get", 8, "GET / HTTP/1.1\r\nHost: 127.0.0.1:8000\r\n\r\n"),
        ("history", 8, "GET /history HTTP/1.1\r\nHost: localhost:8000\r\n\r\n"),
        ("status", 8, "GET /status HTTP/1.1\r\nHost: localhost:8000\r\nConnection: close\r\n\r\n"),
        (
            "pieces",
            8,
            "POST /mark HTTP/1.1\r\nHost: localhost:8000\r\nOrigin: http://localhost:8000\r\n\
                       Transfer-Encoding: chunked\r\n\r\n5\r\n{\"tex\r\n0\r\n\r\n",
        ),
    ];
    let mut seeds: Vec<Seed> = Vec::new();
    for (name, path, rest) in requests {
        seeds.push(seed(name, path << 2, rest.as_bytes()));
        if (3..6).contains(&path) {
            seeds.push(seed(format!("{name}-without-token"), path << 2 | 2, rest.as_bytes()));
        }
    }
    seeds.push(seed("record-from-elsewhere", 1, br#"{"on":true}"#));
    seeds
}
