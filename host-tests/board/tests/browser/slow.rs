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
    slow.wait_for("/[1-9]\\d* batches? skipped/.test(document.getElementById('fact-page').textContent)");
    slow.value("clearInterval(window.busy)");
    slow.wait_for("document.getElementById('link').textContent === 'live'");

    let largest_ms = "Number(document.getElementById('fact-latency').textContent.match(/(\\d+) ms largest/)?.[1])";
    let [slowest_ms, other_ms] = [&mut slow, &mut other].map(|browser| browser.value(largest_ms).as_f64());
    assert!(slowest_ms > Some(1500.0) && other_ms < Some(1500.0), "{slowest_ms:?}, {other_ms:?}");
    // The newest rows are there at once.
    let newest = "(async () => { const status = await (await fetch('/history')).arrayBuffer(); \
                  const {headOf} = await import('/store.js'); const {about, offset} = headOf(status); \
                  return new Float64Array(status, offset, about.rows).at(-1) })()";
    let newest_s = slow.value(newest).as_f64().expect("a time");
    slow.wait_for(&format!("parseFloat(document.getElementById('time').textContent) >= {newest_s}"));
    assert!(slow.errors.is_empty() && other.errors.is_empty(), "{:?} {:?}", slow.errors, other.errors);
}
