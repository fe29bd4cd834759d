//! The table from the live page onto a board that has none.

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
