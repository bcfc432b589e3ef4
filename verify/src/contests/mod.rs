//! How fast and accurate the solver is, beside other codes.

pub mod race;
pub mod solvers;
