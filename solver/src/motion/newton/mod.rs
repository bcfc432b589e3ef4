//! Newton's method towards a static solution, with contact.

mod active_contacts;
mod coarse_matrix;
mod coarse_space;
mod conjugate_gradients;
mod drift;
mod equilibrate;
mod free_space;
mod increment;
mod load_path;
mod nodal_values;
mod preconditioner;
mod pressures;
mod solver;
mod taken;

pub(crate) use equilibrate::equilibrate;
