//! The file of budgets, and the figures that exceed theirs.

use toml_edit::{DocumentMut, Item};

use crate::figure::Figure;

const BUDGETS: &str = include_str!("../../../budgets.toml");

/// True if a figure keeps to a budget.
type Keeps = fn(f64, f64) -> bool;

/// Sides of its budget that a figure may have to be on.
const SIDES: [(&str, Keeps); 2] =
    [("at_most", |value, budget| value <= budget), ("at_least", |value, budget| value >= budget)];

/// Prints every figure with its budget.
///
/// # Errors
/// The names of the figures that are out of theirs, or of budgets without a figure.
pub fn check(figures: &[Figure]) -> Result<(), String> {
    let document: DocumentMut = BUDGETS.parse().map_err(|error| format!("budgets.toml: {error}"))?;
    let mut out = Vec::new();
    println!("\n{:<20}{:>12}{:>20}", "figure", "measured", "budget");
    for (side, keeps) in SIDES {
        let budgets = document.get(side).and_then(Item::as_table).into_iter().flat_map(|table| table.iter());
        for (name, budget) in budgets {
            let figure = figures.iter().find(|figure| figure.name == name);
            let (Some(figure), Some(budget)) = (figure, number(budget)) else {
                return Err(format!("budgets.toml: {name} is not a number for anything that is measured"));
            };
            let kept = keeps(figure.value, budget);
            let (side, verdict) = (side.replace('_', " "), if kept { "" } else { "  OUT OF BUDGET" });
            println!("{name:<20}{:>12}{side:>10}{budget:>10}{verdict}", rounded(figure.value));
            if !kept {
                out.push(name.to_owned());
            }
        }
    }
    if out.is_empty() { Ok(()) } else { Err(format!("out of budget: {}", out.join(", "))) }
}

fn number(item: &Item) -> Option<f64> {
    item.as_float().or_else(|| item.as_integer().map(|integer| integer as f64))
}

/// To hundredths, without zeros at the end.
fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}
