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

pub(crate) use case::{CaseFormat, DimensionFormat, RegionFormat};
pub(crate) use conditions::{
    AmplitudeFormat, BeyondFormat, DataFormat, DisplacementFormat, FluidFormat, FormulaFormat,
    ObstacleFormat, PrescribeFormat, RigidMotionFormat, RotationFormat,
};
pub(crate) use fibres::DirectionFormat;
pub(crate) use geometry::{SelectorFormat, ShapeFormat, Triple, UnitFormat};
pub(crate) use material::{MaterialFormat, PronyTermFormat, VolumetricFormat};
pub(crate) use recipe::{
    BasisFormat, CloudFormat, DiscretisationFormat, EnforcementFormat, GradientsFormat, GridFormat,
    MassFormat, MaterialBordersFormat, VolumetricProjectionFormat, WeightFunctionFormat,
};
pub(crate) use time::{
    LatticeFormat, MethodFormat, OutputFormat, PointsFormat, ProbeFormat, SolverFormat, TimeFormat,
};
