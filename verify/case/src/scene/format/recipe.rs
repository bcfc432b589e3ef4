//! The discretisation recipe as it is written.

use crate::scene::format::choice::choice;
use crate::scene::format::geometry::SelectorFormat;
use mtled::problem::{
    Enforcement, GradientStorage, InsideRule, MassRule, MaterialBorders, Recipe,
    VolumetricProjection, WeightFunction,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// How the body is turned into nodes, supports and quadrature points.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscretisationFormat {
    /// Where the nodes come from.
    pub cloud: CloudFormat,
    /// Distance of neighbouring nodes [m]; left out only for cloud "file".
    pub spacing: Option<f64>,
    /// Largest random move over the spacing [–], in [0, 0.5); for "jittered", where it
    /// may not be left out.
    pub jitter: Option<f64>,
    /// Of the random numbers; for "jittered", 1 if left out, and for "graded", 0 if
    /// left out, which moves nothing.
    pub seed: Option<u64>,
    /// Node positions [m] (CSV, NPY, VTU, VTK), path relative to the case
    /// file; for "file", where it may not be left out.
    pub file: Option<PathBuf>,
    /// Smaller spacings inside parts of the body; for "graded", none if left out.
    pub refine: Option<Vec<RefineSpacingFormat>>,
    /// Largest growth of the spacing per length [–]; for "graded", 0.25 if left out.
    pub growth: Option<f64>,
    /// Influence radius over nodal spacing [–], larger than 1; 1.8 if left
    /// out, 2.6 with the quadratic basis, 2 with the modified one.
    pub dilation: Option<f64>,
    /// Polynomial basis of the moving least squares; "linear" if left out.
    pub basis: Option<BasisFormat>,
    /// Weight of the second-order coefficients over that of the nodes [–], in
    /// (0, 1]; for "modified_quadratic", 1e-7 if left out.
    pub regularisation: Option<f64>,
    /// Weight function of the moving least squares; "quartic_spline" if left out.
    pub weight_function: Option<WeightFunctionFormat>,
    /// How the mass of a quadrature point is given to nodes; "moments_of_free_bodies" if left out, "even_split"
    /// with the quadratic bases, whose row sums are negative at some corners.
    pub mass: Option<MassFormat>,
    /// How prescribed displacements are enforced; "collocation" if left out.
    pub enforcement: Option<EnforcementFormat>,
    /// Which gradients of the shape functions are used; "second_order" if left out.
    pub gradients: Option<GradientsFormat>,
    /// Of consistent gradients, over the defect of plain ones [–]; 1e-3 if
    /// left out.
    pub gradient_tolerance: Option<f64>,
    /// How many digits of the gradients the forces read; "auto" if left out.
    pub gradient_storage: Option<GradientStorageFormat>,
    /// Projection of the change of volume in the bulk energy; "patches" if left out.
    pub volumetric_projection: Option<VolumetricProjectionFormat>,
    /// Borders between materials of different stiffness; "sharp" if left out.
    pub material_borders: Option<MaterialBordersFormat>,
    /// The background grid that quadrature points come from; with the defaults of its keys if left out.
    #[serde(default)]
    pub grid: GridFormat,
}

impl DiscretisationFormat {
    /// Replaces what this table chooses by a word; the rest of the recipe stays.
    pub(crate) fn choose(&self, recipe: &mut Recipe) {
        choose(&mut recipe.weight_function, self.weight_function);
        choose(&mut recipe.mass, self.mass);
        choose(&mut recipe.enforcement, self.enforcement);
        choose(&mut recipe.gradient_storage, self.gradient_storage);
        choose(&mut recipe.volumetric_projection, self.volumetric_projection);
        choose(&mut recipe.material_borders, self.material_borders);
    }
}

fn choose<T>(option: &mut T, chosen: Option<impl Into<T>>) {
    if let Some(chosen) = chosen {
        *option = chosen.into();
    }
}

choice! {
    /// Where the nodes come from.
    CloudFormat {
        /// A lattice inside the body plus boundary nodes.
        "regular" Regular,
        /// A lattice moved at random.
        "jittered" Jittered,
        /// A spacing that varies.
        "graded" Graded,
        /// Positions from a file.
        "file" File,
    }
}

/// The spacing in a part of the body.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RefineSpacingFormat {
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// Distance of neighbouring nodes there [m].
    pub spacing: f64,
}

