//! Internal forces with their derivative, and the strain energy of the same points (method book,
//! section 11).
//!
//! The way of displacements `u` to forces at the nodes:
//!
//! 1. [`internal_force`] (`forces.rs`) gets `u` and runs over the blocks of [`PackedPoints`], which
//!    `layout` has made of the quadrature points once.
//! 2. `LocalVectors::gather` (`layout/local_vectors.rs`) copies `u` at the nodes of a block.
//! 3. `block_force` (`kernel/mod.rs`) goes chunk by chunk, in the instructions of this processor.
//! 4. `deformation_gradients` (`kernel/nodes.rs`) sums F = I + Σ u ⊗ Grad φ, four points at a time.
//! 5. `jacobians` (`kernel/points.rs`) and `Projection::pressures` (`projection.rs`): J, and the
//!    pressure of its projection on a patch, where the material is nearly incompressible.
//! 6. `stresses` (`kernel/points.rs`) calls the law, eight points at a time.
//! 7. `ExtraStress::add` (`kernel/extra.rs`) adds what viscosity and active fibres act with.
//! 8. `add_forces` (`kernel/nodes.rs`) adds w P Grad φ to the nodes of the block.
//! 9. `internal_force_in` adds block after block on one thread; on several `sum_in_order` does, in
//!    the same order (`layout/summation.rs`), so that bits do not depend on threads.
//!
//! The derivative goes the same way with dual numbers from 3 on, or with ∂P/∂F kept at each point
//! where the law is costly (`kernel/tangents.rs`); `stiffness.rs` has its entries. `energy.rs` takes
//! another way, point after point. `at_rest.rs` has moduli. Nothing here knows time or conditions.

mod at_rest;
mod energy;
mod forces;
mod kernel;
mod layout;
mod projection;
mod stiffness;

pub(crate) use at_rest::{ModuliAtRest, stiffness_diagonal};
pub(crate) use energy::deformation_gradients;
pub use energy::{point_volumes, potential_energy, projected_mean_stress, strain_energy};
pub use forces::{
    SmallestJacobian, Workspace, internal_force, internal_force_with, linearise,
    linearised_stiffness_times, stiffness_times,
};
pub use kernel::OwnPressures;
pub(crate) use kernel::{ChunkTangent, ENTRIES, ExtraStress, Found, Symmetric};
pub use layout::PackedPoints;
pub(crate) use layout::{Block, Chunk, GradientQuad, QUAD, StoredGradients, with_gradients};
pub use stiffness::for_each_chunk;
