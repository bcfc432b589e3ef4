//! The stored figures and bounds of this folder for programs.

/// Every figure of the quick suite with its band and its bound, `baseline.json`.
pub static BASELINE: &str = include_str!("../baseline.json");

/// Bounds that only the full suite has, `full_bounds.json`.
pub static FULL_BOUNDS: &str = include_str!("../full_bounds.json");

/// Which checks notice the deliberate faults, `faults.json`.
pub static FAULTS: &str = include_str!("../faults.json");
