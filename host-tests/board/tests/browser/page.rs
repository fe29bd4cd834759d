//! The page's controls: pause, axes, export; and its layout.

use board_tests::browser::{Browser, MonitorRun};

fn opened() -> (MonitorRun, Browser) {
    let rig = MonitorRun::live(&[]);
    let mut browser = Browser::start();
    browser.screen([1400, 1000], "light");
    browser.open(&rig.address);
    browser.wait_for("document.getElementById('link').dataset.state === 'ok'");
    browser.wait_for("parseFloat(document.getElementById('time').textContent) > 3");
    (rig, browser)
}

fn time_s(browser: &mut Browser) -> f64 {
    let text = browser.text("time");
    text.trim_end_matches(" s").parse().unwrap_or_else(|_| panic!("{text}"))
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn space_pauses_the_picture_while_samples_arrive_and_then_catches_up() {
    let (_rig, mut browser) = opened();
    let plot = "document.querySelector('#figures canvas').toDataURL()";
    let live = browser.value(plot).to_string();
    browser.wait_for(&format!("{plot} !== {live}"));
    browser.press(" ");
    browser.wait_for("document.getElementById('pause').getAttribute('aria-pressed') === 'true'");
    let (paused_at, paused_s) = (browser.text("time"), time_s(&mut browser));
    let paused = browser.value(plot);
    browser.value("new Promise((done) => setTimeout(done, 1500))");
    assert_eq!(browser.value(plot), paused);
    // A redraw shows the same picture: samples received since then do not appear in it.
    browser.value("{ const segment = document.querySelector('#segments button'); segment.click(); segment.click() }");
    browser.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
    assert_eq!(browser.value(plot), paused);
    assert_eq!(browser.text("time"), paused_at);
    browser.press(" ");
    browser.wait_for(&format!("parseFloat(document.getElementById('time').textContent) > {paused_s} + 1.4"));
    assert_ne!(browser.value(plot), paused);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn what_is_seen_is_exported_as_csv_svg_and_png() {
    let (_rig, mut browser) = opened();
    browser.press(" ");
    browser.wait_for("document.getElementById('pause').getAttribute('aria-pressed') === 'true'");
    let paused_s = time_s(&mut browser);
    // The last two seconds, by zooming into a plot from the keyboard.
    browser.value("document.getElementById('span').value = '10'");
    browser.value("document.getElementById('span').dispatchEvent(new Event('change'))");
    browser.press("c");
    let (_, csv) = browser.download(".csv");
    let csv = String::from_utf8(csv).expect("it is text");
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().expect("a header").split(',').collect();
    assert_eq!((head[0], head[1], head.len()), ("time_s", "theta1_deg", 121));
    let times: Vec<f64> =
        lines.map(|line| line.split(',').next().expect("a cell").parse().expect("a number")).collect();
    assert!(times.is_sorted() && times.len() > 300, "{} rows", times.len());
    let (first, last) = (times[0], times[times.len() - 1]);
    assert!(first >= paused_s - 10.02 && (last - paused_s).abs() < 0.02, "{first} to {last}, paused at {paused_s}");

    browser.press("s");
    let (_, svg) = browser.download(".svg");
    let svg = String::from_utf8(svg).expect("it is text");
    assert!(svg.starts_with("<svg xmlns=") && svg.ends_with("</svg>\n"));
    for text in ["Bend angle θ, °", "Innovation by the bend sensors, °", "100 mm", "arm planar-6"] {
        assert!(svg.contains(&format!(">{text}</text>")), "{text}");
    }
    let parsed = "new DOMParser().parseFromString(SVG, 'image/svg+xml')";
    let quoted = serde_json::Value::from(svg).to_string();
    let is_good = parsed.replace("SVG", &quoted) + ".querySelectorAll('parsererror').length === 0";
    assert_eq!(browser.value(&is_good), true);

    browser.press("p");
    let (name, png) = browser.download(".png");
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 20_000, "{} bytes", png.len());
    assert!(name.starts_with("planar-6-20") && name.contains("Z-"), "{name}");
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn plots_are_zoomed_and_moved_from_the_keyboard() {
    let (_rig, mut browser) = opened();
    browser.press(" ");
    browser.wait_for("document.getElementById('pause').getAttribute('aria-pressed') === 'true'");
    browser.value("document.querySelector('#figures canvas').focus()");
    let plot = "document.querySelector('#figures canvas').toDataURL()";
    for key in ["+", "-", "PageDown", "*"] {
        let before = browser.value(plot);
        browser.press(key);
        let before = serde_json::Value::to_string(&before);
        browser.wait_for(&format!("{plot} !== {before}"));
    }
    // Zooming the value axis fixes the axes.
    assert_eq!(browser.value("document.getElementById('fixed').checked"), true);
    browser.press("0");
    browser.wait_for("document.getElementById('pause').getAttribute('aria-pressed') === 'false'");
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn the_page_fits_screens_and_phones_light_and_dark() {
    let (_rig, mut browser) = opened();
    for (name, size, scheme) in
        [("light", [1400, 1000], "light"), ("dark", [1400, 1000], "dark"), ("phone", [390, 844], "light")]
    {
        browser.screen(size, scheme);
        browser.value("new Promise((done) => setTimeout(done, 500))");
        browser.picture(&format!("{name}.png"));
        let width = browser.value("document.documentElement.scrollWidth");
        assert!(width.as_u64() <= Some(u64::from(size[0])), "{name}: {width}");
        let background = browser.value("getComputedStyle(document.body).backgroundColor");
        assert_eq!(background == "rgb(15, 17, 20)", scheme == "dark", "{name}: {background}");
    }
    // Everything that can be pressed has a name.
    let nameless = "[...document.querySelectorAll('button, input, select')].filter((one) => \
                    !(one.textContent.trim() || one.labels?.length || one.getAttribute('aria-label'))).length";
    assert_eq!(browser.value(nameless), 0);
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}
