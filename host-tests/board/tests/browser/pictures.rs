//! Pictures for the documents, of simulated sessions: `cargo xtask pictures` copies them to `docs/pictures`.

use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use board_tests::browser::{Browser, MonitorRun};
use board_tests::due::tool;
use serde_json::json;

/// Pressures that move the arm, kPa: module 1 right, left, module 2 right, left, module 3 right, left.
const PRESSURES_KPA: [[u32; 6]; 6] = [
    [60, 0, 0, 40, 0, 0],
    [0, 30, 50, 0, 40, 0],
    [0, 70, 0, 20, 60, 0],
    [20, 0, 60, 0, 0, 50],
    [50, 0, 0, 30, 70, 0],
    [40, 0, 30, 0, 0, 60],
];

/// Time for which each of them holds.
const STEP: Duration = Duration::from_secs(5);

fn browser() -> Browser {
    let mut browser = Browser::start();
    browser.call("Emulation.setScrollbarsHidden", &json!({"hidden": true}));
    browser
}

#[test]
#[ignore = "needs Chromium: cargo xtask pictures runs it"]
fn pictures_of_the_documents_live_page_and_arm() {
    let rig = MonitorRun::live(&["--allow-control"]);
    let mut browser = browser();
    browser.screen([1400, 900], "light");
    browser.open(&rig.address);
    browser.wait_for("!document.getElementById('key-ellipse').hidden");
    browser.wait_for("!document.getElementById('arm-pressures').disabled");
    browser.value("document.getElementById('arm-pressures').click()");
    browser.wait_for("!document.getElementById('regulator0').disabled");
    for pressures in PRESSURES_KPA {
        for (regulator, kpa) in pressures.into_iter().enumerate() {
            browser.value(&format!("document.getElementById('regulator{regulator}').value = {kpa}"));
        }
        sleep(STEP);
    }
    browser.picture_of_screen("live-page.png");
    browser.picture_of("arm.png", "document.getElementById('arm-canvas')");
    browser.press("k");
    browser.wait_for("document.querySelectorAll('#sweep .seen').length >= 6");
    browser.picture_of("sweep.png", "document.getElementById('sweep')");
}

#[test]
#[ignore = "needs Chromium: cargo xtask pictures runs it"]
fn pictures_of_the_documents_report() {
    let mut browser = browser();
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/../../calibration-tables/planar-6.toml");
    for arguments in [
        "simulate --scenario 2 --seconds 900 --seed 202 -o session.csv".to_owned(),
        format!("report session.csv --table {table} -o report.html"),
    ] {
        let mut command = Command::new(tool("proprio"));
        let status = command.current_dir(browser.folder.path()).args(arguments.split(' ')).status();
        assert!(status.expect("the tool starts").success(), "{arguments}");
    }
    browser.screen([1000, 800], "light");
    let page = browser.folder.path().join("report.html");
    browser.open(&format!("file://{}", page.display()));
    browser.picture_of("report.png", "document.getElementById('drift_error')");
}
