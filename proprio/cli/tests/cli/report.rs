//! The page of `report`: complete, self-contained, with every figure for all kinds of sessions, and no file where it fails.

use super::common::{Csv, Folder, arm, json, session, table};

const VOID: [&str; 3] = ["meta", "br", "hr"];

fn two_sessions() -> Folder {
    let folder = Folder::with("one.csv", session().to_string());
    let mut other = session();
    other.rows.truncate(100);
    folder.write("two.csv", other.to_string());
    folder
}

fn page_of(folder: &Folder, sessions: &[&str], table: &str) -> String {
    let mut args = vec!["report", "--table", table, "-o", "report.html"];
    args.extend(sessions);
    let run = folder.done(&args);
    assert_eq!((run.stdout.as_str(), run.warnings().len()), ("", 0), "{}", run.stderr);
    folder.read("report.html")
}

/// The page of one session with the reference table.
fn page(session: &Csv) -> String {
    page_of(&Folder::with("session.csv", session.to_string()), &["session.csv"], table())
}

fn blind() -> Csv {
    let mut blind = session();
    blind.remove("truth");
    blind
}

/// The text between `from` and `to`, each time.
fn between<'t>(text: &'t str, from: &str, to: &str) -> Vec<&'t str> {
    text.split(from).skip(1).map(|rest| rest.split(to).next().unwrap_or_default()).collect()
}

/// The drawings of one figure; a figure without any has no section.
fn drawings<'p>(page: &'p str, figure: &str) -> Vec<&'p str> {
    let sections = between(page, &format!("<section id=\"{figure}\">"), "</section>");
    assert!(sections.len() < 2, "one section {figure}");
    let drawings: Vec<&str> = sections.iter().flat_map(|section| between(section, "<svg ", "</svg>")).collect();
    assert_eq!(sections.len(), usize::from(!drawings.is_empty()), "no section {figure} without a drawing");
    drawings
}

/// The texts of a drawing.
fn texts(drawing: &str) -> Vec<&str> {
    between(drawing, "<text ", "</text>")
        .iter()
        .map(|text| text.split_once('>').expect("a tag ends").1.trim())
        .collect()
}

/// Every element that is opened is closed, in order, and text has no character that needs escaping.
fn assert_well_formed(page: &str) {
    let mut open = Vec::new();
    let body = page.strip_prefix("<!DOCTYPE html>").expect("a page");
    for piece in body.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').unwrap_or_else(|| panic!("a tag is not ended: {piece}"));
        assert!(open.last() == Some(&"style") || !text.contains('>'), "{piece}");
        for entity in text.split('&').skip(1) {
            assert!(
                entity.split_once(';').is_some_and(|(name, _)| ["lt", "gt", "amp", "quot", "apos"].contains(&name))
            );
        }
        let name = tag.trim_start_matches('/').split_whitespace().next().unwrap_or_default();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "closed in order");
        } else if !tag.ends_with('/') && !VOID.contains(&name) {
            open.push(name);
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
    }
    assert!(open.is_empty(), "{open:?}");
}

fn assert_self_contained(page: &str) {
    let without_namespace = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for outside in
        ["http:", "https:", "//", "src=", "href=", "url(", "@import", "<script", "<link", "<iframe", "<object"]
    {
        assert!(!without_namespace.contains(outside), "{outside}");
    }
}

#[test]
fn the_page_is_whole_and_needs_nothing_else() {
    let page = page_of(&two_sessions(), &["one.csv", "two.csv"], table());
    assert_well_formed(&page);
    assert_self_contained(&page);
}

/// A figure's name, its panels, title of x, titles of y of which each panel has one, and keys that each has.
type Expected = (&'static str, usize, &'static str, &'static [&'static str], &'static [&'static str]);

