//! Internal forces of all blocks with their derivative, and the strain energy of the same points.

mod energy;
mod forces;
mod stiffness;

pub use energy::{point_volumes, potential_energy, projected_mean_stress, strain_energy};
pub(crate) use forces::deformation_gradients;
pub use forces::{
    OwnPressures, SmallestJacobian, Workspace, internal_force, internal_force_with, linearise,
    linearised_stiffness_times, stiffness_times,
};
pub use stiffness::for_each_chunk;
