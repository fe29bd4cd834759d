//! A live board on the page.

use std::time::Duration;

use board_tests::browser::{Browser, MonitorRun};

/// The page is live: samples come and the arm is there.
const LIVE: &str = "document.getElementById('link').dataset.state === 'ok' \
                    && document.getElementById('arm-values').textContent.startsWith('tip x')";

/// Content of the canvas, which changes with the picture.
const PICTURE: &str = "document.getElementById('arm-canvas').toDataURL()";

fn opened(arguments: &[&str]) -> (MonitorRun, Browser) {
    let rig = MonitorRun::live(arguments);
    let mut browser = Browser::start();
    browser.screen([1400, 1000], "light");
    browser.open(&rig.address);
    browser.wait_for(LIVE);
    (rig, browser)
}

fn look(strip: &str) -> String {
    format!("document.getElementById('strip-{strip}')?.dataset.look")
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_sensor_that_is_unplugged_turns_its_strip_red_within_a_second() {
    let (mut rig, mut browser) = opened(&[]);
    for (sensor, others) in [("imu3", "imu4"), ("bend2a", "bend2b")] {
        browser.wait_for(&format!("{} === 'ok'", look(sensor)));
        rig.inject_fault(&format!("unplug {sensor}"));
        let took = browser.wait_for(&format!("{} === 'bad'", look(sensor)));
        assert!(took < Duration::from_secs(1), "{sensor}: {took:?}");
        let strip = browser.text(&format!("strip-{sensor}"));
        assert!(strip.contains("Off") && strip.contains("does not answer"), "{strip}");
        assert_eq!(browser.value(&look(others)), "ok");
        browser.wait_for(&format!("document.getElementById('strip-{sensor}').textContent.includes('for 1 s')"));
        if sensor == "imu3" {
            browser.picture("unplugged.png");
        }
        rig.inject_fault(&format!("plug {sensor}"));
        browser.wait_for(&format!("{} === 'ok'", look(sensor)));
    }
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn the_tip_is_shown_with_its_uncertainty_and_without_sensors_is_not_known() {
    let (mut rig, mut browser) = opened(&[]);
    browser.wait_for(r"/^tip x .* mm, y .* mm, ±\d+\.\d mm \(95 %\), heading/.test(document.getElementById('arm-values').textContent)");
    for sensor in ["imu6", "bend6a", "bend6b"] {
        rig.inject_fault(&format!("unplug {sensor}"));
    }
    browser.wait_for(
        "document.getElementById('arm-values').textContent === 'tip not known: no sensor tells the angle of segment 6'",
    );
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn the_token_allows_to_arm_move_and_vent_the_arm() {
    let (_rig, mut browser) = opened(&["--allow-control"]);
    browser.wait_for("!document.getElementById('arm-pressures').disabled");
    assert_eq!(browser.value("location.hash"), "", "the token is taken out of the address");
    let before = browser.value(PICTURE);
    browser.value("document.getElementById('arm-pressures').click()");
    browser.wait_for("!document.getElementById('regulator0').disabled");
    browser.value("for (const i of [0, 2]) document.getElementById(`regulator${i}`).value = 60");
    browser.wait_for("document.getElementById('arm-values').textContent.match(/tip x (\\d+)/)?.[1] > 50");
    assert_ne!(browser.value(PICTURE), before, "the arm moves");
    browser.picture("moved.png");
    browser.press("Escape");
    browser.wait_for("document.getElementById('actuation').textContent === 'disarmed'");
    browser.wait_for("document.getElementById('regulator0').disabled");
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn without_the_token_nothing_is_driven() {
    let (rig, mut browser) = opened(&["--allow-control"]);
    // The state of a user who has only the address.
    browser.value("sessionStorage.clear()");
    let address = rig.origin().to_owned();
    browser.open(&address);
    browser.wait_for(LIVE);
    browser.wait_for("!document.getElementById('unlock').hidden");
    assert_eq!(browser.value("document.getElementById('vent').disabled"), true);
    browser.value("document.getElementById('token').value = '0123456789abcdef0123456789abcdef'");
    browser.value("document.querySelector('#unlock button').click()");
    browser.value("document.getElementById('arm-pressures').click()");
    browser.wait_for("document.getElementById('notice').textContent.includes('the token is missing or wrong')");
    assert_eq!(browser.text("actuation"), "disarmed");
    assert_eq!(browser.value("document.getElementById('unlock').hidden"), false);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn another_page_gets_neither_feed_nor_answers() {
    let (rig, mut browser) = opened(&["--allow-control"]);
    let address = rig.origin().replace("http:", "ws:");
    // The page's own policy would block the request: it is made from a page without a policy.
    browser.open("about:blank");
    let socket = format!(
        "new Promise((settle) => {{ const socket = new WebSocket('{address}/feed'); \
         socket.onopen = () => settle('open'); socket.onerror = () => settle('refused'); }})"
    );
    assert_eq!(browser.value(&socket), "refused");
    let post = format!(
        "fetch('{}/record', {{method: 'POST', body: '{{\"on\":true}}'}}).then(() => 'answered', () => 'refused')",
        rig.origin()
    );
    assert_eq!(browser.value(&post), "refused");
    let is_recording = |file: std::fs::DirEntry| file.path().extension().is_some_and(|extension| extension == "mcap");
    assert!(!rig.folder.path().read_dir().expect("a folder").flatten().any(is_recording));
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_recording_is_made_marked_and_opened_from_the_keyboard() {
    let (rig, mut browser) = opened(&[]);
    browser.press("r");
    browser.wait_for("document.getElementById('record').getAttribute('aria-pressed') === 'true'");
    browser.wait_for("!document.getElementById('mark').disabled");
    browser.press("m");
    browser.wait_for("/[1-9]\\d\\d samples, 1 marks/.test(document.getElementById('fact-recording').textContent)");
    browser.press("r");
    browser.wait_for("document.getElementById('fact-recording').textContent === 'none'");
    browser.press("o");
    browser.wait_for("document.querySelector('#files button')?.textContent.includes('.mcap')");
    browser.value("document.querySelector('#files button').click()");
    browser.wait_for("!document.getElementById('close-session').hidden");
    let name = browser.text("arm-name");
    assert!(name.starts_with("session-20") && name.contains("Z.mcap"), "{name}");
    browser.value("document.getElementById('close-session').click()");
    browser.wait_for("document.getElementById('arm-name').textContent === 'planar-6'");
    drop(rig);
    browser.wait_for("document.getElementById('link').textContent === 'monitor is not running'");
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_marked_moment_is_gone_to_in_the_recording_that_is_opened() {
    let (_rig, mut browser) = opened(&[]);
    browser.press("r");
    browser.wait_for("document.getElementById('record').getAttribute('aria-pressed') === 'true'");
    browser.wait_for("!document.getElementById('mark').disabled");
    browser.value("new Promise((done) => setTimeout(done, 1500))");
    browser.press("m");
    browser.wait_for("document.querySelector('#marks button')?.textContent.startsWith('mark 1, ')");
    browser.value("new Promise((done) => setTimeout(done, 500))");
    browser.press("r");
    browser.wait_for("document.getElementById('record').getAttribute('aria-pressed') === 'false'");

    browser.press("o");
    browser.wait_for("document.querySelector('#files button')?.textContent.startsWith('session-')");
    browser.value("document.querySelector('#files button').click()");
    browser.wait_for("document.getElementById('arm-name').textContent.startsWith('session-')");
    let mark = browser.value("document.querySelector('#marks button').textContent");
    let time = mark.as_str().and_then(|mark| mark.strip_prefix("mark 1, ")).expect("a mark and its time").to_owned();
    browser.value("document.querySelector('#marks button').click()");
    browser.wait_for(&format!("document.getElementById('time').textContent === '{time}'"));
    browser.picture("marked.png");
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}
