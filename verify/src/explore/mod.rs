//! Many runs: kept, split, searched.

pub mod budget;
pub mod store;
pub mod sweep;
pub mod tune;
