//! Nodes, quadrature points, supports, φ and Grad φ: all that does not depend
//! on materials or conditions.
#![allow(non_snake_case)]

use crate::error::Error;
use crate::mls::{Approximation, PoorSupport, Support};
use crate::nodes::{NodeCloud, node_cloud};
use crate::problem::{Dimension, Problem};
use crate::quadrature::{Quadrature, quadrature};
use crate::tensor::Vector3;
use rayon::prelude::*;

/// The body, discretised.
#[derive(Debug, Clone)]
pub struct Discretisation {
    pub dimension: Dimension,
    pub cloud: NodeCloud,
    pub approximation: Approximation,
    pub quadrature: Quadrature,
    /// Supports of the quadrature points.
    pub supports: Rows,
    /// Quadrature points whose influence radii had to be enlarged.
    pub enlarged: usize,
    /// Largest condition number of a moment matrix (local scaled basis).
    pub worst_condition: f64,
}

/// Rows of φ and Grad φ, one for each evaluation point, packed.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// Row i is `starts[i]..starts[i + 1]` \[row + 1\].
    pub starts: Vec<usize>,
    pub nodes: Vec<u32>,
    /// \[–\]
    pub phi: Vec<f64>,
    /// \[1/m\]
    pub grad_phi: Vec<Vector3>,
}

/// Something that a user should know before trusting the result.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    FewerPointsThanNodes { points: usize, nodes: usize },
    EnlargedSupports { points: usize, of: usize },
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Warning::FewerPointsThanNodes { points, nodes } => write!(
                f,
                "{points} quadrature points for {nodes} nodes: with fewer points than nodes there are \
                 zero-energy modes (hourglassing) that grow without a word; use smaller cells"
            ),
            Warning::EnlargedSupports { points, of } => write!(
                f,
                "the influence radii had to be enlarged at {points} of {of} quadrature points; \
                 a larger dilation avoids that"
            ),
        }
    }
}

impl Rows {
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Entries of row `i` in the packed arrays.
    pub fn row(&self, i: usize) -> std::ops::Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    fn from_supports(supports: Vec<Support>) -> Rows {
        let mut rows = Rows { starts: vec![0], ..Rows::default() };
        for support in supports {
            rows.nodes.extend(support.nodes);
            rows.phi.extend(support.phi);
            rows.grad_phi.extend(support.grad_phi);
            rows.starts.push(rows.nodes.len());
        }
        rows
    }

    /// The value at row `i` of a nodal field with `components` per node.
    pub fn interpolate(&self, i: usize, field: &[f64], components: usize) -> Vector3 {
        let mut value = Vector3::zeros();
        for entry in self.row(i) {
            let node = self.nodes[entry] as usize;
            for k in 0..components {
                value[k] += self.phi[entry] * field[components * node + k];
            }
        }
        value
    }

    /// F = I + Σ_a u_a ⊗ Grad φ_a at row `i`.
    pub fn deformation_gradient(
        &self,
        i: usize,
        field: &[f64],
        components: usize,
    ) -> crate::tensor::Matrix3 {
        let mut F = crate::tensor::Matrix3::identity();
        for entry in self.row(i) {
            let node = self.nodes[entry] as usize;
            let mut u = Vector3::zeros();
            for k in 0..components {
                u[k] = field[components * node + k];
            }
            F += u * self.grad_phi[entry].transpose();
        }
        F
    }
}

impl Discretisation {
    /// Nodes and quadrature points of a problem with their supports. Points
    /// are sorted by region and along a space-filling curve.
    pub fn new(problem: &Problem) -> Result<Discretisation, Error> {
        problem.body.validate_body()?;
        let dimension = problem.dimension;
        // In a plane only the cross-section counts: the ends are no boundary.
        let body = problem.body.section(&dimension)?;
        let recipe = &problem.recipe;
        let cloud = node_cloud(&problem.body, &recipe.cloud, &dimension)?;
        let mut quadrature = quadrature(&body, &problem.regions, &recipe.grid, &dimension)?;
        sort_along_curve(&mut quadrature);
        let influence_radius = cloud.spacing.iter().map(|h| recipe.dilation * h).collect();
        let approximation = Approximation::new(
            cloud.positions.clone(),
            influence_radius,
            recipe.basis,
            recipe.weight_function,
            &dimension,
        );
        let supports = evaluate_all(&approximation, &quadrature.positions)?;
        let enlarged = supports.iter().filter(|support| support.enlargement > 1.0).count();
        let worst_condition = supports.iter().map(|support| support.condition).fold(0.0, f64::max);
        let supports = Rows::from_supports(supports);
        check_coverage(&cloud, &supports)?;
        Ok(Discretisation {
            dimension,
            cloud,
            approximation,
            quadrature,
            supports,
            enlarged,
            worst_condition,
        })
    }