choice! {
    /// Polynomial basis of the moving least squares.
    BasisFormat {
        "linear" Linear,
        "quadratic" Quadratic,
        /// Quadratic with small second-order coefficients (modified moving least
        /// squares): for supports too poor for the plain quadratic basis.
        "modified_quadratic" ModifiedQuadratic,
    }
}

choice! {
    /// Weight function of the moving least squares.
    WeightFunctionFormat for WeightFunction {
        "cubic_spline" CubicSpline,
        "quartic_spline" QuarticSpline,
        "exponential" Exponential,
    }
}

choice! {
    /// How the mass of a quadrature point is given to nodes.
    MassFormat for MassRule {
        /// Evenly over its support.
        "even_split" EvenSplit,
        /// In proportion to the shape functions.
        "row_sum" RowSum,
        /// As row_sum, but changed, where masses move, until each connected body has its moments of inertia, and
        /// so turns as it should.
        "moments" Moments,
        /// The same for bodies that nothing holds, row sums for others, whose critical step is longer.
        "moments_of_free_bodies" MomentsOfFreeBodies,
    }
}

choice! {
    /// How many digits of the gradients the forces read.
    GradientStorageFormat for GradientStorage {
        /// Double precision below a million support entries, single precision from there on,
        /// where the forces wait for memory.
        "auto" Automatic,
        /// Every one.
        "double" Double,
        /// Single precision: half the bytes to read. Patch tests stop at 1e-7 and
        /// displacements change by less than 1e-6 of the largest.
        "single" Single,
    }
}

choice! {
    /// How prescribed displacements are enforced.
    EnforcementFormat for Enforcement {
        /// On the nodal parameters.
        "direct" Direct,
        /// On the displacement field at the nodes.
        "collocation" Collocation,
    }
}

choice! {
    /// Projection of the change of volume in the bulk energy.
    VolumetricProjectionFormat for VolumetricProjection {
        /// None, which locks where ν is close to 0.5.
        "none" None,
        /// On patches of points where ν is larger than 0.3.
        "patches" Patches,
    }
}

choice! {
    /// Borders between materials of different stiffness, where displacements have a kink.
    MaterialBordersFormat for MaterialBorders {
        /// Nodes are put on them (not into a cloud from a file), on both faces of a layer however
        /// thin, and the stiffer side does not see the nodes of the softer one, nor its own across it.
        "sharp" Sharp,
        /// Supports reach across them, which smooths the kink: layers want 2.5 spacings.
        "straddled" Straddled,
    }
}

choice! {
    /// Which gradients of the shape functions are used.
    GradientsFormat {
        /// The derivatives of the shape functions.
        "plain" Plain,
        /// Changed as little as possible until the divergence theorem holds.
        "consistent" Consistent,
        /// The same, nearly for linear stresses too, with quadrature points moved until
        /// they integrate functions of second order.
        "second_order" SecondOrder,
    }
}

/// The background grid that quadrature points come from.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GridFormat {
    /// Edge of the largest cells [m]; instead of cells_per_spacing, which counts if it is left out. With it, or with
    /// refine, the grid is made by hand and does not follow the nodes of a graded cloud
    /// or of a file.
    pub cell: Option<f64>,
    /// Cells along one nodal spacing [–], along the local one where it varies; instead
    /// of cell. 1.26 if both are left out, two points per node in three dimensions.
    pub cells_per_spacing: Option<f64>,
    /// Cells on the boundary are halved down to this edge [m]; they are as the others if left out.
    pub boundary_cell: Option<f64>,
    /// Smaller cells in parts of the body; none if left out.
    #[serde(default)]
    pub refine: Vec<RefineCellFormat>,
    /// Gauss points per cell and direction, 1 to 5; 1 if left out.
    pub gauss_points: Option<usize>,
    /// What becomes of a cell that the boundary cuts; "volume_fraction" if left out.
    pub inside: Option<InsideFormat>,
}

/// The largest edge of cells in a part of the body.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RefineCellFormat {
    #[serde(rename = "where")]
    pub part: SelectorFormat,
    /// Edge of the largest cells there [m].
    pub cell: f64,
}

choice! {
    /// What becomes of a cell that the boundary cuts.
    InsideFormat for InsideRule {
        /// Kept whole if its centre is inside.
        "centre" Centre,
        /// A point at the centroid of the inside part with its volume.
        "volume_fraction" VolumeFraction,
    }
}
