//! Stored records as a table: which of them, with which columns.

mod csv;
mod filter;
mod rows;

pub use filter::{FilterError, RunFilter, Wanted};
pub use rows::{quantities_are_missing, runs_table};
