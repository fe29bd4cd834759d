//! Values of the curves at the cursor and at the picked moment, and the choice of plots.

use std::path::{Path, PathBuf};

use board_tests::browser::{Browser, MonitorRun};
use serde_json::json;

const CANVAS: &str = "document.querySelector('#figures canvas')";

fn session() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../sessions/scenario-2.csv")
}

fn opened() -> (MonitorRun, Browser) {
    let run = MonitorRun::session(&session());
    let mut browser = Browser::start();
    browser.screen([1400, 1000], "light");
    browser.open(&run.address);
    browser.wait_for("document.getElementById('scrub').max > 59");
    browser.wait_for("document.getElementById('moment').textContent.startsWith('at ')");
    (run, browser)
}

/// Waits until every plot has, in its line of this class, the values that its columns have at the time that the line begins with.
fn wait_for_values(browser: &mut Browser, line: &str) {
    let work = "(async () => { \
        const {store} = await (await import('/sessions.js')).load('scenario-2.csv', {}); \
        const figures = [...document.querySelectorAll('#figures figure')]; \
        return figures.length === 4 && figures.every((figure) => { \
            const prefix = figure.dataset.kind, [at, ...values] = figure.querySelector('.readings.LINE').children; \
            const row = store.rowAt(parseFloat(at.textContent.match(/[\\d.]+/)?.[0]) + 1e-4); \
            const expected = [1, 2, 3, 4, 5, 6].map((i) => store.column(`${prefix}${i}_deg`)[row].toFixed(2).replace('-', '−').replace(/^−([0.]+)$/, '$1')); \
            return values.map((value) => value.querySelector('b').textContent).join() === expected.join(); }); })()";
    browser.wait_for(&work.replace("LINE", line));
}

fn text_of(browser: &mut Browser, selector: &str) -> String {
    let text = browser.value(&format!("document.querySelector('{selector}').textContent"));
    text.as_str().unwrap_or_default().to_owned()
}

