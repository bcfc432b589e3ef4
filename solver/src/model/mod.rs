//! Everything that stays constant during a run, checked.

mod assembly;
pub(crate) mod blocks;
pub mod contact;
pub mod essential;
pub mod following;
mod load;
mod loaded_part;
mod loaded_volume;
mod mass;
pub(crate) mod projection;
pub mod rigid_motions;
mod stiffness;
pub mod time_step_bound;
pub(crate) mod unheld;
pub mod zero_energy;

pub use assembly::Model;
pub(crate) use blocks::{Block, Chunk};
pub use following::{CavityState, Following};
pub use load::LoadPattern;
pub(crate) use mass::masses;
pub(crate) use stiffness::{ModuliAtRest, stiffness_diagonal};
