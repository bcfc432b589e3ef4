//! `mtled warp`.

mod arguments;
mod command;
mod outputs;
mod summary;

pub(crate) use arguments::WarpArgs;
pub(crate) use command::warp;
