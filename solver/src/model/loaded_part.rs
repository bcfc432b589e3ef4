//! The surface rule of the part of the boundary that a load acts on.

use crate::algebra::tensor::Vector3;
use crate::discretisation::Discretisation;
use crate::discretisation::surface_rule::SurfaceRule;
use crate::error::Error;
use crate::geometry::{CoveredPanel, Panel, Selector};
use crate::problem::Problem;

/// The part of the boundary that a load acts on.
pub struct LoadedPart<'a> {
    base: &'a SurfaceRule,
    covered: Vec<CoveredPanel>,
    /// Which panels of the whole boundary are covered.
    is_covered: Vec<bool>,
    /// The rule of what is covered, where the outline of the part cuts panels.
    own: Option<SurfaceRule>,
}

/// The resultant that the rule of the whole boundary gives may differ by this fraction of the
/// area \[–\].
const RESULTANT: f64 = 1e-3;

impl<'a> LoadedPart<'a> {
    /// Of a selection; nothing where it covers nothing.
    pub fn new(
        problem: &Problem,
        discretisation: &'a Discretisation,
        part: &Selector,
    ) -> Result<Option<LoadedPart<'a>>, Error> {
        let base = discretisation.loaded_surface();
        let covered = problem.body.covered_panels(part, base.panel_size, &problem.dimension)?;
        if covered.is_empty() {
            return Ok(None);
        }
        let mut is_covered = vec![false; base.panels.len()];
        covered.iter().for_each(|covered| is_covered[covered.index] = true);
        let own = if has_own_rule(&covered, &base.panels) {
            Some(discretisation.surface_of_part(problem, &covered)?)
        } else {
            None
        };
        Ok(Some(LoadedPart { base, covered, is_covered, own }))
    }

    /// The rule that integrates over the part.
    pub fn rule(&self) -> &SurfaceRule {
        self.own.as_ref().unwrap_or(self.base)
    }

    /// Strengths at the points of [`Self::rule`] of a density on what is covered.
    pub fn strengths(&self, nodes: usize, density: impl Fn(&Panel) -> Vector3) -> Vec<Vector3> {
        let covers = |index: usize| self.own.is_some() || self.is_covered[index];
        self.rule().strengths(
            nodes,
            |index, panel| if covers(index) { density(panel) } else { Vector3::zeros() },
        )
    }

    /// The point of the whole boundary that a point of [`Self::rule`] is, or lies in the panel
    /// of, and the fraction of it that is covered; of a prescribed node that is not known.
    pub fn point_of_whole(&self, point: usize) -> Option<(usize, Option<f64>)> {
        let rule = self.rule();
        let Some(free) = point.checked_sub(rule.prescribed_count()) else {
            return Some((point, None));
        };
        if self.own.is_none() {
            return Some((point, None));
        }
        let CoveredPanel { index, fraction, .. } = self.covered[rule.free_panels()[free] as usize];
        let free = self.base.free_panels().binary_search(&(index as u32)).ok()?;
        Some((self.base.prescribed_count() + free, Some(fraction)))
    }
}

/// Whether the outline of a part cuts panels, or curved ones have another resultant than the
/// rule of the whole boundary has.
fn has_own_rule(covered: &[CoveredPanel], panels: &[Panel]) -> bool {
    let (mut area, mut difference) = (0.0, Vector3::zeros());
    for CoveredPanel { index, panel, .. } in covered {
        let whole = &panels[*index];
        area += panel.area;
        difference += panel.area * panel.mean_normal() - whole.area * whole.mean_normal();
    }
    let is_cut = covered.iter().any(|covered| covered.fraction < 1.0);
    is_cut || difference.norm() > RESULTANT * area
}
