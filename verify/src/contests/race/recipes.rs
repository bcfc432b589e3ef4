//! The recipes of the meshless solver, each over a series of node spacings.

use super::challenge::Challenge;
use mtled::problem::{Basis, Cloud, MassRule, Motion, Newton, Problem, Relaxation};

/// A family of recipes that differ in the spacing only. What is not stated is the default of
/// case files.
#[derive(Debug, Clone, Copy)]
pub struct Family {
    /// Its name in tables.
    pub name: &'static str,
    /// How the static solution is computed.
    pub solver: Solver,
    /// Influence radius over spacing \[–\].
    pub dilation: Option<f64>,
    /// Cells along a spacing \[–\].
    pub cells_per_spacing: Option<f64>,
    /// Whether the basis is quadratic.
    pub quadratic: bool,
    /// Numbers of spacings along an edge of the body.
    pub spacings: &'static [usize],
}

/// How the static solution is computed.
#[derive(Debug, Clone, Copy)]
pub enum Solver {
    /// What a case file gets that names none.
    Default,
    /// Dynamic relaxation to `tolerance`, the load applied in `load_steps`.
    Relaxation { tolerance: f64, load_steps: usize },
    /// Newton's method to the relative residual `tolerance`.
    Newton { tolerance: f64 },
}

const DEFAULT: Family = Family {
    name: "default",
    solver: Solver::Default,
    dilation: None,
    cells_per_spacing: None,
    quadratic: false,
    spacings: &[4, 5, 6, 8, 12, 16, 20],
};

/// Relaxation to the accuracy of the discretisation.
const RELAXED: Family = Family {
    name: "relaxation to 1e-2",
    solver: Solver::Relaxation { tolerance: 1e-2, load_steps: 200 },
    spacings: &[4, 5, 6, 8, 12],
    ..DEFAULT
};

const NEWTON: Family = Family {
    name: "Newton to 1e-2",
    solver: Solver::Newton { tolerance: 1e-2 },
    spacings: &[4, 5, 6, 7, 8, 9, 12, 16, 20],
    ..DEFAULT
};

const NARROW: Family = Family { name: "Newton, support 1.6", dilation: Some(1.6), ..NEWTON };

const DENSE: Family =
    Family { name: "Newton, 2 cells per spacing", cells_per_spacing: Some(2.0), ..NEWTON };

const QUADRATIC: Family =
    Family { name: "Newton, quadratic basis", quadratic: true, spacings: &[4, 6, 8], ..NEWTON };

/// The recipes for a challenge.
pub fn families(challenge: Challenge) -> &'static [Family] {
    match challenge {
        Challenge::BondedBlock => &[DEFAULT, RELAXED, NEWTON, NARROW],
        _ => &[DEFAULT, RELAXED, NEWTON, DENSE, QUADRATIC],
    }
}

impl Family {
    /// Sets this recipe with `spacings` along an edge of the body.
    pub fn apply(&self, challenge: Challenge, spacings: usize, problem: &mut Problem) {
        let spacing = challenge.edge() / spacings as f64;
        let recipe = &mut problem.recipe;
        if let Cloud::Regular { spacing: old } = recipe.cloud {
            recipe.grid.cell *= spacing / old;
        }
        recipe.cloud = Cloud::Regular { spacing };
        if let Some(cells) = self.cells_per_spacing {
            recipe.grid.cell = spacing / cells;
        }
        if self.quadratic {
            recipe.basis = Basis::Quadratic;
            recipe.dilation = mtled::problem::defaults::dilation(Basis::Quadratic);
            recipe.mass = MassRule::EvenSplit;
        }
        recipe.dilation = self.dilation.unwrap_or(recipe.dilation);
        let Some(&preset) = problem.motion.relaxation() else { return };
        problem.motion = match self.solver {
            Solver::Default => return,
            Solver::Relaxation { tolerance, load_steps } => {
                Motion::Relaxed(Relaxation { tolerance, load_steps, ..preset })
            }
            Solver::Newton { tolerance } => Motion::Newton(Newton { tolerance, ..preset.newton() }),
        };
    }
}