fn time_s(text: &str) -> f64 {
    let number = text.split(' ').nth(1).unwrap_or_default();
    number.parse().unwrap_or_else(|_| panic!("{text}"))
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn every_plot_has_its_values_at_the_mouse_and_at_the_moment_that_is_clicked() {
    let (_run, mut browser) = opened();
    let [pointed, clicked] = [0.7, 0.4].map(|across| browser.place(CANVAS, [across, 0.5]));
    browser.point(pointed);
    browser.wait_for("!document.querySelector('.readings.pointer.idle')");
    wait_for_values(&mut browser, "pointer");
    let pointer_s = time_s(&text_of(&mut browser, ".readings.pointer .at"));
    assert!((40.0..43.0).contains(&pointer_s), "{pointer_s}");

    browser.click(clicked);
    browser.wait_for("document.getElementById('moment').textContent.startsWith('at 2')");
    wait_for_values(&mut browser, "moment");
    let moment = browser.text("moment");
    assert!((21.0..24.0).contains(&time_s(&moment)) && moment.ends_with("picked"), "{moment}");
    assert_eq!(format!("{}, picked", text_of(&mut browser, ".readings.moment .at")), moment);
    browser.point(pointed);
    browser.wait_for("document.querySelector('.readings.pointer .at').textContent.startsWith('cursor 4')");
    browser.picture("values.png");
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_finger_shows_the_values_under_it_and_picks_the_moment() {
    let (_run, mut browser) = opened();
    browser.screen([390, 844], "light");
    browser.value(&format!("{CANVAS}.scrollIntoView({{block: 'center'}})"));
    let place = browser.place(CANVAS, [0.5, 0.5]);
    browser.touch(Some(place));
    browser.wait_for("!document.querySelector('.readings.pointer.idle')");
    wait_for_values(&mut browser, "pointer");
    browser.touch(None);
    browser.wait_for("/^at [23]\\d/.test(document.getElementById('moment').textContent)");
    wait_for_values(&mut browser, "moment");
    browser.picture("values-phone.png");
    assert_eq!(browser.value("document.documentElement.scrollWidth"), 390);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn arrow_keys_move_the_moment_by_a_sample_and_page_keys_by_a_tenth_of_what_is_shown() {
    let (_run, mut browser) = opened();
    browser.value(
        "{ const scrub = document.getElementById('scrub'); scrub.value = 20; scrub.dispatchEvent(new Event('input')) }",
    );
    browser.wait_for("document.getElementById('moment').textContent.startsWith('at 20.00 s')");
    browser.value(&format!("{CANVAS}.focus()"));
    // Rows of 10 Hz, of which all 59.9 s are shown.
    for (key, moment) in [
        ("ArrowRight", "20.10"),
        ("ArrowLeft", "20.00"),
        ("ArrowLeft", "19.90"),
        ("PageUp", "25.80"),
        ("PageDown", "19.90"),
    ] {
        browser.press(key);
        browser.wait_for(&format!("document.getElementById('moment').textContent.startsWith('at {moment} s')"));
        wait_for_values(&mut browser, "moment");
    }
    let values = browser.text("arm-values");
    browser.press("End");
    browser.wait_for("/^at 59\\.|^at 1:00/.test(document.getElementById('moment').textContent)");
    assert_ne!(browser.text("arm-values"), values, "the arm shows the moment");
}

/// Adds a plot of this kind by the menu.
fn add(browser: &mut Browser, kind: &str) {
    browser.value(&format!(
        "{{ const menu = document.getElementById('add-plot'); menu.value = '{kind}'; menu.dispatchEvent(new Event('change')) }}"
    ));
}

fn kinds(browser: &mut Browser) -> serde_json::Value {
    browser.value("[...document.querySelectorAll('#figures figure')].map((figure) => figure.dataset.kind)")
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn the_choice_of_plots_is_kept_and_holds_for_a_live_board_and_a_session() {
    let run = MonitorRun::live(&[]);
    std::fs::copy(session(), run.folder.path().join("scenario-2.csv")).expect("there is room");
    let mut browser = Browser::start();
    browser.screen([1400, 1000], "light");
    browser.open(&run.address);
    assert_eq!(kinds(&mut browser), json!(["theta", "drift", "innovation_imu", "innovation_bend"]));
    for kind in ["drift", "innovation_imu", "innovation_bend"] {
        browser.value(&format!("document.querySelector('figure[data-kind={kind}] .remove').click()"));
    }
    for kind in ["pressure", "tip_error", "volts"] {
        add(&mut browser, kind);
    }
    let chosen = json!(["theta", "pressure", "tip_error", "volts"]);
    assert_eq!(kinds(&mut browser), chosen);
    let address = run.address.clone();
    browser.open("about:blank");
    browser.open(&address);
    browser.wait_for("document.getElementById('link').dataset.state === 'ok'");
    assert_eq!(kinds(&mut browser), chosen);
    // Six regulators, as the board has set them; twelve bend sensors.
    let values = |kind: &str| {
        format!(
            "[...document.querySelectorAll('figure[data-kind={kind}] .moment b')].filter((value) => /\\d/.test(value.textContent)).length"
        )
    };
    browser.wait_for(&format!("{} === 6 && {} === 12", values("pressure"), values("volts")));
    browser.picture("chosen.png");

    browser.press("o");
    browser.wait_for("document.querySelector('#files button')?.textContent.startsWith('scenario-2.csv')");
    browser.value("document.querySelector('#files button').click()");
    browser.wait_for("document.getElementById('arm-name').textContent === 'scenario-2.csv'");
    assert_eq!(kinds(&mut browser), chosen);
    browser.value(
        "{ const scrub = document.getElementById('scrub'); scrub.value = 30; scrub.dispatchEvent(new Event('input')) }",
    );
    browser.wait_for(&format!("{} === 3", values("tip_error")));
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}
