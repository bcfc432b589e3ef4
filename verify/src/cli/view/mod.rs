//! `mtled view`.

mod arguments;
mod command;

pub(crate) use arguments::ViewArgs;
pub(crate) use command::view;
