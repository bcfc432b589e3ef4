//! Case files ([`scene`]), the finite-element references that belong to them ([`mod@reference`]), the protocol
//! for other solvers ([`protocol`]) and what the program has with it ([`bundled`]).

// A module uses only modules above it.
pub mod scene;

pub mod reference;

pub mod protocol;

pub mod bundled;
