//! An error budget with costs: the parts of the error of a case, each estimated by a run
//! in which only that part is made smaller, and the cost of that run.

mod measure;
mod parts;
mod report;

pub use measure::{BudgetRequest, measure_budget};
pub use report::{budget_study, budget_text};
