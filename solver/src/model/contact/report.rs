//! Force, pressure, area and depth of contact (method book, section 16).
#![allow(non_snake_case)]

use super::plan::{ContactForce, ContactPlan, gap, normal};
use crate::algebra::tensor::Vector3;
use crate::discretisation::{Discretisation, Rows};
use crate::error::Error;
use crate::geometry::PointHash;
use crate::problem::Problem;

/// Edge of the panels between whose nodes penetration is looked for, over the mean spacing \[–\].
const PANEL: f64 = 0.5;

/// The part of the boundary that belongs to each node, and places between them.
#[derive(Debug)]
pub struct ContactSurface {
    /// Undeformed area of the panels to which a node is the nearest one of the boundary
    /// \[node\] \[m²\].
    pub areas: Vec<f64>,
    /// Centres of the panels near nodes in contact \[m\], and their nearest nodes.
    places: Vec<(Vector3, u32)>,
}

/// What one obstacle does to the body.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactResult {
    /// Nodes that touch.
    pub nodes: usize,
    /// On the body \[N\].
    pub force: Vector3,
    /// Sum of the normal parts of the forces on nodes \[N\].
    pub normal_force: f64,
    /// Undeformed area of the nodes that are pushed \[m²\].
    pub area: f64,
    /// Largest normal force of a node over its area \[Pa\].
    pub largest_pressure: f64,
    /// Deepest place of the boundary in the obstacle, between nodes too \[m\]; 0 if none is inside.
    pub depth: f64,
    /// That place in the undeformed body \[m\].
    pub deepest: Vector3,
}

impl ContactSurface {
    /// Of the body of a problem with obstacles.
    pub fn new(problem: &Problem, discretisation: &Discretisation) -> Result<Self, Error> {
        let cloud = &discretisation.cloud;
        let mean = cloud.spacing.iter().sum::<f64>() / cloud.spacing.len() as f64;
        let panels = problem.body.boundary_panels(PANEL * mean, &problem.dimension)?;
        let boundary: Vec<u32> = (0..cloud.positions.len() as u32)
            .filter(|&node| cloud.on_boundary[node as usize])
            .collect();
        let mut hash = PointHash::new(mean, mean);
        boundary.iter().for_each(|&node| hash.insert(cloud.positions[node as usize]));
        let mut areas = vec![0.0; cloud.positions.len()];
        let mut places = Vec::with_capacity(panels.len());
        for panel in &panels {
            if let Some((_, nearest)) = hash.nearest(&panel.centre, usize::MAX, 1).first() {
                let node = boundary[*nearest];
                areas[node as usize] += panel.area;
                places.push((panel.centre, node));
            }
        }
        Ok(ContactSurface { areas, places })
    }

    /// Contact pressure at the nodes \[Pa\]: the normal force over the area.
    pub fn pressures(&self, forces: &[ContactForce], normals: &[Vector3]) -> Vec<f64> {
        let mut pressures = vec![0.0; self.areas.len()];
        for (force, normal) in forces.iter().zip(normals) {
            let node = force.node as usize;
            if self.areas[node] > 0.0 {
                pressures[node] += force.force.dot(normal) / self.areas[node];
            }
        }
        pressures
    }

    /// What each obstacle does at nodal parameters `u` \[component of node\] \[m\].
    pub fn results(
        &self,
        plan: &ContactPlan,
        discretisation: &Discretisation,
        forces: &[ContactForce],
        u: &[f64],
    ) -> Result<Vec<ContactResult>, Error> {
        let mut results = vec![ContactResult::default(); plan.obstacles.len()];
        let normals = normals(plan, discretisation, forces, u)?;
        for (force, normal) in forces.iter().zip(&normals) {
            let result = &mut results[force.obstacle as usize];
            let along = force.force.dot(normal);
            result.nodes += 1;
            result.force += force.force;
            result.normal_force += along;
            let area = self.areas[force.node as usize];
            if along > 0.0 && area > 0.0 {
                result.area += area;
                result.largest_pressure = result.largest_pressure.max(along / area);
            }
        }
        self.find_deepest(plan, discretisation, forces, u, &mut results)?;
        Ok(results)
    }

    /// The deepest of the panels whose nodes touch.
    fn find_deepest(
        &self,
        plan: &ContactPlan,
        discretisation: &Discretisation,
        forces: &[ContactForce],
        u: &[f64],
        results: &mut [ContactResult],
    ) -> Result<(), Error> {
        let mut touches = vec![false; self.areas.len()];
        forces.iter().for_each(|force| touches[force.node as usize] = true);
        let near: Vec<Vector3> = (self.places.iter())
            .filter(|(_, node)| touches[*node as usize])
            .map(|place| place.0)
            .collect();
        let rows: Rows = discretisation.rows_at(&near)?;
        let components = u.len() / self.areas.len();
        for (index, X) in near.iter().enumerate() {
            let x = X + rows.interpolate(index, u, components);
            for (obstacle, result) in plan.obstacles.iter().zip(results.iter_mut()) {
                let depth = -gap(obstacle, &x);
                if depth > result.depth {
                    (result.depth, result.deepest) = (depth, *X);
                }
            }
        }
        Ok(())
    }
}

/// Normals where the nodes that touch are, by the values of the displacement.
fn normals(
    plan: &ContactPlan,
    discretisation: &Discretisation,
    forces: &[ContactForce],
    u: &[f64],
) -> Result<Vec<Vector3>, Error> {
    let positions = &discretisation.cloud.positions;
    let components = u.len() / positions.len();
    let touching: Vec<Vector3> =
        forces.iter().map(|force| positions[force.node as usize]).collect();
    let rows = discretisation.rows_at(&touching)?;
    let places = touching.iter().enumerate().map(|(i, X)| X + rows.interpolate(i, u, components));
    Ok(plan.normals(forces, places, components).collect())
}

impl ContactPlan {
    /// Normals of the obstacles towards the body at the current places \[m\] of the nodes on
    /// which they exert forces.
    pub fn normals(
        &self,
        forces: &[ContactForce],
        places: impl Iterator<Item = Vector3>,
        components: usize,
    ) -> impl Iterator<Item = Vector3> {
        let obstacle = |force: &ContactForce| &self.obstacles[force.obstacle as usize];
        forces.iter().zip(places).map(move |(force, x)| normal(obstacle(force), &x, components))
    }
}
