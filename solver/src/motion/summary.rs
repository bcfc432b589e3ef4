//! Outcome and cost of a run.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::error::Instability;
use crate::force::SmallestJacobian;
use crate::model::Model;
use crate::model::contact::Impacts;

/// Outcome and cost of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Steps, or corrections of Newton's method.
    pub steps: usize,
    /// Time reached \[s\].
    pub time: f64,
    /// Smallest and largest time step \[s\].
    pub time_steps: (f64, f64),
    /// Critical step in the reference configuration \[s\].
    pub critical_time_step: f64,
    /// All evaluations of the internal force, and what factors of the tangent cost in such.
    pub force_evaluations: usize,
    /// Those of them for critical time steps.
    pub lanczos_evaluations: usize,
    /// Smallest J of all quadrature points and steps.
    pub smallest_jacobian: SmallestJacobian,
    /// Estimated error \[m\] and relative residual of a static solution.
    pub relaxation: Option<Convergence>,
    /// Cost of Newton's method, which has no time steps: they are 0.
    pub newton: Option<NewtonCounts>,
    /// Newton's method where it failed before relaxation.
    pub newton_failed: Option<NewtonFailure>,
    /// Whether the observer ended the run early: a static solution has not converged.
    pub stopped: bool,
    /// Products with the tangent that looked for it, not counted elsewhere.
    pub stability_products: usize,
    /// Loss of stability on the way to a static solution.
    pub instability: Option<Instability>,
    /// Energy of a motion that obstacles took for good, if it is notable.
    pub contact_loss: Option<ContactLoss>,
}

/// J of a nearly incompressible point below which a finished run is in doubt \[–\].
const COLLAPSED: f64 = 0.3;

/// A nearly incompressible point that has lost most of its volume: the body has
/// folded there between its nodes, and the forces balance all the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollapsedPoint {
    /// Index of the quadrature point.
    pub point: usize,
    /// Reference position \[m\].
    pub position: Vector3,
    /// J = det F \[–\]
    pub jacobian: f64,
}

impl std::fmt::Display for CollapsedPoint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let CollapsedPoint { point, position: X, jacobian } = self;
        write!(
            f,
            "J fell to {jacobian:.3} at quadrature point {point} at ({:.6}, {:.6}, {:.6} m), whose material is nearly \
             incompressible: the body has folded between its nodes or collapsed at an edge, and results near \
             this point cannot be trusted; use a finer cloud, or a smaller load",
            X.x, X.y, X.z
        )
    }
}

impl Summary {
    /// How a static run ended, in words.
    pub fn ending(&self) -> &'static str {
        match self.newton {
            _ if self.stopped => "stopped before convergence",
            Some(newton) if newton.up_to_round_off => {
                "converged up to round-off, not to the tolerance"
            }
            _ => "converged",
        }
    }

    /// Reasons to doubt a finished run.
    pub fn doubts(&self, model: &Model) -> Vec<String> {
        let collapsed = self.collapsed_point(model).map(|collapsed| collapsed.to_string());
        let unstable = self.instability.iter().map(Instability::to_string);
        let lost = self.contact_loss.iter().map(ContactLoss::to_string);
        collapsed.into_iter().chain(unstable).chain(lost).collect()
    }

    /// The point that casts doubt on a finished run, if there is one.
    pub fn collapsed_point(&self, model: &Model) -> Option<CollapsedPoint> {
        let SmallestJacobian { jacobian, point } = self.smallest_jacobian;
        let block = model.points.blocks.iter().find(|block| block.points.contains(&point))?;
        let resists = block.law.projected_fraction() > 0.0;
        (resists && jacobian < COLLAPSED).then(|| CollapsedPoint {
            point,
            position: model.point_positions[point],
            jacobian,
        })
    }
}

/// Energy that obstacles took from a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLoss {
    /// \[J\]
    pub lost: f64,
    /// Over the largest kinetic energy of the body while it touched \[–\].
    pub fraction: f64,
}

/// Least notable loss \[–\].
const NOTABLE_LOSS: f64 = 0.01;

impl ContactLoss {
    /// What impacts have taken besides friction, where it is notable.
    pub(crate) fn of(impacts: &Impacts) -> Option<ContactLoss> {
        let lost = impacts.lost - impacts.rubbed;
        let fraction = lost / impacts.largest_kinetic.max(f64::MIN_POSITIVE);
        (fraction.abs() > NOTABLE_LOSS).then_some(ContactLoss { lost, fraction })
    }
}

impl std::fmt::Display for ContactLoss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ContactLoss { lost, fraction } = self;
        write!(
            f,
            "contact took {lost:.3e} J for good, {:.1} % of the largest kinetic energy of the body while it touched: \
             nodes that stick lose their motion along the obstacle at once; a finer cloud takes less",
            100.0 * fraction
        )
    }
}

/// Cost and outcome of Newton's method.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NewtonCounts {
    /// Load increments.
    pub increments: usize,
    /// Corrections, including those of failed increments.
    pub iterations: usize,
    /// Products with the tangent operator; each takes 1.3 to 1.8 times as long as
    /// an evaluation of the internal force and is counted as one.
    pub products: usize,
    /// All evaluations of the internal force, and what factors of the tangent cost in such.
    pub evaluations: usize,
    /// Largest unbalanced nodal force over the largest nodal force \[–\].
    pub residual: f64,
    /// Whether the residual is above what was asked, and round-off as large.
    pub up_to_round_off: bool,
    /// What has decided on the pressures of patches.
    pub pressures: PatchPressures,
}

impl NewtonCounts {
    /// How many corrections, and of what, in words.
    pub fn corrections(&self) -> String {
        let of = match self.pressures {
            PatchPressures::OfDisplacements => "",
            PatchPressures::Unknowns => " of displacements and pressures",
            PatchPressures::GivenUp => " (of pressures too, until these failed)",
        };
        format!("{} corrections{of}", self.iterations)
    }
}

/// What decides on the pressures of the patches of a volumetric projection.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PatchPressures {
    /// The displacements.
    #[default]
    OfDisplacements,
    /// They are unknowns beside the displacements (method book, eq. 21.13).
    Unknowns,
    /// They were, in vain for a part of the load; from there on, the displacements.
    GivenUp,
}

impl PatchPressures {
    /// In results.
    pub fn name(self) -> &'static str {
        match self {
            PatchPressures::OfDisplacements => "of_displacements",
            PatchPressures::Unknowns => "unknowns",
            PatchPressures::GivenUp => "given_up",
        }
    }
}

/// How far Newton's method came where relaxation took its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonFailure {
    /// Fraction of the load \[–\].
    pub reached: f64,
    /// Corrections.
    pub iterations: usize,
}

/// How well dynamic relaxation has converged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Estimated largest error of a displacement component \[m\].
    pub estimated_error: f64,
    /// Largest unbalanced nodal force over the largest nodal force \[–\].
    pub residual: f64,
}
