//! Commands that ask something of one case.

pub mod frequencies;
pub mod sensitivity;
pub mod unload;
