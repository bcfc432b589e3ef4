//! `mtled warp`.

mod arguments;
mod command;
mod outputs;
mod summary;

pub use arguments::WarpArgs;
pub use command::warp;
