//! Problems stated in code: simple bodies and manufactured solutions.

pub mod manufactured;
pub mod simple;
pub mod stable_step;
