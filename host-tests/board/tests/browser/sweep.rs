//! The guide through a sweep for a calibration.

use board_tests::browser::{Browser, MonitorRun};
use serde_json::json;

fn opened(run: &MonitorRun) -> Browser {
    let mut browser = Browser::start();
    browser.screen([1400, 1100], "light");
    browser.open(&run.address);
    browser.wait_for("document.getElementById('link').dataset.state === 'ok'");
    browser.press("k");
    browser.wait_for("document.querySelectorAll('#sweep tbody tr').length === 6");
    browser
}

/// Swings all modules by their regulators, each at its own pace. A machine that is too slow for the set-points vents the board, which
/// is then armed again.
fn swing(browser: &mut Browser) {
    browser.wait_for("!document.getElementById('arm-pressures').disabled");
    browser.value(
        "setInterval(() => { \
            const arm = document.getElementById('arm-pressures'); \
            if (!arm.disabled) arm.click(); \
            for (const module of [0, 1, 2]) { \
                const kpa = 120 * Math.sin(performance.now() / 1000 * (0.5 + 0.1 * module)); \
                document.getElementById(`regulator${2 * module}`).value = Math.max(0, kpa); \
                document.getElementById(`regulator${2 * module + 1}`).value = Math.max(0, -kpa); } }, 200)",
    );
}

/// Errors of the page, except those of requests that came too late for the board.
fn errors(browser: &Browser) -> Vec<&String> {
    browser.errors.iter().filter(|error| !error.contains("/control")).collect()
}