/// Six segments, twelve sensors, two sessions and all together.
#[test]
fn every_figure_has_its_panels_with_axes_units_and_a_legend() {
    let page = page_of(&two_sessions(), &["one.csv", "two.csv"], table());
    let figures: [Expected; 6] = [
        ("boxes", 3, "method", &["tip error, mm"], &["bend", "imu_o", "imu_c", "fusion", "RMSE"]),
        ("drift_error", 2 * 6, "time, s", &["angle from the true one, deg"], &["bend", "imu_o", "imu_c"]),
        ("contact", 2, "time, s", &["segment in contact"], &[]),
        ("v_orient", 12, "voltage, V", &["bend angle, deg"], &["true angle", "map"]),
        ("tip_error", 2, "time, s", &["tip error, mm"], &["bend", "imu_o", "imu_c", "fusion"]),
        ("shapes", 2 * 8, "x, mm", &["y, mm"], &["truth", "fusion"]),
    ];
    for (figure, panels, x, y, keys) in figures {
        let drawings = drawings(&page, figure);
        assert_eq!(drawings.len(), panels, "{figure}");
        for drawing in drawings {
            let texts = texts(drawing);
            assert!(texts.contains(&x) && y.iter().any(|y| texts.contains(y)), "{figure}: {texts:?}");
            assert!(keys.iter().all(|key| texts.contains(key)), "{figure}: {texts:?}");
        }
    }
}

#[test]
fn the_head_names_table_checksum_sessions_samples_and_version() {
    let page = page_of(&two_sessions(), &["one.csv", "two.csv"], table());
    let header = between(&page, "<header>", "</header>")[0];
    let file = calibration_tables::ArmFile::load(table().as_ref()).expect("the reference table");
    let checksum = file.compile::<estimator_core::Q>(10.0).expect("a table").checksum();
    for expected in [
        table(),
        &format!("{checksum:08x}"),
        "planar-6",
        "one.csv: 150 samples, 14.9 s",
        "two.csv: 100 samples, 9.9 s",
        env!("CARGO_PKG_VERSION"),
    ] {
        assert!(header.contains(expected), "{expected} in {header}");
    }
}

#[test]
fn figures_for_a_paper_are_single_files_as_wide_as_columns() {
    let folder = two_sessions();
    let args = ["report", "one.csv", "two.csv", "--table", table(), "-o", "report.html", "--figures", "figures"];
    folder.done(&args);
    let files = std::fs::read_dir(folder.path("figures")).expect("the folder is made");
    let mut names: Vec<String> =
        files.map(|file| file.expect("an entry").file_name().into_string().expect("a name")).collect();
    names.sort();
    assert_eq!(names.len(), 3 + 2 * 6 + 2 * 2 + 2 + 12 + 2 + 2 * 8, "{names:?}");
    for (name, width) in [
        ("boxes-all.svg", "84.9mm"),
        ("drift_error-two-segment-3.svg", "84.9mm"),
        ("tip_error-one.svg", "178.0mm"),
        ("shapes-one-median.svg", "65.1mm"),
    ] {
        let svg = folder.read(&format!("figures/{name}"));
        assert!(svg.starts_with(&format!("<svg width=\"{width}\" ")) && svg.ends_with("</svg>\n"), "{name}: {svg}");
        assert!(!svg.contains("\"sans-serif\"") && svg.contains("xmlns="), "{name}");
    }
    let error = folder.refused(&args.map(|arg| if arg == "report.html" { "other.html" } else { arg }));
    assert!(error.starts_with("figures"), "{error}");
}

#[test]
fn every_colour_has_one_for_dark_pages() {
    let page = page(&session());
    let style = between(&page, "<style>", "</style>")[0];
    let drawn = ["fill=\"#", "stroke=\"#"].iter().flat_map(|attribute| {
        between(&page[page.find("<body").expect("a body")..], attribute, "\"")
            .into_iter()
            .map(move |hex| (attribute, hex))
    });
    let mut seen = 0;
    for (attribute, hex) in drawn {
        assert!(style.contains(&format!("[{attribute}{hex}\"]")), "{attribute}{hex}");
        seen += 1;
    }
    assert!(seen > 100);
    assert!(style.contains("prefers-color-scheme: dark"));
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    let bytes = || {
        let folder = two_sessions();
        let outputs = ["-o", "r.html", "--json", "r.json", "--csv", "r.csv"];
        folder.done(&[&["report", "one.csv", "two.csv", "--table", table()][..], &outputs].concat());
        ["r.html", "r.json", "r.csv"].map(|name| folder.read(name))
    };
    assert!(bytes() == bytes());
}

