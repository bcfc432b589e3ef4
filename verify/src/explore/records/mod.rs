//! Stored records as a table: which of them, with which columns, in which kind of file.
//!
//! Parquet is written here and not by its crate, which with its dependencies takes a minute of
//! processor time to compile: a table of optional texts and numbers needs one page per column and a list of
//! columns, nothing else of the format.

mod compact;
mod csv;
mod filter;
mod parquet;
mod rows;
mod table;

pub use csv::to_csv;
pub use filter::{FilterError, RunFilter, Wanted};
pub use parquet::to_parquet;
pub use rows::{quantities_are_missing, runs_table};
pub use table::{Cells, Column, Table};
