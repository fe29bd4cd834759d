//! `proprio demo`: the live page of an arm that moves.

use crate::page::Page;
use crate::tools::{folder, proprio};

#[test]
fn a_demo_moves_the_simulated_arm() {
    let folder = folder("demo");
    let page = Page::of(&mut proprio(&folder, &["demo", "--listen", "0"]));
    let pressures = |status: &serde_json::Value| status["health"]["pressures_kpa"].as_array().cloned();
    page.wait_for_status(|status| {
        let pressures = pressures(status).unwrap_or_default();
        pressures.iter().any(|pressure| pressure.as_f64().is_some_and(|kpa| kpa > 10.0))
    });
}