#[test]
fn a_session_without_truth_has_drift_and_shapes_and_is_named() {
    let page = page(&blind());
    assert_well_formed(&page);
    assert!(page.contains("session.csv has no truth"));
    let panels =
        ["boxes", "drift_error", "v_orient", "tip_error", "shapes"].map(|figure| drawings(&page, figure).len());
    assert_eq!(panels, [0, 6, 12, 0, 8]);
    let title = "angle from bend sensors, deg";
    assert!(drawings(&page, "drift_error").iter().all(|drawing| texts(drawing).contains(&title)));
}

#[test]
fn sessions_with_and_without_truth_go_together() {
    let folder = Folder::with("seen.csv", session().to_string());
    folder.write("blind.csv", blind().to_string());
    let page = page_of(&folder, &["blind.csv", "seen.csv"], table());
    assert!(page.contains("blind.csv has no truth") && !page.contains("seen.csv has no truth"));
    assert_eq!(drawings(&page, "boxes").len(), 2);
    assert_eq!(drawings(&page, "shapes").len(), 16);
}

#[test]
fn truth_without_headings_is_named_and_its_tip_errors_are_shown() {
    let mut places = session();
    (1..=6).for_each(|i| places.remove(&format!("truth{i}_heading")));
    let page = page(&places);
    assert!(page.contains("session.csv has true places without headings"));
    assert_eq!(drawings(&page, "tip_error").len(), 1);
}

#[test]
fn a_table_without_bend_sensors_shows_imu_o_alone() {
    let folder = Folder::with("session.csv", session().to_string());
    let description = std::fs::read_to_string(arm()).expect("the description is committed");
    folder.write("bare.toml", description.replace("offset_at", "bend = []\noffset_at"));
    let page = page_of(&folder, &["session.csv"], "bare.toml");
    assert_well_formed(&page);
    assert!(page.contains("The table has no bend sensors"));
    let panels =
        ["boxes", "drift_error", "v_orient", "tip_error", "shapes"].map(|figure| drawings(&page, figure).len());
    assert_eq!(panels, [1, 6, 0, 1, 8]);
    let errors = texts(drawings(&page, "tip_error")[0]);
    assert!(errors.contains(&"imu_o") && !errors.contains(&"fusion"), "{errors:?}");
}

/// An arm of `segments` segments that stands still, a bend sensor on each, without truth.
fn still(segments: usize) -> Folder {
    let mut table = "format = 1\narm = \"still\"\nrate_hz = 10.0\n".to_owned();
    let columns: Vec<String> = (1..=segments).map(|i| format!("bend{i}a_adc,imu{i}_deg")).collect();
    for _ in 0..segments {
        table += "[[segment]]\nlength_mm = 80.0\noffset_mm = 17.0\noffset_at = \"end\"\n";
        table += "bend = [{ c0 = -1.0, c1 = 0.6, c2 = 0.0 }]\n";
    }
    let rows = (0..20).map(|row| format!("{}{}\n", f64::from(row) / 10.0, ",2068,0.0".repeat(segments)));
    let folder = Folder::with("table.toml", table);
    folder.write("session.csv", format!("time_s,{}\n{}", columns.join(","), rows.collect::<String>()));
    folder
}

#[test]
fn arms_of_one_and_of_sixteen_segments_are_shown() {
    for segments in [1, 16] {
        let page = page_of(&still(segments), &["session.csv"], "table.toml");
        assert_well_formed(&page);
        assert_eq!(drawings(&page, "drift_error").len(), segments);
        assert_eq!(drawings(&page, "v_orient").len(), segments);
        assert_eq!(drawings(&page, "shapes").len(), 8);
    }
}

#[test]
fn a_session_of_one_row_is_shown() {
    let mut one = session();
    one.rows.truncate(1);
    assert_well_formed(&page(&one));
}

#[test]
fn names_with_markup_are_text() {
    let name = "<script>alert('&amp;\"')<b>.csv".replace('/', "");
    let folder = Folder::with(&name, session().to_string());
    let description = std::fs::read_to_string(table()).expect("the reference table is committed");
    folder.write("table.toml", description.replace("\"planar-6\"", "\"<i>&arm\""));
    let page = page_of(&folder, &[&name], "table.toml");
    assert_well_formed(&page);
    assert!(!page.contains("<script") && !page.contains("<b>") && !page.contains("<i>"));
    assert!(page.contains("&lt;i&gt;&amp;arm") && page.contains("&lt;script&gt;alert("));
}

