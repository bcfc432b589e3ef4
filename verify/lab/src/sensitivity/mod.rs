//! Which numbers of a static case matter most for its answers, in per cent per per cent.

mod answers;
mod measure;
mod numbers;
mod text;

pub use measure::{Unmeasured, measure};
pub use text::{to_json, to_text};
