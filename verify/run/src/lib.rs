//! A case to its result: runs with error bars and audit ([`run`]), what is drawn of them ([`display`],
//! [`picture`]), natural frequencies, warped images, and their errors against references ([`accuracy`]).

// A module uses only modules above it.
pub mod machine;

pub mod specimens;

pub mod display;
pub mod picture;

pub mod run;

pub mod accuracy;
pub mod frequencies;
pub mod warp;
