//! First moments of a page: no board, no table, a page that is opened late.

use board_tests::browser::{Browser, MonitorRun};

fn browser() -> Browser {
    let mut browser = Browser::start();
    browser.screen([1400, 1000], "light");
    browser
}

/// All six drifts at the moment that is shown have a value.
const DRIFT: &str = "[...document.querySelectorAll('figure[data-kind=drift] .moment b')].filter((value) => /\\d/.test(value.textContent)).length === 6";

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn the_board_s_own_table_gives_drift_from_its_first_tare_on_to_a_page_that_is_opened_late() {
    let run = MonitorRun::of_board(&[]);
    let mut browser = browser();
    browser.open(&run.address);
    browser.wait_for(&format!("{DRIFT} && parseFloat(document.getElementById('time').textContent) > 6"));
    browser.open("about:blank");

    browser.open(&run.address);
    browser.wait_for(&format!("{DRIFT} && parseFloat(document.getElementById('time').textContent) > 6"));
    // The moment is before this page was opened.
    browser.value(
        "{ const scrub = document.getElementById('scrub'); scrub.value = 4; scrub.dispatchEvent(new Event('input')) }",
    );
    browser.wait_for("document.getElementById('moment').textContent.startsWith('at 4.00 s')");
    browser.wait_for(DRIFT);
    browser.picture("late.png");
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_monitor_without_a_board_opens_a_recording_with_its_table_and_shows_the_board_that_comes() {
    let mut browser = browser();
    let recording = {
        let run = MonitorRun::of_board(&[]);
        browser.open(&run.address);
        browser.wait_for(DRIFT);
        browser.press("r");
        browser.wait_for("/[1-9]\\d\\d samples/.test(document.getElementById('fact-recording').textContent)");
        browser.press("r");
        browser.wait_for("document.getElementById('fact-recording').textContent === 'none'");
        let mut files = run.folder.path().read_dir().expect("a folder").flatten().map(|file| file.path());
        let path =
            files.find(|path| path.extension().is_some_and(|extension| extension == "mcap")).expect("a recording");
        std::fs::read(path).expect("it is there")
    };

    let mut run = MonitorRun::waiting();
    std::fs::write(run.folder.path().join("before.mcap"), recording).expect("there is room");
    browser.open(&run.address);
    browser.wait_for("document.getElementById('link').textContent === 'waiting for a board'");
    browser.wait_for("document.getElementById('wrong').textContent.includes('./board')");
    browser.picture("waiting.png");
    browser.press("o");
    browser.wait_for("document.querySelector('#files button')?.textContent.startsWith('before.mcap')");
    browser.value("document.querySelector('#files button').click()");
    browser.wait_for("document.getElementById('arm-name').textContent === 'before.mcap'");
    browser.wait_for(DRIFT);
    // It opens at its first estimate.
    browser.wait_for("document.getElementById('arm-values').textContent.startsWith('tip x')");

    run.plug_in();
    browser.wait_for("document.getElementById('link').textContent === 'live'");
    browser.value("document.getElementById('close-session').click()");
    browser.wait_for("document.getElementById('arm-name').textContent === 'planar-6'");
    browser.wait_for(&format!("document.getElementById('moment').textContent.startsWith('now') && {DRIFT}"));
    assert_eq!(browser.value("document.getElementById('wrong').hidden"), true);
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn the_header_names_the_sensors_that_are_lost_and_no_reason_is_cut() {
    let mut run = MonitorRun::live(&[]);
    let mut browser = browser();
    browser.open(&run.address);
    browser.wait_for("document.getElementById('strip-imu3')?.dataset.look === 'ok'");
    browser.wait_for("document.getElementById('wrong').hidden");
    run.inject_fault("unplug imu3");
    run.inject_fault("unplug bend2a");
    browser.wait_for("document.getElementById('wrong').textContent === '2 sensors lost: bend 2a, imu3'");
    for (name, width) in [("wrong.png", 1400), ("wrong-phone.png", 390)] {
        browser.screen([width, 1000], "light");
        browser.picture(name);
        let cut = "[...document.querySelectorAll('#strips .reason')].filter((reason) => reason.scrollWidth > reason.clientWidth).length";
        assert_eq!(browser.value(cut), 0);
        assert_eq!(browser.value("document.documentElement.scrollWidth <= innerWidth"), true);
    }
    run.inject_fault("plug imu3");
    run.inject_fault("plug bend2a");
    browser.wait_for("document.getElementById('wrong').hidden");
}
