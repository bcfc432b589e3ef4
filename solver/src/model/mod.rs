//! Everything that stays constant during a run, checked.

mod assembly;
pub mod contact;
pub mod essential;
pub mod following;
mod load;
mod loaded_part;
mod loaded_volume;
mod mass;
pub mod rigid_motions;
pub mod time_step_bound;
pub(crate) mod unheld;
pub mod zero_energy;

pub use assembly::Model;
pub use following::{CavityState, Following};
pub use load::LoadPattern;
pub(crate) use mass::masses;
