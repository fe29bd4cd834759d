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
