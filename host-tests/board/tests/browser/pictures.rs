//! Pictures for the documents, of simulated sessions: `cargo xtask pictures` copies them to `docs/pictures`.

use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use board_tests::browser::{Browser, MonitorRun};
use board_tests::due::tool;

/// Board time before the picture of the live page, so that plots and the tip's trail are filled.
const LIVE_FOR: Duration = Duration::from_secs(40);

#[test]
#[ignore = "needs Chromium: cargo xtask pictures runs it"]
fn pictures_of_the_documents_live_page_and_arm() {
    let rig = MonitorRun::live(&[]);
    let mut browser = Browser::start();
    browser.screen([1400, 1000], "light");
    browser.open(&rig.address);
    browser.wait_for("!document.getElementById('key-ellipse').hidden");
    sleep(LIVE_FOR);
    browser.picture_of("live-page.png", "document.documentElement");
    browser.picture_of("arm.png", "document.getElementById('arm-canvas')");
}

#[test]
#[ignore = "needs Chromium: cargo xtask pictures runs it"]
fn pictures_of_the_documents_report() {
    let mut browser = Browser::start();
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
    browser.picture_of("report.png", "document.getElementById('drift')");
}
