//! How the body is turned into nodes, supports and quadrature points.

use crate::algebra::tensor::Vector3;
use crate::geometry::Selector;

/// How the body is turned into nodes, supports and quadrature points.
#[derive(Debug, Clone)]
pub struct Recipe {
    /// Where the nodes come from.
    pub cloud: Cloud,
    /// Influence radius over local nodal spacing \[–\].
    pub dilation: f64,
    /// Polynomial basis of the shape functions.
    pub basis: Basis,
    /// Weight function of the shape functions.
    pub weight_function: WeightFunction,
    /// Where the quadrature points come from.
    pub grid: BackgroundGrid,
    /// How the lumped mass is formed.
    pub mass: MassRule,
    /// How prescribed displacements are enforced.
    pub enforcement: Enforcement,
    /// Which Grad φ strains and forces use.
    pub gradients: Gradients,
    /// Precision of the stored Grad φ.
    pub gradient_storage: GradientStorage,
    /// Treatment of volumetric locking.
    pub volumetric_projection: VolumetricProjection,
    /// Treatment of borders between materials.
    pub material_borders: MaterialBorders,
}

impl Recipe {
    /// Nodal spacing \[m\]; for a graded cloud the largest, and `None` for given nodes.
    pub fn spacing(&self) -> Option<f64> {
        match self.cloud {
            Cloud::Regular { spacing }
            | Cloud::Jittered { spacing, .. }
            | Cloud::Graded { spacing, .. } => Some(spacing),
            Cloud::Given { .. } => None,
        }
    }

    /// Multiplies every spacing and cell size with `factor`; given nodes stay.
    pub fn scale_lengths(&mut self, factor: f64) {
        let scale = |refinements: &mut Vec<Refinement>| {
            refinements.iter_mut().for_each(|refinement| refinement.size *= factor);
        };
        match &mut self.cloud {
            Cloud::Regular { spacing } | Cloud::Jittered { spacing, .. } => *spacing *= factor,
            Cloud::Graded { spacing, refinements, .. } => {
                *spacing *= factor;
                scale(refinements);
            }
            Cloud::Given { .. } => {}
        }
        let grid = &mut self.grid;
        grid.cell *= factor;
        grid.boundary_cell = grid.boundary_cell.map(|cell| cell * factor);
        scale(&mut grid.refinements);
    }
}

/// Where the nodes come from (method book, section 5).
#[derive(Debug, Clone)]
pub enum Cloud {
    /// Lattice points inside the body plus boundary nodes.
    Regular {
        /// \[m\]
        spacing: f64,
    },
    /// As `Regular`, with the interior nodes moved at random; boundary nodes
    /// slide along the boundary where that is possible, or stay.
    Jittered {
        /// \[m\]
        spacing: f64,
        /// Largest movement in each direction over the spacing \[–\].
        jitter: f64,
        /// Of the random numbers.
        seed: u64,
    },
    /// A spacing that varies: `spacing` far away, each refinement its own
    /// inside its part.
    Graded {
        /// \[m\]
        spacing: f64,
        /// Parts with smaller spacings.
        refinements: Vec<Refinement>,
        /// Largest growth of the spacing per length \[–\].
        growth: f64,
        /// Other than 0 moves the tree of lattices from which nodes are chosen.
        seed: u64,
    },
    /// Nodes given one by one; the local spacing is estimated.
    Given {
        /// Reference positions \[m\].
        nodes: Vec<Vector3>,
    },
}

/// A smaller size inside a part of the body.
#[derive(Debug, Clone)]
pub struct Refinement {
    /// Where.
    pub part: Selector,
    /// Spacing or cell edge \[m\].
    pub size: f64,
}

/// Polynomial basis of the moving least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Basis {
    /// 1, x, y, z (1, x, y in a plane).
    Linear,
    /// All monomials up to second order.
    Quadratic,
    /// All monomials up to second order, those of second order with a penalty:
    /// defined wherever the linear basis is, and close to the quadratic one
    /// where that is sound (modified moving least squares, Joldes et al. 2015).
    ModifiedQuadratic {
        /// Penalty on the coefficients of second order \[–\].
        regularisation: f64,
    },
}

/// Weight function W(q) of the scaled distance q = |X − X_a|/r_a (method book, eq. 6.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WeightFunction {
    /// Two cubic pieces that meet at q = ½.
    CubicSpline,
    /// 1 − 6q² + 8q³ − 3q⁴.
    QuarticSpline,
    /// A Gaussian, shifted and scaled to vanish at q = 1.
    Exponential,
}