#[test]
fn a_last_line_without_its_end_is_warned_of() {
    let folder = Folder::with("session.csv", session().to_string().trim_end());
    let run = folder.done(&["report", "session.csv", "--table", table(), "-o", "report.html"]);
    assert!(run.stderr.starts_with("warning: session.csv: the last line has no end"), "{}", run.stderr);
}

const OUTPUTS: [&str; 6] = ["-o", "report.html", "--json", "report.json", "--csv", "numbers.csv"];

fn refused(folder: &Folder, args: &[&str]) -> String {
    folder.refused(&[&["report"], args].concat())
}

#[test]
fn a_bad_session_leaves_no_file() {
    let folder = two_sessions();
    let mut bad = session();
    bad.set(120, "bend1a_adc", "high");
    folder.write("bad.csv", bad.to_string());
    let error = refused(&folder, &[&["one.csv", "bad.csv", "--table", table()][..], &OUTPUTS].concat());
    assert!(error.starts_with("bad.csv, line 122, column bend1a_adc"), "{error}");
}

#[test]
fn a_description_is_no_table() {
    refused(&two_sessions(), &[&["one.csv", "--table", arm()][..], &OUTPUTS].concat());
}

#[test]
fn a_place_for_the_numbers_that_does_not_exist_leaves_no_page() {
    for numbers in ["--json", "--csv"] {
        let args = ["one.csv", "--table", table(), "-o", "report.html", numbers, "none/numbers"];
        let error = refused(&two_sessions(), &args);
        assert!(error.starts_with("none/numbers: cannot be written"), "{error}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn numbers_that_find_no_room_leave_no_page() {
    for numbers in ["--json", "--csv"] {
        let args = ["one.csv", "--table", table(), "-o", "report.html", numbers, "/dev/full"];
        let error = refused(&two_sessions(), &args);
        assert!(error.starts_with("/dev/full: cannot be written"), "{error}");
    }
}

#[test]
fn a_session_is_no_place_for_an_output() {
    let folder = two_sessions();
    for output in ["-o", "--json", "--csv"] {
        let mut args = vec!["one.csv", "two.csv", "--table", table(), output, "two.csv"];
        args.extend(["-o", "report.html"].iter().skip(if output == "-o" { 2 } else { 0 }));
        let error = refused(&folder, &args);
        assert!(error.starts_with("two.csv: is read by this command"), "{error}");
    }
}

#[test]
fn two_outputs_need_two_names() {
    let args = ["one.csv", "--table", table(), "-o", "report", "--json", "./report"];
    let error = refused(&two_sessions(), &args);
    assert!(error.contains("cannot hold two outputs"), "{error}");
}

#[test]
fn the_table_has_the_figures_of_replay() {
    let folder = two_sessions();
    let page = page_of(&folder, &["one.csv", "two.csv"], table());
    let replay = json(&folder.done(&["replay", "one.csv", "two.csv", "--table", table(), "--smooth", "--json"]));
    let section = between(&page, "<section id=\"table\">", "</section>")[0];
    let bodies = between(section, "<tbody>", "</tbody>");
    let of = [&replay["sessions"][0], &replay["sessions"][1], &replay["all"]];
    assert_eq!(bodies.len(), of.len());
    for (body, of) in bodies.into_iter().zip(of) {
        for estimate in ["bend", "imu_o", "imu_c", "fusion", "smoothed"] {
            let row = between(body, &format!("{estimate}</th>"), "</tr>")[0];
            let cells = between(row, "<td", "</td>");
            let cells: Vec<&str> = cells.iter().map(|cell| cell.split_once('>').expect("a tag ends").1).collect();
            let metrics = if estimate == "smoothed" { &of["smoothed"] } else { &of["methods"][estimate] };
            let stated = if estimate == "fusion" { &of["uncertainty"] } else { &metrics["uncertainty"] };
            let shown = |value: &serde_json::Value, digits| {
                value.as_f64().map_or_else(String::new, |value| format!("{value:.digits$}"))
            };
            let errors = ["tip_rmse_mm", "tip_rmse_percent", "tip_p75_mm", "theta_rmse_deg"];
            let mut expected = errors.map(|figure| shown(&metrics[figure], 2)).to_vec();
            expected.extend([shown(&stated["tip_inside_percent"], 1), shown(&stated["tip_nees"], 2)]);
            assert_eq!(cells, expected, "{estimate}");
        }
    }
}
