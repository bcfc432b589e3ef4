//! What the recipes of programs cost at equal error, as a table.

use super::judged::{Judged, Spent};
use super::results::OWN;
use super::run_tables::label;
use super::tables::{ErrorCosts, cost_cell, error_costs};
use crate::lab::label::percent;
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use mtled_checks::study::{Cell, Table, number, text};
use mtled_run::accuracy::Cost;

/// The cheapest recipe of every program over mtled, a row per problem and error. None where mtled
/// did not take part, or no program with several recipes.
pub(crate) fn programs(all: &Judged) -> Option<Table> {
    let default = all.solvers.iter().position(|solver| solver.name == OWN)?;
    let mut names: Vec<&str> = all.solvers.iter().map(|solver| &*solver.program).collect();
    names.sort_unstable();
    names.dedup();
    if names.len() == all.solvers.len() {
        return None;
    }
    let others: Vec<&str> = names.into_iter().filter(|name| *name != OWN).collect();
    let spent = all.spent();
    let rows = all.cases.iter().flat_map(|case| {
        let row = |at: &ErrorCosts| row(all, default, &others, at);
        error_costs(case, spent).iter().map(row).collect::<Vec<_>>()
    });
    let mut columns = vec![text("problem"), text("rms error")];
    columns.extend([number("mtled", "s"), number("its cheapest recipe", "s")]);
    let over = others.iter().map(|name| number(&format!("{} over that", printable(name)), "1"));
    columns.extend(over);
    columns.push(number("best of these over mtled", "1"));
    let title = match spent {
        Spent::Solution => "CPU time at equal error, each program by its cheapest recipe",
        Spent::Process => {
            "CPU time of processes at equal error, each program by its cheapest recipe"
        }
    };
    Some(Table { title: title.into(), columns, rows: rows.collect() })
}

fn row(all: &Judged, default: usize, others: &[&str], at: &ErrorCosts) -> Vec<Cell> {
    let cheapest = |program: &str| {
        let recipes = all.solvers.iter().enumerate().filter(|(_, known)| known.program == program);
        let costs = recipes.filter_map(|(n, _)| at.costs[n]);
        costs.min_by(|a, b| a.value.total_cmp(&b.value))
    };
    let best = cheapest(OWN);
    let mut cells = vec![label(&at.case.of.id), label(percent(at.error))];
    cells.extend([at.costs[default], best].map(|cost| cost_cell(true, cost)));
    cells.extend(others.iter().map(|name| ratio(cheapest(name), best)));
    let rivals = others.iter().filter_map(|name| cheapest(name));
    let rival = rivals.min_by(|a, b| a.value.total_cmp(&b.value));
    cells.push(ratio(rival, at.costs[default]));
    cells
}

/// A cost over another, marked where one of them is an upper bound only, and in brackets where both
/// are.
fn ratio(cost: Option<Cost>, own: Option<Cost>) -> Cell {
    let Some((cost, own)) = cost.zip(own) else { return label("–") };
    let ratio = cost.value / own.value;
    let shown = four_digits(ratio);
    match (cost.at_most, own.at_most) {
        (false, false) => Cell::Number(ratio),
        (true, false) => label(format!("< {shown}")),
        (false, true) => label(format!("> {shown}")),
        (true, true) => label(format!("({shown})")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_of_upper_bounds_says_so() {
        let cost = |value: f64, at_most: bool| Some(Cost { value, at_most });
        assert_eq!(ratio(cost(3.0, false), cost(2.0, false)), Cell::Number(1.5));
        assert_eq!(ratio(cost(3.0, true), cost(2.0, false)), label("< 1.500"));
        assert_eq!(ratio(cost(3.0, false), cost(2.0, true)), label("> 1.500"));
        assert_eq!(ratio(cost(3.0, true), cost(2.0, true)), label("(1.500)"));
        assert_eq!(ratio(None, cost(2.0, true)), label("–"));
    }
}
