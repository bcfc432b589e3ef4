//! A user's own cases as a suite: what is asked of each stands in a file, `mtled verify --suite`
//! judges it as it judges the solver's own studies, and `mtled init` writes such a file.

mod init;
mod read;
mod run;
mod study;

pub use init::{Draft, Limits, draft, find_cases};
pub use read::Suite;
