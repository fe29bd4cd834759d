//! The table of a board through a monitor that has its port: from the page, and from the command line.

use std::fs;

use board_tests::due::DueProcess;
use serde_json::Value;

use crate::page::Page;
use crate::tools::{folder, proprio, table};

#[test]
fn the_page_offers_its_table_to_a_board_without_one_and_stores_it() {
    let folder = folder("table of the page");
    let arguments = ["monitor", "--virtual", "--firmware", "firmware", "--flash", "empty.bin", "--table", &table()];
    let arguments = [&arguments[..], &["--listen", "0", "--allow-control"]].concat();
    let page = Page::of(&mut proprio(&folder, &arguments));

    let before = page.wait_for_status(|status| status["board"].is_object());
    assert_eq!((&before["offers_table"], &before["board"]["table"]), (&Value::Bool(true), &Value::Null));

    let (status, text) = page.request("POST", "/table");
    assert!(status == 200 && text.contains("of arm planar-6"), "{status}: {text}");
    let after = page.wait_for_status(|status| status["board"]["table"].is_string());
    assert_eq!((&after["offers_table"], &after["board"]["arm"]), (&Value::Bool(false), &"planar-6".into()));

    let without = page.with_token("0");
    assert_eq!(without.request("POST", "/table").0, 401, "nothing is stored without the token");
}

#[test]
fn the_table_command_reaches_the_board_through_the_monitor_that_has_its_port() {
    let folder = folder("table through a monitor");
    let due = DueProcess::start(&folder);
    let table = table();
    let command = |arguments: &[&str]| proprio(&folder, &[arguments, &["--port", &due.port]].concat());
    let page = Page::of(&mut command(&["monitor", "--listen", "0", "--table", &table]));
    page.wait_for_status(|status| status["board"]["table"].is_string());
    let run = |arguments: &[&str]| {
        let output = command(arguments).output().expect("the tool starts");
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && errors.contains("through the monitor"), "{arguments:?}: {errors}");
        String::from_utf8(output.stdout).expect("the tool writes UTF-8")
    };

    run(&["table", "pull", "-o", "pulled.toml"]);
    let original = fs::read_to_string(&table).expect("the table is committed");
    assert_eq!(fs::read_to_string(folder.join("pulled.toml")).expect("it was written"), original);

    let other = original.replacen(r#"arm = "planar-6""#, r#"arm = "other""#, 1);
    fs::write(folder.join("other.toml"), &other).expect("there is room");
    let pushed = run(&["table", "push", "other.toml"]);
    assert!(pushed.contains("of arm other"), "{pushed}");
    let shown = run(&["table", "show"]);
    assert!(shown.contains("in use") && shown.contains("other"), "{shown}");

    run(&["table", "erase"]);
    let shown = run(&["table", "show"]);
    assert!(shown.contains("missing"), "{shown}");
}
