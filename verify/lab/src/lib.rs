//! Many runs: sweeps, tuning and budgets ([`lab`]), contests between programs ([`contests`]), suites of a
//! user's own ([`suite`]), sensitivities and unloaded shapes. Nothing here knows the studies.

// A module uses only modules above it.
pub mod lab;

pub mod contests;
pub mod suite;

pub mod sensitivity;
pub mod unloaded;
