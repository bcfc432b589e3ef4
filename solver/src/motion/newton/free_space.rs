//! What prescribed displacements and closed contacts leave free.
#![allow(non_snake_case)]

use crate::algebra::sparse_cholesky::{Scratch, SparseCholesky};
use crate::algebra::tensor::Vector3;
use crate::model::Model;
use crate::model::essential::ConstraintForces;
use faer::sparse::{SparseColMat, Triplet};

/// A displacement of one node that a contact prescribes.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactRow {
    /// Index of the contact.
    pub contact: usize,
    pub node: u32,
    /// Unit vector.
    pub along: Vector3,
    /// Way along it to the surface \[m\].
    pub way: f64,
}

/// The projection Π onto displacements that vanish where something is prescribed,
/// orthogonal in the inertia.
pub(super) struct FreeSpace<'a> {
    model: &'a Model,
    /// At which conditions are active \[s\].
    pub t: f64,
    pub forces: ConstraintForces,
    pub contacts: Vec<ContactRow>,
    /// Only while contacts are closed.
    together: Option<Together>,
}

/// Conditions and contacts as one system C u = ū: the displacement field takes the
/// prescribed values, those of contacts along their normals (method book, eq. 21.8).
struct Together {
    /// Row i of C is `starts[i]..starts[i + 1]`; the conditions come first.
    starts: Vec<usize>,
    /// Components of nodes and their factors \[–\].
    entries: Vec<(u32, f64)>,
    /// Rows of conditions.
    conditions: usize,
    /// Of C M⁻¹ Cᵀ; stopped motions come last.
    cholesky: SparseCholesky,
    scratch: Scratch,
}

impl Together {
    fn product(&self, row: usize, v: &[f64]) -> f64 {
        let entries = &self.entries[self.starts[row]..self.starts[row + 1]];
        entries.iter().map(|(index, factor)| factor * v[*index as usize]).sum()
    }

    /// v −= M⁻¹ Cᵀ (C M⁻¹ Cᵀ)⁻¹ gaps; returns the multipliers after those of conditions.
    fn take(&mut self, model: &Model, v: &mut [f64], mut gaps: Vec<f64>) -> Vec<f64> {
        self.cholesky.solve(&mut gaps, &mut self.scratch);
        for (ends, multiplier) in self.starts.windows(2).zip(&gaps) {
            for (index, factor) in &self.entries[ends[0]..ends[1]] {
                let index = *index as usize;
                v[index] -= factor * multiplier / model.inertia[index / model.components];
            }
        }
        gaps.split_off(self.conditions)
    }
}

