//! Meshless Total Lagrangian Explicit Dynamics (MTLED) for soft tissue.
//!
//! One way through the crate: a [`Problem`](problem::Problem) states what is
//! to be solved, a [`Discretisation`](discretisation::Discretisation) holds
//! nodes, quadrature points and Grad φ, a [`Model`](model::Model) everything
//! that stays constant, a [`State`](motion::state::State) what evolves, and
//! [`simulate`](motion::simulate::simulate) marches it while an
//! [`Observer`](motion::observe::Observer) watches.
//!
//! Everything is total Lagrangian: `X` is a reference position, `Grad` means
//! ∂/∂X, and `grad_phi` is Grad φ. Units are SI throughout.

// The rooms of the house: each uses only what stands above it.
pub mod algebra;
pub mod discretisation;
pub mod error;
pub mod geometry;
pub mod material;
pub mod model;
pub mod motion;
pub mod problem;
