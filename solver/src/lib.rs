//! Meshless Total Lagrangian Explicit Dynamics (MTLED) for soft tissue.
//!
//! State a [`Problem`], set it up as a [`Simulation`], run it:
//!
//! ```
//! use mtled::{
//!     Amplitude, ElasticConstants, EssentialCondition, Law, Material, NeoHookeanLogJ, Problem,
//!     Recipe, Selector, Shape, Simulation, Unobserved, Vector3,
//! };
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A block of tissue with edges of 0.1 m and nodes 0.025 m apart.
//! let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.1) };
//! let law = NeoHookeanLogJ::new(ElasticConstants::from_young_poisson(3000.0, 0.45)?);
//! let tissue = Material { density: 1000.0, law: Law::NeoHookeanLogJ(law) };
//! let mut problem = Problem::new(body, tissue, Recipe::with_spacing(0.025));
//!
//! // Its bottom is fixed, its top is pushed down by 10 mm.
//! let face = |z: f64| Selector::Plane {
//!     point: Vector3::new(0.0, 0.0, z),
//!     normal: Vector3::z(),
//!     tolerance: 1e-6,
//! };
//! let ramp = Amplitude::Smooth { duration: 1.0 };
//! let down = Vector3::new(0.0, 0.0, -0.01);
//! problem.conditions = vec![
//!     EssentialCondition::on_surface("bottom", face(0.0), Vector3::zeros(), ramp.clone()),
//!     EssentialCondition::on_surface("top", face(0.1), down, ramp),
//! ];
//!
//! let mut simulation = Simulation::new(&problem)?;
//! simulation.run(&mut Unobserved)?;
//! let middle = simulation.displacements_at(&[Vector3::repeat(0.05)])?[0];
//! assert!((middle.z + 0.005).abs() < 5e-4);
//! # Ok(())
//! # }
//! ```
//!
//! Behind a [`Simulation`] stand a [`Discretisation`] (nodes, quadrature points, Grad φ), a
//! [`Model`] (what stays constant) and a [`State`] (what evolves). Each is made by one function
//! from those before it, so that a study can run them one by one.
//!
//! Everything is total Lagrangian: `X` is a reference position, `Grad` means ∂/∂X, and
//! `grad_phi` is Grad φ. Units are SI throughout. The mathematics is in [`method`], what it
//! comes from in [`references`].
#![deny(missing_docs)]

// Each module uses only those above it.
pub mod algebra;

pub mod geometry;
pub mod material;

pub mod problem;

pub mod error;

pub mod discretisation;

pub mod force;

pub mod model;
pub mod motion;

pub mod audit;
pub mod frequencies;
pub mod sensitivity;
pub mod unloaded;

pub mod simulation;

pub mod method;
#[doc = include_str!("../docs/references.md")]
pub mod references {}

pub use algebra::tensor::Vector3;
pub use discretisation::Discretisation;
pub use error::Error;
pub use frequencies::{MassKind, NaturalMode, NaturalModes, body_at_rest};
pub use geometry::{DistanceFunction, Selector, Shape};
pub use material::{
    ElasticConstants, Law, Material, NeoHookeanIsochoric, NeoHookeanLogJ, VolumetricTerm,
};
pub use model::Model;
pub use motion::observe::{Continue, Observer, Unobserved, View};
pub use motion::state::State;
pub use problem::{
    Amplitude, BodyForce, EssentialCondition, Friction, Motion, Newton, Obstacle, ObstacleSide,
    Problem, Recipe, Region, Relaxation,
};
pub use sensitivity::{Adjoint, Answer};
pub use simulation::Simulation;
