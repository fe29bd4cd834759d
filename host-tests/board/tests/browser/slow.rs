//! A browser that is too slow for the rows.

use board_tests::browser::{Browser, MonitorRun};

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_slow_browser_shows_by_how_much_it_is_behind_catches_up_and_slows_no_other() {
    let run = MonitorRun::live(&[]);
    let [mut slow, mut other] = [Browser::start(), Browser::start()];
    for browser in [&mut slow, &mut other] {
        browser.screen([700, 600], "light");
        browser.open(&run.address);
        browser.wait_for("document.getElementById('link').textContent === 'live'");
    }
    // The page is busy for three of four seconds, again and again.
    let busy = "{ const work = () => { const end = performance.now() + 3000; while (performance.now() < end); }; \
                work(); window.busy = setInterval(work, 4000) }";
    slow.value(busy);
    slow.wait_for("/^behind by [2-9] s$/.test(document.getElementById('link').textContent)");
    slow.picture("behind.png");
    assert_eq!(other.text("link"), "live");
    slow.wait_for("/([4-9]\\d\\d|\\d{4,}) batches skipped/.test(document.getElementById('fact-page').textContent)");
    slow.value("clearInterval(window.busy)");
    slow.wait_for("document.getElementById('link').textContent === 'live'");
    // The number of rows is as much as a second old. The rows of the batches that it has missed are fetched.
    let rows = "Number(document.getElementById('fact-page').textContent.match(/(\\d+) rows/)?.[1])";
    let missing = format!(
        "(async () => {{ const history = await (await fetch('/history')).arrayBuffer(); \
         return (await import('/store.js')).headOf(history).about.rows - {rows} }})()"
    );
    assert!(slow.value(&missing).as_f64() > Some(250.0));
    slow.wait_for(&format!("{missing}.then((missing) => missing < 150)"));
    assert!(slow.errors.is_empty() && other.errors.is_empty(), "{:?} {:?}", slow.errors, other.errors);
}
