//! The recommended recipe, as constants.

use crate::problem::recipe::{
    BackgroundGrid, Basis, Cloud, Enforcement, GradientStorage, Gradients, InsideRule, MassRule,
    MaterialBorders, Recipe, VolumetricProjection, WeightFunction,
};

/// The recommended basis.
pub const BASIS: Basis = Basis::Linear;
/// Of the modified quadratic basis \[–\] (Joldes et al. 2015).
pub const REGULARISATION: f64 = 1e-7;
/// The recommended weight function.
pub const WEIGHT_FUNCTION: WeightFunction = WeightFunction::QuarticSpline;
/// The recommended enforcement of prescribed displacements.
pub const ENFORCEMENT: Enforcement = Enforcement::Collocation;
/// Of selectors that state no tolerance, over the nodal spacing \[–\]: a part may end where nodes
/// lie, and round-off does not choose whether they are in it.
pub const SELECTION_TOLERANCE: f64 = 1e-3;
/// Of consistent gradients, over the defect of plain ones \[–\].
pub const GRADIENT_TOLERANCE: f64 = 1e-3;
/// The recommended gradients.
pub const GRADIENTS: Gradients = Gradients::SecondOrder { tolerance: GRADIENT_TOLERANCE };
/// The recommended precision of stored gradients.
pub const GRADIENT_STORAGE: GradientStorage = GradientStorage::Automatic;
/// Support entries from which on gradients are held in single precision if nothing is said:
/// 28 MB of them in double precision, about as much as the last cache holds \[–\].
pub const SINGLE_FROM: usize = 1_000_000;
/// The recommended treatment of nearly incompressible materials.
pub const VOLUMETRIC_PROJECTION: VolumetricProjection = VolumetricProjection::Patches;
/// The recommended treatment of borders between materials.
pub const MATERIAL_BORDERS: MaterialBorders = MaterialBorders::Sharp;
/// The recommended treatment of cells that the boundary cuts.
pub const INSIDE: InsideRule = InsideRule::VolumeFraction;
/// Two cells per node in three dimensions: 1.26³ = 2.
pub const CELLS_PER_SPACING: f64 = 1.26;
/// Gauss points per cell and direction.
pub const GAUSS_POINTS: usize = 1;
/// Growth of the spacing of graded clouds per length \[–\].
pub const GROWTH: f64 = 0.25;
/// Seed of the random numbers of jittered clouds.
pub const SEED: u64 = 1;

/// Influence radius over nodal spacing \[–\]: a quadratic basis needs more
/// nodes in its supports.
pub fn dilation(basis: Basis) -> f64 {
    match basis {
        Basis::Linear => 1.8,
        Basis::Quadratic => 2.6,
        Basis::ModifiedQuadratic { .. } => 2.0,
    }
}

/// Row sums, but for quadratic bases, whose row sums are negative at some
/// corners.
pub fn mass(basis: Basis) -> MassRule {
    match basis {
        Basis::Linear => MassRule::MomentsOfFreeBodies,
        Basis::Quadratic | Basis::ModifiedQuadratic { .. } => MassRule::EvenSplit,
    }
}

impl Recipe {
    /// The recommended recipe on a regular cloud with nodes `spacing` \[m\] apart.
    pub fn with_spacing(spacing: f64) -> Recipe {
        Recipe {
            cloud: Cloud::Regular { spacing },
            dilation: dilation(BASIS),
            basis: BASIS,
            weight_function: WEIGHT_FUNCTION,
            grid: BackgroundGrid::with_cell(spacing / CELLS_PER_SPACING),
            mass: mass(BASIS),
            enforcement: ENFORCEMENT,
            gradients: GRADIENTS,
            gradient_storage: GRADIENT_STORAGE,
            volumetric_projection: VOLUMETRIC_PROJECTION,
            material_borders: MATERIAL_BORDERS,
        }
    }
}

impl GradientStorage {
    /// Whether so many support entries are held in single precision.
    pub fn is_single(self, entries: usize) -> bool {
        match self {
            GradientStorage::Automatic => entries >= SINGLE_FROM,
            GradientStorage::Double => false,
            GradientStorage::Single => true,
        }
    }
}

impl BackgroundGrid {
    /// Cells that follow a nodal spacing that varies, the recommended rule at the boundary.
    pub fn following(cells_per_spacing: f64) -> BackgroundGrid {
        BackgroundGrid {
            cells_per_spacing: Some(cells_per_spacing),
            ..BackgroundGrid::with_cell(f64::INFINITY)
        }
    }

    /// Cells of one edge \[m\], the recommended rule at the boundary.
    pub fn with_cell(cell: f64) -> BackgroundGrid {
        BackgroundGrid {
            cell,
            cells_per_spacing: None,
            boundary_cell: None,
            refinements: Vec::new(),
            gauss_points: GAUSS_POINTS,
            inside: INSIDE,
        }
    }
}
