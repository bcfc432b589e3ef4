//! What conditions exert on a body, and how that changes.

use super::constraints::{ConstraintForces, ConstraintSet, Constraints};
use super::rows::ConstraintRow;
use crate::algebra::tensor::{Vector3, vector_at};

/// What a condition exerts on the body: all that it takes to move its nodes as prescribed.
/// The weight and the tractions of these nodes are therefore part of it, and reactions and
/// loads add up to zero at rest. A node that two conditions prescribe alike counts with the
/// first stated.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Reaction {
    /// \[N\]
    pub force: Vector3,
    /// \[N·m\]
    pub moment: Vector3,
    /// Sum of the sizes of the forces at the nodes \[N\]: more than that of their sum where they
    /// balance each other.
    pub sizes: f64,
}

impl Constraints {
    /// Force, and moment about `about` \[m\], of each condition on a body with
    /// reference `positions` \[node\] \[m\] and nodal parameters `u` \[component of
    /// node\] \[m\]: the multipliers of the last enforcement times `force_factor`
    /// \[1/s²\] (method book, eqs. 15.3 and 15.4).
    pub fn reactions(
        &self,
        forces: &ConstraintForces,
        force_factor: f64,
        about: &Vector3,
        positions: &[Vector3],
        u: &[f64],
    ) -> Vec<Reaction> {
        let mut reactions = vec![Reaction::default(); self.conditions.len()];
        let sets = &self.stages[forces.stage].sets;
        for (set, multipliers) in sets.iter().zip(&forces.multipliers) {
            for (i, (row, multiplier)) in set.rows.iter().zip(multipliers).enumerate() {
                let mut force = Vector3::zeros();
                force[set.component] = multiplier * force_factor;
                let reaction = &mut reactions[row.condition as usize];
                reaction.force += force;
                reaction.sizes += force.norm();
                reaction.moment += (set.place(i, positions, u) - about).cross(&force);
            }
        }
        reactions
    }

    /// The motion \[component of node\], least in the masses, that is `motion` of their places at
    /// displacements `u` \[m\] where a condition holds nodes, and 0 where others do.
    pub(crate) fn motion_of(
        &self,
        condition: usize,
        t: f64,
        (positions, mass, u): (&[Vector3], &[f64], &[f64]),
        motion: &dyn Fn(&Vector3) -> Vector3,
    ) -> Vec<f64> {
        let mut targets = Vec::new();
        for set in self.active(t) {
            let target = |(i, row): (usize, &ConstraintRow)| match row.condition as usize {
                own if own == condition => motion(&set.place(i, positions, u))[set.component],
                _ => 0.0,
            };
            targets.extend(set.rows.iter().enumerate().map(target));
        }
        let (mut moved, mut targets) = (vec![0.0; u.len()], targets.into_iter());
        let (forces, next) = (&mut ConstraintForces::default(), targets.by_ref());
        let target = |_: &ConstraintRow, _| next.next().unwrap_or_default();
        self.enforce_targets(t, mass, &mut moved, forces, target, |_, _| ());
        moved
    }

    /// Derivative of the moment of a condition about `axis` \[N\] with respect to displacements
    /// \[component of node\], as far as its forces of the last enforcement move with the nodes.
    pub(crate) fn moment_slope(
        &self,
        condition: usize,
        (forces, force_factor): (&ConstraintForces, f64),
        axis: &Vector3,
        (components, size): (usize, usize),
    ) -> Vec<f64> {
        let mut slope = vec![0.0; size];
        let sets = &self.stages[forces.stage].sets;
        for (set, multipliers) in sets.iter().zip(&forces.multipliers) {
            for (i, (row, multiplier)) in set.rows.iter().zip(multipliers).enumerate() {
                if row.condition as usize != condition {
                    continue;
                }
                let force = Vector3::ith(set.component, multiplier * force_factor);
                let along = force.cross(axis);
                set.for_each_entry(i, &mut |node, phi| {
                    let first = components * node as usize;
                    (0..components).for_each(|k| slope[first + k] += phi * along[k]);
                });
            }
        }
        slope
    }
}

impl ConstraintSet {
    /// Where row `i` holds the body at displacements `u` \[m\]: collocation prescribes the field, so
    /// its force acts there.
    fn place(&self, i: usize, positions: &[Vector3], u: &[f64]) -> Vector3 {
        let (node, components) = (self.rows[i].node as usize, u.len() / positions.len());
        let displacement = match &self.collocation {
            Some(collocation) => collocation.displacement(i, u, components),
            None => vector_at(u, node, components),
        };
        positions[node] + displacement
    }

    /// The nodes whose parameters row `i` prescribes the sum of, with their factors \[–\].
    fn for_each_entry(&self, i: usize, visit: &mut dyn FnMut(u32, f64)) {
        match &self.collocation {
            Some(collocation) => collocation.row(i).for_each(|(node, phi)| visit(node, phi)),
            None => visit(self.rows[i].node, 1.0),
        }
    }
}
