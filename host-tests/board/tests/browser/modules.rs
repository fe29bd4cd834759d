//! Results of the page's modules, computed in the browser.

use std::path::Path;

use board_tests::browser::{Browser, MonitorRun};

fn opened() -> (MonitorRun, Browser) {
    let run = MonitorRun::session(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../sessions/scenario-2.csv"));
    let mut browser = Browser::start();
    browser.screen([1400, 1000], "light");
    browser.open(&run.address);
    (run, browser)
}

/// Evaluates statements that use the modules of the page.
fn with_modules(browser: &mut Browser, work: &str) -> serde_json::Value {
    let names = ["store", "arm", "plot"];
    let imports: String = names.map(|name| format!("const {name} = await import('/{name}.js');")).concat();
    browser.value(&format!("(async () => {{ {imports} {work} }})()"))
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn the_store_keeps_the_last_rows_and_finds_them_by_time() {
    let (_run, mut browser) = opened();
    let work = "const kept = new store.Store(['a', 'b'], 100); \
                for (let i = 0; i < 1000; i++) kept.push(i / 10, [i, null]); \
                const row = kept.rowAt(95.06); \
                return [kept.count, kept.first, kept.last, kept.column('a')[row], kept.column('b')[row], kept.column('a')[kept.rowAt(0)]];";
    let found = with_modules(&mut browser, work);
    assert_eq!(found, serde_json::json!([100, 90, 99.9, 950, null, 900]));
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_single_sample_s_spike_is_in_the_picture_however_long_the_span_is() {
    let (_run, mut browser) = opened();
    let work = "const n = 60000, times = Float64Array.from({length: n}, (_, i) => i / 100); \
                const column = new Float32Array(n); column[34567] = 99; column[1234] = -7; \
                for (let i = 20000; i < 20200; i++) column[i] = NaN; \
                const pieces = plot.pieces(times, column, 0, n, (t) => t, (v) => v); \
                const heights = pieces.flatMap((piece) => piece.filter((_, i) => i % 2)); \
                const at = pieces[1].indexOf(99); \
                return [Math.max(...heights), Math.min(...heights), pieces.length, heights.length < 3000, pieces[1][at - 1]];";
    assert_eq!(with_modules(&mut browser, work), serde_json::json!([99, -7, 2, true, 346]));
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn an_ellipse_is_that_of_95_percent_of_its_covariance() {
    let (_run, mut browser) = opened();
    // 3 mm along x and 1 mm along y, and the same turned by 30°.
    let work = "const straight = arm.ellipse([9, 0, 1]), turned = arm.ellipse([7, 3.4641016, 3]); \
                return [straight, turned].flatMap(({major, minor, turn}) => [major, minor, turn * 180 / Math.PI].map((v) => Math.round(v * 1000) / 1000));";
    assert_eq!(with_modules(&mut browser, work), serde_json::json!([7.343, 2.448, 0, 7.343, 2.448, 30]));
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn uncertainty_and_contact_are_drawn_where_the_feed_has_them() {
    let (_run, mut browser) = opened();
    let work = "const {SvgContext} = await import('/export.js'); const {store: rows, arm: about} = await (await import('/sessions.js')).load('scenario-2.csv', {}); \
                const colours = {series: ['#00f'], ink: '#000', faint: '#888', grid: '#eee', paper: '#fff', bad: '#f00', trail: '#80f', font: 'sans-serif'}; \
                const draw = () => { const c = new SvgContext(); \
                    arm.drawArm(c, 400, 300, {store: rows, row: 300, geometry: about.geometry, colours}); return c.parts; }; \
                for (const name of ['end', 'in_contact']) for (let i = 1; i <= 6; i++) \
                    for (const part of ['', '_xx_mm2', '_xy_mm2', '_yy_mm2']) if (rows.column(name + i + part)) rows.column(name + i + part)[300] = NaN; \
                const bare = draw().length; \
                for (let i = 1; i <= 6; i++) Object.entries({xx: 4, xy: 0, yy: 1}).forEach(([part, value]) => { rows.column(`end${i}_${part}_mm2`)[300] = value; }); \
                const ellipses = draw().length - bare; \
                rows.column('in_contact3')[300] = 1; \
                return [ellipses, draw().filter((part) => part.includes('stroke=\"#f00\"')).length];";
    assert_eq!(with_modules(&mut browser, work), serde_json::json!([6, 1]));
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn ticks_of_time_are_those_of_clocks() {
    let (_run, mut browser) = opened();
    let work = "return [5, 9, 20, 45, 90, 140, 280, 550, 1100, 1900].map((span) => plot.timeTicks(100.3, 100.3 + span, 9).step)";
    assert_eq!(with_modules(&mut browser, work), serde_json::json!([1, 1, 5, 5, 10, 30, 60, 120, 300, 300]));
    let work = "return plot.timeTicks(57, 123, 5).found.map((time) => plot.clock(time, 15))";
    assert_eq!(with_modules(&mut browser, work), serde_json::json!(["1:00", "1:15", "1:30", "1:45", "2:00"]));
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn computed_columns_follow_the_rows_through_every_move_of_the_store() {
    let (_run, mut browser) = opened();
    let work = "const kept = new store.Store(['a'], 100); kept.push(0, [1]); \
                kept.derive('twice', (row) => 2 * kept.column('a')[row]); \
                for (let i = 1; i < 1000; i++) kept.push(i, [i]); \
                return [500, 950, 999].map((time) => kept.column('twice')[kept.rowAt(time)]);";
    assert_eq!(with_modules(&mut browser, work), serde_json::json!([1800, 1900, 1998]));
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn the_tip_s_error_and_semi_axes_are_those_of_its_columns() {
    let (_run, mut browser) = opened();
    let work = "const {KINDS} = await import('/catalogue.js'); \
                const rows = new store.Store(['x1_mm', 'y1_mm', 'truth1_x_mm', 'truth1_y_mm', 'end1_xx_mm2', 'end1_xy_mm2', 'end1_yy_mm2'], 10); \
                rows.push(0, [3, 4, 0, 0, 9, 0, 1]); rows.push(1, [3, 4, null, null, 9, 0, 1]); \
                const curves = KINDS.find(({id}) => id === 'tip_error').curves(rows); \
                return [0, 1].map((row) => curves.map(({column}) => rows.column(column)[row]).map((v) => Number.isNaN(v) ? 'none' : v.toFixed(3)));";
    let expected = serde_json::json!([["5.000", "7.343", "2.448"], ["none", "7.343", "2.448"]]);
    assert_eq!(with_modules(&mut browser, work), expected);
}

#[test]
#[ignore = "needs Chromium: .ci/browser runs it"]
fn a_segment_is_drawn_as_its_connector_and_arc_from_end_to_end() {
    let (_run, mut browser) = opened();
    // The estimate of constant curvature: an arc of 80 mm that turns by 90°, and a connector of 17 mm behind it.
    let work = "const r = 160 / Math.PI; \
                const rows = new store.Store(['theta1_deg', 'x1_mm', 'y1_mm']); rows.push(0, [90, r + 17, r]); \
                const [{line, heading}] = arm.shape(rows, 0, [{length_mm: 80, offset_mm: 17, offset_at_end: true}]); \
                const off = line.slice(0, -1).map(([x, y]) => Math.abs(Math.hypot(x - r, y) - r)); \
                return [Math.max(...off) < 0.01, line.at(-1).map((v) => Math.round(v)), Math.round(heading * 180 / Math.PI)];";
    assert_eq!(with_modules(&mut browser, work), serde_json::json!([true, [68, 51], 90]));
}
