//! The pages by axe-core's rules of accessibility (<https://github.com/dequelabs/axe-core>): no violation, light and dark.

use std::path::Path;
use std::process::Command;
use std::{env, fs};

use board_tests::browser::{Browser, MonitorRun};
use board_tests::due::tool;

const SESSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../sessions/scenario-2.csv");

/// Fails for each rule that the page violates, light and dark, with the elements.
fn check(browser: &mut Browser, page: &str) {
    let path = env::var_os("AXE").expect("AXE is the path of axe.min.js, which .ci/browser installs");
    let axe = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    // The page's own policy forbids foreign scripts; the debugger may evaluate one.
    browser.value(&format!("{{ {axe} }}"));
    for scheme in ["light", "dark"] {
        browser.screen([1400, 1000], scheme);
        let violations = browser.value(
            "axe.run(document, {resultTypes: ['violations']}).then(({violations, passes}) => passes.length < 10 ? 'nothing was checked' : \
             violations.flatMap(({id, nodes}) => nodes.map(({target, failureSummary}) => `${id}: ${target}: ${failureSummary}`)))",
        );
        assert_eq!(violations, serde_json::json!([]), "{page}, {scheme}: {violations:#}");
    }
}

#[test]
#[ignore = "needs Chromium and axe-core: .ci/browser runs it"]
fn the_live_page_and_its_guide_violate_no_rule() {
    let mut run = MonitorRun::live(&["--allow-control"]);
    let mut browser = Browser::start();
    browser.open(&run.address);
    browser.wait_for("!document.getElementById('arm-pressures').disabled");
    check(&mut browser, "live");
    browser.press("k");
    browser.wait_for("document.querySelectorAll('#sweep .seen').length >= 1");
    run.inject_fault("unplug imu3");
    browser.wait_for("!document.getElementById('sweep-warnings').hidden");
    check(&mut browser, "guide");
    browser.press("o");
    browser.wait_for("document.getElementById('sessions').open");
    check(&mut browser, "list of sessions");
}

#[test]
#[ignore = "needs Chromium and axe-core: .ci/browser runs it"]
fn a_page_with_a_session_violates_no_rule() {
    let run = MonitorRun::session(Path::new(SESSION));
    let mut browser = Browser::start();
    browser.open(&run.address);
    browser.wait_for("document.getElementById('arm-name').textContent === 'scenario-2.csv'");
    browser.wait_for("document.getElementById('scrub').max > 59");
    check(&mut browser, "session");
}

#[test]
#[ignore = "needs Chromium and axe-core: .ci/browser runs it"]
fn a_report_violates_no_rule() {
    let mut browser = Browser::start();
    let report = browser.folder.path().join("report.html");
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/../../calibration-tables/planar-6.toml");
    let mut command = Command::new(tool("proprio"));
    let status = command.args(["report", SESSION, "--table", table, "-o"]).arg(&report).status();
    assert!(status.expect("the tool starts").success());
    browser.open(&format!("file://{}", report.display()));
    check(&mut browser, "report");
}