/// The cells of the segment's row that have a text, from the second.
fn cell(segment: usize, cell: usize) -> String {
    format!("document.querySelectorAll('#sweep tbody tr')[{}].children[{cell}].textContent", segment - 1)
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_sweep_is_recorded_and_the_next_commands_have_its_file() {
    let run = MonitorRun::live(&["--allow-control"]);
    let mut browser = opened(&run);
    assert!(browser.text("sweep-step").starts_with("Let the arm lie straight and still. Start the camera"));
    browser.value("document.getElementById('sweep-record').click()");
    browser.wait_for("document.getElementById('sweep-step').textContent === 'Leave the arm still.'");
    browser.wait_for("document.getElementById('sweep-step').textContent.startsWith('Move each module slowly')");
    let left = "9:\\d\\d to go; more range of segments 1, 2, 3, 4, 5, 6; more passes of segments 1, 2, 3, 4, 5, 6";
    browser.wait_for(&format!("/^{left}$/.test(document.getElementById('sweep-left').textContent)"));
    swing(&mut browser);
    browser.wait_for(&format!(
        "/^−[1-9]\\d° to [1-9]\\d°$/.test({}) && /^[2-9] of 20$/.test({})",
        cell(5, 2),
        cell(5, 4)
    ));
    browser.picture("sweep-running.png");
    browser.screen([390, 844], "light");
    browser.picture("sweep-phone.png");
    assert_eq!(browser.value("document.documentElement.scrollWidth"), 390);
    browser.screen([1400, 1100], "dark");

    browser.value("document.getElementById('sweep-record').click()");
    browser.wait_for("document.getElementById('sweep-step').textContent.startsWith('The recording has ended before')");
    let commands = browser.text("sweep-next");
    let mut files = run.folder.path().read_dir().expect("a folder").flatten().map(|file| file.file_name());
    let file = files
        .find_map(|name| name.into_string().ok().filter(|name| name.starts_with("session-")))
        .expect("a recording");
    let align = format!("{file} --camera CAMERA.csv --arm arm.toml -o sweep.csv");
    assert!(commands.contains(&align) && commands.contains("proprio calibrate sweep.csv --arm arm.toml"), "{commands}");
    browser.picture("sweep-recorded.png");
    assert_eq!(errors(&browser), Vec::<&String>::new());
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_bend_sensor_that_does_not_follow_its_segment_is_named() {
    let mut run = MonitorRun::live(&["--allow-control"]);
    let mut browser = opened(&run);
    run.inject_fault("bend2a:stuck");
    swing(&mut browser);
    browser.wait_for(
        "document.getElementById('sweep-warnings').textContent.includes('bend2a stays while segment 2 bends')",
    );
    browser.picture("sweep-stuck.png");
    assert_eq!(errors(&browser), Vec::<&String>::new());
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn without_a_camera_the_guide_names_what_can_be_done_and_what_cannot() {
    let run = MonitorRun::live(&[]);
    let mut browser = opened(&run);
    browser.value(
        "{ const truth = document.getElementById('sweep-truth'); truth.value = 'none'; truth.dispatchEvent(new Event('change')) }",
    );
    browser.wait_for("!document.getElementById('sweep-next').hidden");
    let text = browser.text("sweep-next");
    assert!(text.contains("calibrate cannot fit the maps of the bend sensors"), "{text}");
    assert!(text.contains("proprio table push OTHER.toml") && !text.contains("proprio calibrate"), "{text}");
    assert!(!browser.text("sweep-step").contains("camera"));
    browser.picture("sweep-no-camera.png");
    // The choice is kept.
    let address = run.address.clone();
    browser.open("about:blank");
    browser.open(&address);
    browser.wait_for("document.getElementById('sweep-truth').value === 'none'");
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_board_without_a_table_has_the_ranges_of_its_headings_and_counts() {
    let run = MonitorRun::without_table();
    let mut browser = opened(&run);
    assert_eq!(browser.text("arm-values"), "no estimate yet");
    browser.wait_for(&format!("/^−?\\d+° to −?\\d+°/.test({})", cell(6, 2)));
    browser.wait_for(&format!("/^\\d+ to \\d+$/.test({}) && /^\\d+ to \\d+$/.test({})", cell(6, 5), cell(6, 6)));
    browser.wait_for("/still within \\d+\\.\\d°/.test(document.getElementById('sweep-tare').textContent)");
    browser.picture("sweep-no-table.png");
    assert!(browser.errors.is_empty(), "{:?}", browser.errors);
}

/// The result of an expression that uses the guide's functions.
fn of_module(browser: &mut Browser, expression: &str) -> serde_json::Value {
    browser.value(&format!("import('/sweep.js').then(({{missing, step, warnings, commands}}) => {expression})"))
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn the_guide_counts_gaps_time_and_passes() {
    let run = MonitorRun::without_table();
    let mut browser = Browser::start();
    browser.open(&run.address);
    let gaps =
        of_module(&mut browser, "[missing([[-50, -10], [0, 43]], 45), missing([], 45), missing([[-60, 60]], 45)]");
    assert_eq!(gaps, json!([[[-10, 0]], [[-45, 45]], []]));
    let sweep = "phase: 'recording', bad_tare: [], faults: [], coupled: [], rest: null, \
                 goal: {seconds: 600, passes: 20, still_deg: 3, least_range_deg: 10, good_range_deg: 45}";
    let left = |seconds: u32, segment: &str, phase: &str| {
        format!("step({{{sweep}, seconds: {seconds}, segments: [{segment}], {phase}}}, 45, true)")
    };
    let part = "{ends_deg: [-46, 20], seen_deg: [[-46, 20]], passes: 7}";
    let all = "{ends_deg: [-46, 46], seen_deg: [[-46, 46]], passes: 20}";
    let text = of_module(&mut browser, &(left(168, part, "") + ".left"));
    assert_eq!(text, "7:12 to go; more range of segment 1; more passes of segment 1");
    let text = of_module(&mut browser, &(left(601, all, "") + ".now"));
    assert_eq!(text, "All is covered. Let the arm rest and end the recording, then stop the camera.");
    let text = of_module(&mut browser, &(left(601, all, "phase: 'recorded'") + ".now"));
    assert_eq!(text, "The sweep is complete.");
    let few = "{ends_deg: [-2, 4], seen_deg: [[-2, 4]], passes: 0}";
    let warned = format!("warnings({{{sweep}, seconds: 601, segments: [{few}], phase: 'recorded'}}, '')");
    assert_eq!(
        of_module(&mut browser, &warned),
        json!(["Segment 1 bends by 6° in all: calibrate refuses less than 10°."])
    );
    let quoted = of_module(&mut browser, "commands('a b.mcap', true)[0][0]");
    assert_eq!(quoted, "proprio align \"a b.mcap\" --camera CAMERA.csv --arm arm.toml -o sweep.csv");
}