    /// Rows of φ and Grad φ at any points of the body \[m\].
    pub fn rows_at(&self, positions: &[Vector3]) -> Result<Rows, Error> {
        let supports: Result<Vec<Support>, Error> = positions
            .iter()
            .map(|X| {
                self.approximation.evaluate(X).map_err(|poor| Error::ProbeOutside {
                    position: *X,
                    reason: format!(
                        "{} nodes in its support, condition {:.1e}",
                        poor.support_size, poor.condition
                    ),
                })
            })
            .collect();
        Ok(Rows::from_supports(supports?))
    }

    /// Mean number of support nodes per quadrature point.
    pub fn mean_support(&self) -> f64 {
        self.supports.nodes.len() as f64 / self.supports.len() as f64
    }

    /// What a user should know before trusting a result.
    pub fn warnings(&self) -> Vec<Warning> {
        let (points, nodes) = (self.supports.len(), self.cloud.positions.len());
        let mut warnings = Vec::new();
        if points < nodes {
            warnings.push(Warning::FewerPointsThanNodes { points, nodes });
        }
        if self.enlarged > 0 {
            warnings.push(Warning::EnlargedSupports { points: self.enlarged, of: points });
        }
        warnings
    }
}

fn evaluate_all(
    approximation: &Approximation,
    positions: &[Vector3],
) -> Result<Vec<Support>, Error> {
    let results: Vec<Result<Support, PoorSupport>> =
        positions.par_iter().map(|X| approximation.evaluate(X)).collect();
    let locate = |(point, result): (usize, Result<Support, PoorSupport>)| {
        result.map_err(|poor| match poor.support_size < approximation.smallest_support() {
            true => Error::SmallSupport {
                point,
                position: positions[point],
                support_size: poor.support_size,
                smallest: approximation.smallest_support(),
            },
            false => Error::SingularMomentMatrix {
                point,
                position: positions[point],
                support_size: poor.support_size,
                condition: poor.condition,
                largest: approximation.largest_condition(),
            },
        })
    };
    results.into_iter().enumerate().map(locate).collect()
}

/// Every node must be covered, and every boundary node must share a support
/// with an interior node (seed, section 2.3).
fn check_coverage(cloud: &NodeCloud, supports: &Rows) -> Result<(), Error> {
    let mut covered = vec![false; cloud.positions.len()];
    let mut anchored = vec![false; cloud.positions.len()];
    for point in 0..supports.len() {
        let nodes = &supports.nodes[supports.row(point)];
        let has_interior = nodes.iter().any(|&a| !cloud.on_boundary[a as usize]);
        for &a in nodes {
            covered[a as usize] = true;
            anchored[a as usize] |= has_interior;
        }
    }
    for (node, &position) in cloud.positions.iter().enumerate() {
        if !covered[node] {
            return Err(Error::UncoveredNode { node, position });
        }
        if !anchored[node] {
            return Err(Error::IsolatedBoundaryNode { node, position });
        }
    }
    Ok(())
}

/// Sorts quadrature points by region, then along a Morton curve, so that
/// neighbours in space are neighbours in memory.
fn sort_along_curve(quadrature: &mut Quadrature) {
    let (mut min, mut max) = (quadrature.positions[0], quadrature.positions[0]);
    for X in &quadrature.positions {
        min = min.inf(X);
        max = max.sup(X);
    }
    let scale = 1023.0 / (max - min).max().max(f64::MIN_POSITIVE);
    let key = |X: &Vector3| {
        let index = (X - min) * scale;
        (0..3).map(|k| spread_bits(index[k] as u64) << k).sum::<u64>()
    };
    let mut order: Vec<usize> = (0..quadrature.positions.len()).collect();
    order.sort_by_key(|&q| (quadrature.regions[q], key(&quadrature.positions[q]), q));
    quadrature.positions = order.iter().map(|&q| quadrature.positions[q]).collect();
    quadrature.weights = order.iter().map(|&q| quadrature.weights[q]).collect();
    quadrature.regions = order.iter().map(|&q| quadrature.regions[q]).collect();
}

/// Spreads the lowest 10 bits to every third place.
fn spread_bits(x: u64) -> u64 {
    (0..10).map(|bit| ((x >> bit) & 1) << (3 * bit)).sum()
}
