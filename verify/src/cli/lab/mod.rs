//! The commands that run a case many times.

mod args;
pub mod budget;
mod export;
mod filter;
mod ranges;
pub mod runs;
pub mod sweep;
pub mod tune;

pub(crate) use args::{StoreArgs, seconds};
