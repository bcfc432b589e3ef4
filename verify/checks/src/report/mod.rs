//! Reports built from the results of studies: JSON, JUnit, HTML with inline SVG,
//! Markdown, annotations of a CI job, and a table for the terminal.

mod change;
pub mod github;
pub mod html;
pub mod human;
pub mod json;
pub mod junit;
mod labels;
pub mod markdown;
mod markdown_table;
mod number;
pub mod read;
#[cfg(test)]
mod sample;
pub mod svg;
pub mod two_runs;
pub mod write;

pub use markdown::markdown_tables;
pub use number::{bound_text, four_digits};
pub use read::read_report;
pub use write::{ensure_writable, write_atomically, write_report};
