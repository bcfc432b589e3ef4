//! The case file as it is written: TOML tables as plain structs, SI units.
//! Their doc comments are the descriptions of the JSON Schema.

mod case;
mod choice;
mod conditions;
mod fibres;
mod geometry;
mod material;
mod recipe;
mod time;

pub use case::{CaseFormat, DimensionFormat, RegionFormat};
pub use conditions::{
    AmplitudeFormat, BeyondFormat, DataFormat, DisplacementFormat, FluidFormat, FormulaFormat,
    ObstacleFormat, PrescribeFormat, RigidMotionFormat, RotationFormat,
};
pub use fibres::DirectionFormat;
pub use geometry::{SelectorFormat, ShapeFormat, Triple, UnitFormat};
pub use material::{MaterialFormat, PronyTermFormat, VolumetricFormat};
pub use recipe::{
    BasisFormat, CloudFormat, DiscretisationFormat, EnforcementFormat, GradientsFormat, GridFormat,
    MassFormat, MaterialBordersFormat, VolumetricProjectionFormat, WeightFunctionFormat,
};
pub use time::{
    LatticeFormat, MethodFormat, OutputFormat, PointsFormat, ProbeFormat, SolverFormat, TimeFormat,
};
