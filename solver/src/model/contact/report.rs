//! Force, pressure, area and depth of contact (method book, section 16).
#![allow(non_snake_case)]

use super::plan::{ContactForce, ContactPlan};
use crate::algebra::tensor::{Vector3, cofactor};
use crate::discretisation::{Discretisation, Rows};
use crate::error::Error;
use crate::geometry::{Panel, PointHash};
use crate::problem::Problem;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Edge of the panels over the mean spacing \[–\].
const PANEL: f64 = 0.5;
/// Least cosine between a panel's normal and the obstacle's, turned around, of a panel that
/// faces it \[–\]: the sides of a block on a floor do not.
const FACING: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Panels of the boundary, each with the node of the boundary nearest to it.
#[derive(Debug)]
pub struct ContactSurface {
    panels: Vec<(Panel, u32)>,
    nodes: usize,
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
    /// Undeformed area of the panels that face it at nodes that are pushed \[m²\].
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
        let mean = cloud.mean_spacing();
        let panels = problem.body.boundary_panels(PANEL * mean, &problem.dimension)?;
        let boundary: Vec<u32> = (0..cloud.positions.len() as u32)
            .filter(|&node| cloud.on_boundary[node as usize])
            .collect();
        let mut hash = PointHash::new(mean, mean);
        boundary.iter().for_each(|&node| hash.insert(cloud.positions[node as usize]));
        let nearest = |panel: Panel| {
            let (_, place) = *hash.nearest(&panel.centre, usize::MAX, 1).first()?;
            Some((panel, boundary[place]))
        };
        let panels = panels.into_par_iter().filter_map(nearest).collect();
        Ok(ContactSurface { panels, nodes: cloud.positions.len() })
    }

    /// Contact pressure \[Pa\] at the nodes at time `t` \[s\] and nodal parameters `u` \[component of node\]
    /// \[m\]: the normal force over the area that faces the obstacle.
    pub fn pressures(
        &self,
        (plan, t): (&ContactPlan, f64),
        discretisation: &Discretisation,
        forces: &[ContactForce],
        u: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let near = self.near(discretisation, forces, u)?;
        let along = along_normals((plan, t), discretisation, forces, u)?;
        let mut pressures = vec![0.0; self.nodes];
        for ((force, along), area) in forces.iter().zip(along).zip(near.areas((plan, t), forces)) {
            if area > 0.0 {
                pressures[force.node as usize] += along / area;
            }
        }
        Ok(pressures)
    }

    /// What each obstacle does at time `t` \[s\] and nodal parameters `u` \[component of node\] \[m\].
    pub fn results(
        &self,
        (plan, t): (&ContactPlan, f64),
        discretisation: &Discretisation,
        forces: &[ContactForce],
        u: &[f64],
    ) -> Result<Vec<ContactResult>, Error> {
        let mut results = vec![ContactResult::default(); plan.obstacles.len()];
        let near = self.near(discretisation, forces, u)?;
        let along = along_normals((plan, t), discretisation, forces, u)?;
        for ((force, along), area) in forces.iter().zip(along).zip(near.areas((plan, t), forces)) {
            let result = &mut results[force.obstacle as usize];
            result.nodes += 1;
            result.force += force.force;
            result.normal_force += along;
            if along > 0.0 && area > 0.0 {
                result.area += area;
                result.largest_pressure = result.largest_pressure.max(along / area);
            }
        }
        near.find_deepest((plan, t), &mut results);
        Ok(results)
    }

    /// The panels whose nodes touch, where they are now.
    fn near(
        &self,
        discretisation: &Discretisation,
        forces: &[ContactForce],
        u: &[f64],
    ) -> Result<NearPanels<'_>, Error> {
        let mut touches = vec![false; self.nodes];
        forces.iter().for_each(|force| touches[force.node as usize] = true);
        let panels = self.panels.iter().filter(|(_, node)| touches[*node as usize]);
        let panels: Vec<(&Panel, u32)> = panels.map(|(panel, node)| (panel, *node)).collect();
        let centres: Vec<Vector3> = panels.iter().map(|(panel, _)| panel.centre).collect();
        let rows: Rows = discretisation.rows_at(&centres)?;
        let components = u.len() / self.nodes;
        let now = |(index, (panel, node))| {
            let F = rows.deformation_gradient(index, u, components);
            NearPanel {
                panel,
                node,
                place: panel.centre + rows.interpolate(index, u, components),
                normal: (cofactor(&F) * panel.normal).normalize(),
            }
        };
        Ok(NearPanels { panels: panels.into_iter().enumerate().map(now).collect() })
    }
}

/// A panel whose node touches.
struct NearPanel<'a> {
    panel: &'a Panel,
    node: u32,
    /// Of its centre \[m\].
    place: Vector3,
    /// Out of the deformed body.
    normal: Vector3,
}

struct NearPanels<'a> {
    panels: Vec<NearPanel<'a>>,
}

impl NearPanels<'_> {
    /// Undeformed area \[force\] \[m²\] of the node's panels that face the obstacle.
    fn areas(&self, (plan, t): (&ContactPlan, f64), forces: &[ContactForce]) -> Vec<f64> {
        let mut panels_of: BTreeMap<u32, Vec<&NearPanel>> = BTreeMap::new();
        self.panels.iter().for_each(|near| panels_of.entry(near.node).or_default().push(near));
        let area = |force: &ContactForce| {
            let obstacle = plan.placed(force.obstacle, t);
            let faces = |near: &&&NearPanel| {
                let towards = obstacle.normal(&near.place, plan.free(force.node));
                near.normal.dot(&towards) <= -FACING
            };
            let own = panels_of.get(&force.node).into_iter().flatten();
            own.filter(faces).map(|near| near.panel.area).sum()
        };
        forces.iter().map(area).collect()
    }

    /// The deepest of them in each obstacle.
    fn find_deepest(&self, (plan, t): (&ContactPlan, f64), results: &mut [ContactResult]) {
        for ((_, placed), result) in plan.all_placed(t).zip(results) {
            for near in &self.panels {
                let depth = -placed.gap(&near.place);
                if depth > result.depth {
                    (result.depth, result.deepest) = (depth, near.panel.centre);
                }
            }
        }
    }
}

/// The parts of the forces along the normals \[N\], where the nodes that touch are by the values
/// of the displacement.
fn along_normals(
    (plan, t): (&ContactPlan, f64),
    discretisation: &Discretisation,
    forces: &[ContactForce],
    u: &[f64],
) -> Result<Vec<f64>, Error> {
    let positions = &discretisation.cloud.positions;
    let components = u.len() / positions.len();
    let touching: Vec<Vector3> =
        forces.iter().map(|force| positions[force.node as usize]).collect();
    let rows = discretisation.rows_at(&touching)?;
    let places = touching.iter().enumerate().map(|(i, X)| X + rows.interpolate(i, u, components));
    let normals = plan.normals(t, forces, places);
    Ok(forces.iter().zip(normals).map(|(force, normal)| force.force.dot(&normal)).collect())
}

impl ContactPlan {
    /// Normals of the obstacles at time `t` \[s\] towards the body at the current places \[m\] of the nodes on
    /// which they exert forces.
    pub fn normals(
        &self,
        t: f64,
        forces: &[ContactForce],
        places: impl Iterator<Item = Vector3>,
    ) -> impl Iterator<Item = Vector3> {
        let normal = move |(force, x): (&ContactForce, Vector3)| {
            self.placed(force.obstacle, t).normal(&x, self.free(force.node))
        };
        forces.iter().zip(places).map(normal)
    }
}
