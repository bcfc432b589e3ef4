//! Studies of energies, static solutions and the critical time step.

pub mod energy;
pub mod statics;
pub mod time_step;
mod vibration;
