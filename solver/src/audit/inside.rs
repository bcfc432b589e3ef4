//! Obstacles that the body has entered, and volume that nearly incompressible parts have lost.
#![allow(non_snake_case)]

use super::{Kind, Row, Run};
use crate::algebra::tensor::{Vector3, vector_at};
use crate::discretisation::Warning;
use crate::discretisation::neighbours::Neighbours;
use crate::error::Error;
use crate::problem::{Obstacle, ObstacleSide};
use nalgebra::Point3;

/// Depth between nodes over the spacing \[–\]: nodes on the surface of a ball of one spacing let
/// the chord between them enter by an eighth, and those in the folds of a brain by a quarter.
const DEPTH: f64 = 0.25;
/// The same where an obstacle lies inside of the body as a whole, where it exerts no force.
const SWALLOWED: f64 = 0.05;
/// Places that are looked at for each obstacle.
const SAMPLES: usize = 512;
/// Parts of a facet along each side.
const PARTS: usize = 4;
/// Bulk over shear modulus from which a material hardly changes its volume \[–\]: ν = 0.475.
const INCOMPRESSIBLE: f64 = 20.0;
/// Change of the volume of a patch of it \[–\]: the pressure is then twice the shear modulus or
/// more, which soft bodies have in cracks and folds only.
const VOLUME: f64 = 0.1;

impl Run<'_> {
    /// The deepest place of the boundary in each obstacle, or how deep the obstacle is in the body.
    pub(super) fn depths(&self) -> Result<Vec<Row>, Error> {
        let obstacles = &self.model.contact.obstacles;
        if obstacles.is_empty() {
            return Ok(Vec::new());
        }
        let positions = &self.discretisation.cloud.positions;
        let (u, d) = (&self.state.displacement, self.model.components);
        let nodes = Neighbours::new(positions, self.spacing);
        // About where a place is now: with its nearest node.
        let moved = |X: &Vector3| {
            let (mut nearest, mut least) = (Vector3::zeros(), f64::INFINITY);
            nodes.for_each_within(X, 2.0 * self.spacing, |node, way| {
                if way.norm_squared() < least {
                    (nearest, least) = (vector_at(u, node, d), way.norm_squared());
                }
            });
            X + nearest
        };
        let facets = self.sampled.facets.iter();
        let now: Vec<Vector3> = facets.map(|facet| moved(&self.at(facet.centre()))).collect();
        let swallowed = self.model.contact.unresolved(self.discretisation, self.state.time, u);
        let row = |(index, obstacle): (usize, &Obstacle)| {
            let inside = swallowed.iter().find_map(|warning| match warning {
                Warning::ObstacleInBody { name, position } if *name == obstacle.name => {
                    Some(-self.body.signed_distance(position))
                }
                _ => None,
            });
            // On the way it was between nodes: half a spacing, as nobody has measured it.
            let entered = self.state.contact.entered.iter().any(|(own, _)| *own as usize == index);
            let inside = inside.or(entered.then_some(0.5 * self.spacing));
            let row = |depth| {
                Row::numbers(Kind::Depth, &obstacle.name, 0.0, depth, SWALLOWED * self.spacing)
            };
            inside.map_or_else(|| self.depth(obstacle, &now), |depth| Ok(row(depth)))
        };
        obstacles.iter().enumerate().map(row).collect()
    }

    fn depth(&self, obstacle: &Obstacle, now: &[Vector3]) -> Result<Row, Error> {
        let (t, mut near) = (self.state.time, Vec::<(f64, Vector3)>::new());
        for (facet, x) in self.sampled.facets.iter().zip(now) {
            let far = gap(obstacle, t, x);
            let size = facet.area().sqrt();
            if far < 2.0 * size + 0.5 * self.spacing {
                let parts = if size > 0.2 * self.spacing { PARTS } else { 1 };
                let shift = x - self.at(facet.centre());
                near.extend(facet.places(parts).map(|X| {
                    let X = self.at(X);
                    (gap(obstacle, t, &(X + shift)), X)
                }));
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.truncate(SAMPLES);
        let places: Vec<Vector3> = near.into_iter().map(|(_, X)| X).collect();
        let rows = self.discretisation.rows_at(&places)?;
        let (u, d) = (&self.state.displacement, self.model.components);
        let placed = places.iter().enumerate().map(|(i, X)| X + rows.interpolate(i, u, d));
        // Facets are chords of the boundary, and may lie outside of it.
        let beyond = |X: &Vector3| self.body.signed_distance(X).max(0.0);
        let depths = placed.zip(&places).map(|(x, X)| -gap(obstacle, t, &x) - beyond(X));
        let depth = depths.fold(0.0, f64::max);
        Ok(Row::numbers(Kind::Depth, &obstacle.name, 0.0, depth, DEPTH * self.spacing))
    }

    /// The patch of each nearly incompressible region whose volume has changed most.
    pub(super) fn patch_volumes(&self) -> Vec<Row> {
        let regions = &self.problem.regions;
        let Some(worst) = self.worst_patches() else { return Vec::new() };
        let found = worst.into_iter().zip(regions).filter_map(|(J, region)| Some((J?, region)));
        found
            .map(|(J, region)| Row::numbers(Kind::PatchVolume, &region.name, 1.0, J, VOLUME))
            .collect()
    }

    /// J \[region\] \[–\] of the patch that is farthest from 1 in each nearly incompressible region.
    fn worst_patches(&self) -> Option<Vec<Option<f64>>> {
        let regions = &self.problem.regions;
        let hardly_changes: Vec<bool> = regions
            .iter()
            .map(|region| {
                let constants = region.material.law.constants();
                constants.bulk_modulus >= INCOMPRESSIBLE * constants.shear_modulus
            })
            .collect();
        hardly_changes.contains(&true).then_some(())?;
        let discretisation = self.discretisation;
        let (u, d) = (&self.state.displacement, self.model.components);
        let mut worst: Vec<Option<f64>> = vec![None; regions.len()];
        for patch in discretisation.patches.windows(2).filter(|patch| patch[0] < patch[1]) {
            let region = discretisation.quadrature.regions[patch[0]] as usize;
            if !hardly_changes[region] {
                continue;
            }
            let (mut now, mut before) = (0.0, 0.0);
            for point in patch[0]..patch[1] {
                let weight = discretisation.quadrature.weights[point];
                let F = discretisation.supports.deformation_gradient(point, u, d);
                now += weight * F.determinant();
                before += weight;
            }
            let J = now / before;
            let own = worst[region].get_or_insert(J);
            if (J - 1.0).abs() > (*own - 1.0).abs() || J.is_nan() {
                *own = J;
            }
        }
        Some(worst)
    }
}

/// Distance \[m\] of a place from an obstacle at time `t` \[s\]; negative inside. Not that of the
/// contact, which the audit checks.
fn gap(obstacle: &Obstacle, t: f64, x: &Vector3) -> f64 {
    let back = obstacle.place(t).map(|place| place.inverse() * Point3::from(*x));
    let from_surface =
        obstacle.shape.signed_distance(&back.map_or(*x, |x| x.coords)) - obstacle.offset;
    match obstacle.side {
        ObstacleSide::Outside => from_surface,
        ObstacleSide::Inside => -from_surface,
    }
}
