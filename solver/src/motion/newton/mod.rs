//! Newton's method towards a static solution, with contact.

mod active_contacts;
mod adjoint;
mod branch;
mod correction;
mod drift;
mod equilibrate;
mod follow;
mod free_space;
mod increment;
mod inf_sup;
mod linear;
mod load_path;
mod solver;
mod taken;
mod unknowns;
mod vibration;

pub(crate) use adjoint::Balanced;
pub(crate) use equilibrate::equilibrate;
pub(crate) use follow::follow;
pub use inf_sup::{InfSup, inf_sup};
pub(crate) use vibration::{MassPlaces, Vibration};
