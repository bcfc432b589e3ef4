//! Natural frequencies of the body of a case.

mod files;
mod measure;
mod text;

pub use files::write_modes_of;
pub use measure::{Unfound, find_modes};
pub use text::{to_json, to_text};