impl<'a> FreeSpace<'a> {
    pub fn new(model: &'a Model, t: f64) -> FreeSpace<'a> {
        let forces = ConstraintForces::default();
        FreeSpace { model, t, forces, contacts: Vec::new(), together: None }
    }

    /// Closes these contacts, and stops motions \[component of node\].
    pub fn close(&mut self, contacts: Vec<ContactRow>, stopped: &[Vec<f64>]) {
        self.contacts = contacts;
        self.together = None;
        if !self.contacts.is_empty() {
            self.together = self.assembled(stopped);
        }
    }

    /// The rows of what is prescribed, then of closed contacts: nodes with factors \[–\], and the unit
    /// vector along which they act.
    pub fn for_each_row(&self, mut visit: impl FnMut(&[u32], &[f64], &Vector3)) {
        let (mut nodes, mut factors) = (Vec::new(), Vec::new());
        self.model.constraints.for_each_row(self.t, |component, row| {
            nodes.clear();
            factors.clear();
            row.for_each(|(node, phi)| {
                nodes.push(node);
                factors.push(phi);
            });
            visit(&nodes, &factors, &Vector3::ith(component, 1.0));
        });
        let Some(rows) = &self.model.nodal_rows else { return };
        for ContactRow { node, along, .. } in &self.contacts {
            let entries = rows.row(*node as usize);
            visit(&rows.nodes[entries.clone()], &rows.phi[entries], along);
        }
    }

    fn assembled(&self, stopped: &[Vec<f64>]) -> Option<Together> {
        let (model, d) = (self.model, self.model.components);
        let (mut starts, mut entries) = (vec![0], Vec::new());
        model.nodal_rows.as_ref()?;
        self.for_each_row(|nodes, factors, along| {
            for (&node, factor) in nodes.iter().zip(factors) {
                let first = d * node as usize;
                let part = |k: usize| ((first + k) as u32, factor * along[k]);
                entries.extend((0..d).filter(|&k| along[k] != 0.0).map(part));
            }
            starts.push(entries.len());
        });
        let conditions = starts.len() - 1 - self.contacts.len();
        for motion in stopped {
            let momentum = |(i, v): (usize, &f64)| (i as u32, model.inertia[i / d] * v);
            entries.extend(motion.iter().enumerate().map(momentum));
            starts.push(entries.len());
        }
        let gram = gram_matrix(model, &starts, &entries)?;
        let cholesky = SparseCholesky::new(&gram)?;
        Some(Together { starts, entries, conditions, cholesky, scratch: Scratch::default() })
    }

    /// Π v.
    pub fn project(&mut self, v: &mut [f64]) {
        if self.together.is_some() {
            self.project_contacts(v);
        } else {
            let inertia = &self.model.inertia;
            self.model.constraints.project(self.t, inertia, v, &mut self.forces);
        }
    }

    /// As [`FreeSpace::project`], of no effect without closed contacts. Returns the
    /// multipliers of the contacts: M v − M Π v along their rows.
    pub fn project_contacts(&mut self, v: &mut [f64]) -> Vec<f64> {
        let Some(together) = &mut self.together else { return Vec::new() };
        let gaps = (0..together.starts.len() - 1).map(|row| together.product(row, v)).collect();
        let mut multipliers = together.take(self.model, v, gaps);
        multipliers.truncate(self.contacts.len());
        multipliers
    }

    /// Adds to a change v of the displacement \[m\] what closes the contacts, and leaves
    /// its prescribed values as they are.
    pub fn close_contacts(&mut self, v: &mut [f64]) {
        let Some(together) = &mut self.together else { return };
        let mut gaps = vec![0.0; together.conditions];
        gaps.extend((self.contacts.iter().enumerate()).map(|(index, contact)| {
            together.product(together.conditions + index, v) - contact.way
        }));
        gaps.resize(together.starts.len() - 1, 0.0);
        together.take(self.model, v, gaps);
    }

    /// f −= Cᵀ multipliers of the contacts: forces \[N\] without what obstacles take.
    pub fn take_contact_forces(&self, f: &mut [f64], multipliers: &[f64]) {
        let Some(together) = &self.together else { return };
        for (index, multiplier) in multipliers.iter().enumerate() {
            let row = together.conditions + index;
            for (index, factor) in &together.entries[together.starts[row]..together.starts[row + 1]]
            {
                f[*index as usize] -= factor * multiplier;
            }
        }
    }

    /// Displacements of nodes that are held, each with its direction.
    pub fn held(&self) -> Vec<(u32, Vector3)> {
        let mut held: Vec<(u32, Vector3)> =
            self.contacts.iter().map(|row| (row.node, row.along)).collect();
        for set in self.model.constraints.active(self.t) {
            let along = Vector3::ith(set.component, 1.0);
            held.extend(set.rows.iter().map(|row| (row.node, along)));
        }
        held
    }
}

/// The lower triangle of C M⁻¹ Cᵀ.
fn gram_matrix(
    model: &Model,
    starts: &[usize],
    entries: &[(u32, f64)],
) -> Option<SparseColMat<usize, f64>> {
    let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); model.size()];
    for (row, ends) in starts.windows(2).enumerate() {
        for (index, factor) in &entries[ends[0]..ends[1]] {
            columns[*index as usize].push((row, *factor));
        }
    }
    let mut triplets = Vec::new();
    for (index, column) in columns.iter().enumerate() {
        let mass = model.inertia[index / model.components];
        for (position, &(i, a)) in column.iter().enumerate() {
            triplets
                .extend(column[..=position].iter().map(|&(j, b)| Triplet::new(i, j, a * b / mass)));
        }
    }
    let size = starts.len() - 1;
    SparseColMat::try_new_from_triplets(size, size, &triplets).ok()
}
