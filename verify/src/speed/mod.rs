//! How fast the solver is, beside the limits of the machine and other codes.

pub mod bench;
pub mod race;
pub mod solvers;
