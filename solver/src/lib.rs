//! Meshless Total Lagrangian Explicit Dynamics (MTLED) for soft tissue.
//!
//! One way through the crate: a [`Problem`](problem::Problem) states what is
//! to be solved, a [`Discretisation`](discretisation::Discretisation) holds
//! nodes, quadrature points and Grad φ, a [`Model`](model::Model) everything
//! that stays constant, a [`State`](state::State) what evolves, and
//! [`simulate`](simulate::simulate) marches it while an
//! [`Observer`](observe::Observer) watches.
//!
//! Everything is total Lagrangian: `X` is a reference position, `Grad` means
//! ∂/∂X, and `grad_phi` is Grad φ. Units are SI throughout.

// The floors of the house: a module uses only what stands above it.
pub mod dimension;
mod packed;
pub mod real;

mod lanes;
pub mod tensor;

pub mod material;

pub mod field;
pub mod geometry;
pub mod selection;

pub mod problem;

pub mod error;

pub mod neighbours;
pub mod nodes;
pub mod weight_function;

pub mod mls;
pub mod quadrature;

pub mod patches;

pub mod rows;

pub mod moments;
pub mod surface_rule;

pub mod consistency;

pub mod discretisation;

pub mod time_step_bound;

pub mod collocation;
pub mod load;

pub mod essential;

pub mod projection;

pub mod blocks;

pub mod mass;
pub mod stiffness;

pub mod contact;

pub mod model;

pub mod zero_energy;

mod kernel;

pub mod internal_force;

pub mod tangent;

pub mod critical_time_step;
pub mod mass_scaling;
pub mod state;

pub mod step;

pub mod energy;

pub mod observe;

pub mod pace;

pub mod balance;

pub mod equilibrium;
pub mod relaxation;

pub mod simulate;
