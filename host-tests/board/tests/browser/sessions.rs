//! A session on the page.

use std::path::Path;

use board_tests::browser::{Browser, MonitorRun};

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_session_is_opened_scrubbed_and_played_with_its_truth() {
    let rig = MonitorRun::session(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../sessions/scenario-2.csv"));
    let mut browser = Browser::start();
    browser.screen([1400, 1000], "light");
    browser.open(&rig.address);
    browser.wait_for("document.getElementById('arm-name').textContent === 'scenario-2.csv'");
    browser.wait_for("document.getElementById('scrub').max > 59");
    let scrub =
        "const scrub = document.getElementById('scrub'); scrub.value = 40; scrub.dispatchEvent(new Event('input'))";
    browser.value(&format!("{{ {scrub} }}"));
    browser.wait_for("document.getElementById('time').textContent === '40.00 s'");
    let values = browser.text("arm-values");
    assert!(values.ends_with("mm from truth"), "{values}");
    // A dashed line from the base through the true ends.
    browser.wait_for("!document.getElementById('key-truth').hidden");
    browser.press("s");
    let (name, svg) = browser.download(".svg");
    let svg = String::from_utf8(svg).expect("it is text");
    assert!(svg.contains(r#"stroke-dasharray="5 5""#));
    assert!(name.starts_with("scenario-2-0.00s-") && name.ends_with("s.svg"), "{name}");
    for text in
        [">session scenario-2.csv<", ">table planar-6, checksum ", ">at 40.00 s, picked; saved 20", ">segment 6 "]
    {
        assert!(svg.contains(text), "{text}");
    }
    browser.picture("session.png");

    browser.press(" ");
    browser.wait_for("parseFloat(document.getElementById('time').textContent) > 41");
    assert_ne!(browser.text("arm-values"), values);
    browser.press(" ");
    browser.wait_for("document.getElementById('pause').textContent === 'Play'");
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}

/// Opens the list of sessions and clicks a button of the file with this name.
fn choose(browser: &mut Browser, name: &str, button: usize) {
    browser.press("o");
    let item =
        format!("[...document.querySelectorAll('#files li')].find((item) => item.textContent.startsWith('{name}'))");
    browser.wait_for(&format!("Boolean({item}?.children[{button}])"));
    browser.value(&format!("{item}.children[{button}].click()"));
    browser.wait_for("!document.getElementById('sessions').open");
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn two_sessions_or_two_tables_are_drawn_over_one_another() {
    let sessions = Path::new(env!("CARGO_MANIFEST_DIR")).join("../sessions");
    let run = MonitorRun::session(&sessions.join("scenario-2.csv"));
    let folder = run.folder.path();
    for scenario in [2, 3] {
        let name = format!("scenario-{scenario}.csv");
        std::fs::copy(sessions.join(&name), folder.join(&name)).expect("there is room");
    }
    let table = std::fs::read_to_string(sessions.join("../../calibration-tables/planar-6.toml")).expect("a table");
    // An arm that is longer by a tenth, by this table.
    std::fs::write(folder.join("longer.toml"), table.replace("length_mm = 80.0", "length_mm = 89.7"))
        .expect("there is room");
    let mut browser = Browser::start();
    browser.screen([1400, 1000], "light");
    browser.open(&run.address);
    browser.wait_for("document.getElementById('arm-name').textContent === 'scenario-2.csv'");
    browser.value(
        "{ const scrub = document.getElementById('scrub'); scrub.value = 30; scrub.dispatchEvent(new Event('input')) }",
    );

    choose(&mut browser, "scenario-3.csv", 1);
    let legend = browser.text("overlay");
    assert!(legend.starts_with("Solid: scenario-2.csv by table planar-6, checksum "), "{legend}");
    assert!(legend.contains("Dashed: scenario-3.csv by table planar-6"), "{legend}");
    browser.picture("overlay-sessions.png");
    browser.press("s");
    let (_, svg) = browser.download(".svg");
    let svg = String::from_utf8(svg).expect("it is text");
    let dashed = svg.matches(r#"stroke-dasharray="6 4""#).count();
    assert_eq!(dashed, 4 * 6, "the curves of six segments in four plots");
    assert!(svg.contains(r#"stroke-dasharray="8 8""#), "the other arm");

    browser.value("document.getElementById('remove-overlay').click()");
    browser.wait_for("document.getElementById('overlay').hidden");
    browser.value("document.getElementById('with-table').replaceChildren()");
    browser.press("o");
    browser.wait_for("document.querySelectorAll('#with-table option').length === 2");
    browser.value("document.getElementById('with-table').value = 'longer.toml'");
    let item =
        "[...document.querySelectorAll('#files li')].find((item) => item.textContent.startsWith('scenario-2.csv'))";
    browser.value(&format!("{item}.children[1].click()"));
    browser.wait_for("!document.getElementById('sessions').open");
    assert_eq!(browser.text("arm-name"), "scenario-2.csv");
    let legend = browser.text("overlay");
    let checksums: Vec<&str> = legend.split("checksum ").skip(1).map(|rest| &rest[..8]).collect();
    assert!(checksums.len() == 2 && checksums[0] != checksums[1], "{legend}");
    browser.picture("overlay-tables.png");
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}
