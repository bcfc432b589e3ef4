//! Values of fields at the nodes that may touch, and pushes that move them.

use super::plan::ContactPlan;
use crate::algebra::tensor::Vector3;

/// What moves under pushes on values.
pub(super) struct Pushed<'a> {
    /// \[node\] \[kg\]
    pub mass: &'a [f64],
    /// \[component of node\] \[m\]
    pub displacement: &'a mut [f64],
    /// \[component of node\] \[m/s\]
    pub velocity: &'a mut [f64],
    /// Step that makes velocities of displacements \[s\].
    pub time_step: f64,
}

impl ContactPlan {
    /// The value of a nodal field at the node of a row.
    pub(super) fn value(&self, row: u32, field: &[f64]) -> Vector3 {
        self.rows.interpolate(row as usize, field, self.components)
    }

    /// Where a node that may touch is at displacements `u` \[component of node\] \[m\]; any other does
    /// not move.
    pub fn place(&self, node: u32, positions: &[Vector3], u: &[f64]) -> Vector3 {
        let moved = self.row_of(node).map(|row| self.value(row, u));
        positions[node as usize] + moved.unwrap_or_default()
    }

    /// Where the node of a row is \[m\].
    pub(super) fn place_of(&self, row: u32, positions: &[Vector3], u: &[f64]) -> Vector3 {
        positions[self.nodes[row as usize] as usize] + self.value(row, u)
    }

    /// A box around all nodes that may touch \[m\].
    pub(crate) fn around(&self, positions: &[Vector3], u: &[f64]) -> (Vector3, Vector3) {
        let first = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        let places = (0..self.nodes.len() as u32).map(|row| self.place_of(row, positions, u));
        places.fold(first, |(lower, upper), x| (lower.inf(&x), upper.sup(&x)))
    }

    /// The row of a node that may touch.
    pub(super) fn row_of(&self, node: u32) -> Option<u32> {
        self.nodes.binary_search(&node).ok().map(|row| row as u32)
    }

    /// Entries (index of the component of a node, component, φ) of a row that obstacles may push.
    fn entries(&self, row: u32) -> impl Iterator<Item = (usize, usize, f64)> {
        let rows = &self.rows;
        rows.row(row as usize).flat_map(move |entry| {
            let (node, phi) = (rows.nodes[entry], rows.phi[entry]);
            let free = self.free(node);
            let components = (0..self.components).filter(move |k| free[*k]);
            components.map(move |k| (self.components * node as usize + k, k, phi))
        })
    }

    /// As [`ContactPlan::value`], of what obstacles may push alone: what a push does work on.
    pub(super) fn pushed_value(&self, row: u32, field: &[f64]) -> Vector3 {
        let mut value = Vector3::zeros();
        self.entries(row).for_each(|(index, k, phi)| value[k] += phi * field[index]);
        value
    }

    /// By how much a push of one moves the value along each axis, Σ φ²/m \[1/kg\].
    pub(super) fn mobility(&self, row: u32, mass: &[f64]) -> Vector3 {
        let mut mobility = Vector3::zeros();
        self.entries(row).for_each(|(index, k, phi)| {
            mobility[k] += phi * phi / mass[index / self.components];
        });
        mobility
    }

    /// Which part of a push acts along each axis, Σ φ \[–\]: less than 1 beside what is prescribed.
    pub(super) fn share(&self, row: u32) -> Vector3 {
        let mut share = Vector3::zeros();
        self.entries(row).for_each(|(_, k, phi)| share[k] += phi);
        share
    }

    /// Adds the nodal forces of a force on the value of a row.
    pub(super) fn add(&self, row: u32, force: &Vector3, forces: &mut [f64]) {
        self.entries(row).for_each(|(index, k, phi)| forces[index] += phi * force[k]);
    }

    /// Pushes the value of a row by m Δu \[kg·m\].
    pub(super) fn push(&self, row: u32, push: &Vector3, pushed: &mut Pushed) {
        let rate = 1.0 / pushed.time_step;
        self.entries(row).for_each(|(index, k, phi)| {
            let way = phi * push[k] / pushed.mass[index / self.components];
            pushed.displacement[index] += way;
            pushed.velocity[index] += way * rate;
        });
    }
}
