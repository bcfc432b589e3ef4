//! Volumes, surfaces and their moments from the signed distance of a body alone: cells that it
//! cuts are divided until it is linear in them, and cut there. Nothing here is used to solve.

mod cells;
mod corner;
mod cost;
mod level;
mod sampled;
mod seams;
mod simplex;
mod surface;
#[cfg(test)]
mod tests;

pub(crate) use cells::{Divided, sample};
pub(crate) use level::level;
pub(crate) use sampled::Sampled;
pub(crate) use surface::part_of_surface;
