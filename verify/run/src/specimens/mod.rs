//! Problems stated in code: simple bodies, manufactured solutions, other spacings.

pub mod simple;
pub mod spacing;
pub mod stable_step;
