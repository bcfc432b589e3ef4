//! Studies of the harness itself and of the cost of a run.

pub mod faults;
pub mod references;
pub mod set_up;
pub mod smallest;
pub mod work;
