//! Reports built from study results alone: JSON, JUnit, HTML with inline SVG,
//! Markdown, a table for the terminal; and VTU for fields.

mod change;
pub mod github;
pub mod html;
pub mod human;
pub mod json;
pub mod junit;
pub mod markdown;
mod number;
pub mod read;
#[cfg(test)]
mod sample;
pub mod svg;
pub mod versus;
mod words;
pub mod write;

pub use markdown::markdown_tables;
pub use number::{bound_text, four_digits};
pub use read::{ReportError, read_report};
pub use write::{write_atomically, write_report};
