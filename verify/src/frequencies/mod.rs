//! Natural frequencies of the body of a case.

mod measure;
mod text;

pub use measure::{Found, Unfound, find_modes, write_modes_of};
pub use text::{to_json, to_text};
