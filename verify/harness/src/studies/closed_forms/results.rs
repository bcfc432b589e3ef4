//! Computed values against closed forms.

use crate::studies::workbench::{exact, relative_error};
use mtled_checks::study::{Cell, Check};

/// Bound on the relative error of closed forms \[–\].
pub(crate) const BOUND: f64 = 0.01;

/// Checks, and rows of a table.
#[derive(Default)]
pub(crate) struct Results {
    pub checks: Vec<Check>,
    pub rows: Vec<Vec<Cell>>,
}

impl Results {
    /// Adds a check of the relative error of a value and its row in the table.
    pub(crate) fn value(
        &mut self,
        (id, quantity, unit): (&str, &str, &str),
        (computed, closed_form): (f64, f64),
        source: &str,
    ) {
        let error = relative_error(computed, closed_form);
        self.relative(id, &format!("{quantity}: relative error"), error, BOUND, source);
        self.rows.push(vec![
            Cell::Text(quantity.into()),
            Cell::Text(unit.into()),
            Cell::Number(computed),
            Cell::Number(closed_form),
            Cell::Number(error),
        ]);
    }

    /// Adds a check of an error that is relative already.
    pub(crate) fn relative(&mut self, id: &str, label: &str, error: f64, bound: f64, source: &str) {
        self.checks.push(exact(&format!("closed_forms/{id}"), label, error, bound, source));
    }
}
