//! `mtled view`.

mod arguments;
mod command;

pub use arguments::ViewArgs;
pub use command::view;
