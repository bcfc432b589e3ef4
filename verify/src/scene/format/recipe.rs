//! The discretisation recipe as it is written.

use crate::scene::format::geometry::SelectorFormat;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

/// How the body is turned into nodes, supports and quadrature points.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscretisationFormat {
    pub cloud: CloudFormat,
    /// Distance of neighbouring nodes [m]; not for cloud "file".
    pub spacing: Option<f64>,
    /// Largest random move over the spacing [–], in [0, 0.5); for "jittered".
    pub jitter: Option<f64>,
    /// Of the random numbers; for "jittered", 1 if left out, and for "graded", 0 if
    /// left out, which moves nothing.
    pub seed: Option<u64>,
    /// Node positions [m] (CSV, NPY, VTU, VTK), path relative to the case
    /// file; for "file".
    pub file: Option<PathBuf>,
    /// Smaller spacings inside parts of the body; for "graded".
    pub refine: Option<Vec<RefineSpacingFormat>>,
    /// Largest growth of the spacing per length [–]; for "graded".
    pub growth: Option<f64>,
    /// Influence radius over nodal spacing [–], larger than 1; 1.8 by default,
    /// 2.6 with the quadratic basis, 2 with the modified one.
    pub dilation: Option<f64>,
    /// "linear" by default.
    pub basis: Option<BasisFormat>,
    /// Weight of the second-order coefficients over that of the nodes [–], in
    /// (0, 1]; for "modified_quadratic", 1e-7 if left out.
    pub regularisation: Option<f64>,
    /// "quartic_spline" by default.
    pub weight_function: Option<WeightFunctionFormat>,
    /// "row_sum" by default, "even_split" with the quadratic bases, whose row
    /// sums are negative at some corners.
    pub mass: Option<MassFormat>,
    pub enforcement: Option<EnforcementFormat>,
    /// "consistent" by default.
    pub gradients: Option<GradientsFormat>,
    /// Of consistent gradients, over the defect of plain ones [–]; 1e-3 if
    /// left out.
    pub gradient_tolerance: Option<f64>,
    /// "double" by default.
    pub gradient_storage: Option<GradientStorageFormat>,
    /// "patches" by default.
    pub volumetric_projection: Option<VolumetricProjectionFormat>,
    #[serde(default)]
    pub grid: GridFormat,
}

/// Where the nodes come from.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CloudFormat {
    /// A lattice inside the body plus boundary nodes.
    Regular,
    /// A lattice moved at random.
    Jittered,
    /// A spacing that varies.
    Graded,
    /// Positions from a file.
    File,
}

/// A spacing wanted in a part of the body.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RefineSpacingFormat {
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// [m]
    pub spacing: f64,
}

/// Polynomial basis of the moving least squares.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BasisFormat {
    Linear,
    Quadratic,
    /// Quadratic with small second-order coefficients (modified moving least
    /// squares): for supports too poor for the plain quadratic basis.
    ModifiedQuadratic,
}

/// Weight function of the moving least squares.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WeightFunctionFormat {
    CubicSpline,
    QuarticSpline,
    Exponential,
}

/// How the mass of a quadrature point is given to nodes.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MassFormat {
    /// Evenly over its support.
    EvenSplit,
    /// In proportion to the shape functions.
    RowSum,
}

/// How many digits of the gradients the forces read.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GradientStorageFormat {
    /// Every one.
    Double,
    /// Single precision: half the bytes to read. Patch tests stop at 1e-7 and
    /// displacements change by less than 1e-6 of the largest.
    Single,
}

/// How prescribed displacements are enforced.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EnforcementFormat {
    /// On the nodal parameters.
    Direct,
    /// On the displacement field at the nodes.
    Collocation,
}

/// Projection of the change of volume in the bulk energy.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VolumetricProjectionFormat {
    /// None, which locks where ν is close to 0.5.
    None,
    /// On patches of points where ν is larger than 0.3.
    Patches,
}

/// Which gradients of the shape functions are used.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GradientsFormat {
    /// The derivatives of the shape functions.
    Plain,
    /// Changed as little as possible until the divergence theorem holds.
    Consistent,
}

/// The background grid that quadrature points come from.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GridFormat {
    /// Edge of the largest cells [m]; instead of cells_per_spacing.
    pub cell: Option<f64>,
    /// Cells along one nodal spacing [–]; instead of cell. 1.26 if both are
    /// left out, two points per node in three dimensions.
    pub cells_per_spacing: Option<f64>,
    /// Cells on the boundary are halved down to this edge [m].
    pub boundary_cell: Option<f64>,
    /// Smaller cells in parts of the body.
    #[serde(default)]
    pub refine: Vec<RefineCellFormat>,
    /// Gauss points per cell and direction, 1 to 5; 1 if left out.
    pub gauss_points: Option<usize>,
    pub inside: Option<InsideFormat>,
}

/// An edge of cells wanted in a part of the body.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RefineCellFormat {
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// [m]
    pub cell: f64,
}

/// What becomes of a cell that the boundary cuts; volume_fraction if left out.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InsideFormat {
    /// Kept whole if its centre is inside.
    Centre,
    /// A point at the centroid of the inside part with its volume.
    VolumeFraction,
}