/// The background grid that the quadrature points come from; it need not
/// conform to the geometry (method book, section 7).
#[derive(Debug, Clone)]
pub struct BackgroundGrid {
    /// Edge of the largest cells \[m\]; infinite where `cells_per_spacing` alone decides.
    pub cell: f64,
    /// Cells are divided where the local nodal spacing is smaller, until so many lie along
    /// it \[–\]; `None` where only the boundary and the refinements divide them.
    pub cells_per_spacing: Option<f64>,
    /// Cells that meet the boundary of the body are halved until they are no
    /// larger than this \[m\]; `None` leaves them.
    pub boundary_cell: Option<f64>,
    /// Cells that meet a part are halved until they are no larger than its size.
    pub refinements: Vec<Refinement>,
    /// Gauss points per cell and direction.
    pub gauss_points: usize,
    /// Treatment of cells that the boundary cuts.
    pub inside: InsideRule,
}

/// What becomes of a cell that the boundary cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InsideRule {
    /// Kept whole if its centre is inside, dropped otherwise (Horton 2007,
    /// section 2.3).
    Centre,
    /// A point at the centroid of the inside part with the inside volume.
    VolumeFraction,
}

/// How the mass of a quadrature point is divided among its support nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MassRule {
    /// In equal parts (Horton 2007, section 2.5).
    EvenSplit,
    /// In proportion to the shape functions: m_a = Σ_q ρ w_q φ_a.
    RowSum,
    /// Row sums that are changed, where masses move, until each connected body has its moments of inertia,
    /// and so turns as it should.
    Moments,
    /// The same for bodies that nothing holds; row sums for others, whose critical step is longer.
    MomentsOfFreeBodies,
}

impl MassRule {
    /// Whether some bodies have their moments of inertia.
    pub fn has_moments(self) -> bool {
        matches!(self, MassRule::Moments | MassRule::MomentsOfFreeBodies)
    }
}

/// Which Grad φ strains and forces use (method book, section 9).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gradients {
    /// The derivatives of φ; a uniform stress is then not in equilibrium.
    Plain,
    /// Changed as little as possible until the divergence theorem holds for
    /// every node.
    Consistent {
        /// Remaining defect over that of plain gradients \[–\].
        tolerance: f64,
    },
    /// The same, nearly for linear stresses too, with quadrature points moved until
    /// they integrate functions of second order (method book, eqs. 7.6 and 9.11).
    SecondOrder {
        /// Of the divergence theorem, as above \[–\].
        tolerance: f64,
    },
}

impl Gradients {
    /// Remaining defect over that of plain gradients \[–\]; `None` for plain ones.
    pub fn tolerance(self) -> Option<f64> {
        match self {
            Gradients::Plain => None,
            Gradients::Consistent { tolerance } | Gradients::SecondOrder { tolerance } => {
                Some(tolerance)
            }
        }
    }

    /// The same gradients with another tolerance \[–\].
    pub fn with_tolerance(self, tolerance: f64) -> Gradients {
        match self {
            Gradients::Plain => Gradients::Plain,
            Gradients::Consistent { .. } => Gradients::Consistent { tolerance },
            Gradients::SecondOrder { .. } => Gradients::SecondOrder { tolerance },
        }
    }

    /// Whether linear stresses are integrated too.
    pub fn is_second_order(self) -> bool {
        matches!(self, Gradients::SecondOrder { .. })
    }
}

/// Precision of the stored Grad φ; all arithmetic is in double precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GradientStorage {
    /// Single precision from a million support entries on
    /// ([`SINGLE_FROM`](super::defaults::SINGLE_FROM)), where the forces wait for memory; double
    /// precision below.
    Automatic,
    /// 28 bytes per support entry.
    Double,
    /// Rounded once to single precision, 16 bytes per support entry.
    /// Relative errors of 6·10⁻⁸ in each gradient leave patch tests
    /// at 10⁻⁷ and change displacements by less than 10⁻⁶ of the largest.
    Single,
}

/// Projection of J in the bulk energy, against volumetric locking (method book,
/// section 10).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumetricProjection {
    /// J of each quadrature point: nearly incompressible materials lock.
    None,
    /// J projected onto linear functions on patches of quadrature points where the
    /// material is nearly incompressible, J of each point elsewhere.
    Patches,
}

/// Borders between regions of different stiffness, where displacements have a kink (method
/// book, section 6).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MaterialBorders {
    /// Supports reach across them, which smooths the kink.
    Straddled,
    /// Nodes lie on them, and points do not see nodes that are softer than they are.
    Sharp,
}

/// How prescribed displacements are enforced, as shape functions do not
/// interpolate (method book, section 15).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Enforcement {
    /// The nodal parameter is set to the prescribed value (Horton 2007, section 2.7).
    Direct,
    /// The displacement field takes the prescribed value at the nodes, by
    /// constraint forces on all parameters in their supports (EBCIEM, Joldes et
    /// al. 2017).
    Collocation,
}
