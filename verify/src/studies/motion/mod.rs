//! Studies of energies, static solutions and the critical time step.

mod clouds;
pub mod energy;
mod specimens;
pub mod statics;
pub mod time_step;
mod time_step_clouds;
mod time_step_runs;
mod vibration;
