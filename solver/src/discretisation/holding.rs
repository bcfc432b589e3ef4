//! A discretised body with what is held as a volume.

use crate::algebra::tensor::Vector3;
use crate::discretisation::consistency::connected_bodies;
use crate::discretisation::discretised_body::{Discretisation, close, quadrature_of};
use crate::discretisation::held_volume::{HeldShape, HeldVolume};
use crate::discretisation::placed_nodes::flatten;
use crate::discretisation::quadrature::Quadrature;
use crate::discretisation::rows::Rows;
use crate::discretisation::surface_rule::SurfaceRule;
use crate::error::Error;
use crate::problem::Problem;

impl Discretisation {
    /// Adds what is held as a volume, whose nodes are those from `first_node` on.
    pub(super) fn hold(
        &mut self,
        problem: &Problem,
        shape: HeldShape,
        first_node: usize,
    ) -> Result<(), Error> {
        self.approximation.open_held();
        let (regions, grid) = (&problem.regions, &problem.recipe.grid);
        let part = shape.of_body(&problem.body.section(&self.dimension)?);
        let mut quadrature =
            quadrature_of(problem, regions, (&part, grid), &self.approximation, None)?;
        flatten(&mut quadrature.positions, &self.dimension);
        let rows = self.rows_at(&quadrature.positions)?;
        let surface = if problem.loads.parts_of_surface().next().is_none() {
            SurfaceRule::default()
        } else {
            let size = self.surface.panel_size;
            let panels = problem.body.boundary_panels(size, &self.dimension)?;
            self.surface_rule(problem, (panels, size))?
        };
        self.held = Some(HeldVolume { shape, quadrature, rows, surface, first_node });
        Ok(())
    }

    /// How many nodes are not within what is held; they come first.
    pub fn deforming_nodes(&self) -> usize {
        self.held.as_ref().map_or(self.cloud.positions.len(), |held| held.first_node)
    }

    /// Points of the volume with their rows: of what deforms, then of what is held.
    pub fn volumes(&self) -> impl Iterator<Item = (&Quadrature, &Rows)> {
        let held = self.held.iter().map(|held| (&held.quadrature, &held.rows));
        std::iter::once((&self.quadrature, &self.supports)).chain(held)
    }

    /// The boundary that loads act on: that of the whole body, held or not.
    pub(crate) fn loaded_surface(&self) -> &SurfaceRule {
        self.held.as_ref().map_or(&self.surface, |held| &held.surface)
    }

    /// The connected body of each node.
    pub(crate) fn connected_bodies(&self) -> Vec<u32> {
        let rows: Vec<&Rows> = self.volumes().map(|(_, rows)| rows).collect();
        connected_bodies(&rows, self.cloud.positions.len())
    }

    /// Vector areas A_i N_i of the points of the boundary, closed \[m²\].
    pub(crate) fn closed_areas(&self) -> Vec<Vector3> {
        close(self.loaded_surface(), &self.connected_bodies(), self.dimension.components()).0
    }

    /// \[m³\]
    pub fn volume(&self) -> f64 {
        self.volumes().flat_map(|(quadrature, _)| &quadrature.weights).sum()
    }
}
