//! Frames of the display mesh: a body to look at, with the fields of the approximation.
#![allow(non_snake_case)]

use super::node_fields::NodeFields;
use super::vtu::{PointArray, Stored, VtuCells, VtuFrame};
use crate::display::{DisplayMesh, Mesh, display_mesh};
use crate::picture::{Body, Field};
use crate::run::contact::contact_gaps;
use crate::run::record::Frame;
use anyhow::Result;
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::discretisation::Rows;
use mtled::discretisation::mls::{Approximation, Support};
use mtled::motion::nodal_fields::{LocalFields, NodalFields};
use mtled::problem::{Dimension, Fibres, Problem};
use rayon::prelude::*;
use std::collections::HashMap;

const PURPOSE: &str = "A mesh to look at, cut from a lattice by the boundary of the body; the solver \
                       has no mesh and computes on the nodes alone.";

/// What all frames of the display mesh share.
pub(crate) struct BodyFrames {
    display: DisplayMesh,
    points: Vec<[f64; 3]>,
    /// φ of the nodes at the vertices.
    rows: Rows,
    /// Region of each vertex, on borders the first.
    owners: Vec<u16>,
    /// Distance between nodes at the vertices \[m\].
    spacing: Vec<f64>,
    /// Unit vectors along the fibres at the vertices \[–\], 0 in regions without; nothing where the
    /// body has none.
    fibres: Option<Vec<f64>>,
}

/// The reference directions of fibres at the vertices of a mesh.
fn fibres(problem: &Problem, mesh: &Mesh) -> Option<Vec<f64>> {
    if problem.regions.iter().all(|region| region.fibres.is_none()) {
        return None;
    }
    let mut owners = vec![None; mesh.vertices.len()];
    for (cell, region) in mesh.iter().zip(&mesh.regions) {
        let fibres = problem.regions[*region as usize].fibres.as_ref();
        for &vertex in cell.iter().filter(|_| fibres.is_some()) {
            owners[vertex as usize] = fibres;
        }
    }
    let direction = |(X, owner): (&Vector3, Option<&Fibres>)| {
        let frame = owner.and_then(|fibres| fibres.frame(X).ok());
        frame.map_or([0.0; 3], |frame| frame.column(0).into_owned().into())
    };
    Some(mesh.vertices.iter().zip(owners).flat_map(direction).collect())
}

impl BodyFrames {
    /// The display mesh of a body, and what interpolates to its vertices; `None` where it has no
    /// cells.
    pub(crate) fn new(simulation: &Simulation) -> Result<Option<BodyFrames>> {
        let Simulation { problem, discretisation, .. } = simulation;
        let nodes = discretisation.cloud.positions.len();
        let display = display_mesh(problem, nodes, discretisation.volume())?;
        if display.mesh.is_empty() {
            return Ok(None);
        }
        let rows = rows_near(&discretisation.approximation, &display.mesh.vertices);
        let spacing = interpolated(&rows, &discretisation.cloud.spacing, 1);
        let points = display.mesh.vertices.iter().map(|X| (*X).into()).collect();
        let fibres = fibres(problem, &display.mesh);
        let owners = owners(&display.mesh);
        Ok(Some(BodyFrames { display, points, rows, owners, spacing, fibres }))
    }

    /// The fields of a frame at the vertices: displacement of the approximation, what is known of the
    /// material of their regions, and others interpolated from those at the nodes.
    pub(crate) fn frame(
        &self,
        simulation: &Simulation,
        frame: &Frame,
        fields: &NodeFields,
        mode: Option<&Vec<f64>>,
        mut numbers: Vec<(&'static str, f64)>,
    ) -> VtuFrame<'_> {
        let DisplayMesh { mesh, on_boundary, edge } = &self.display;
        let components = simulation.model.components;
        let displacement = vectors(&self.rows, &frame.displacement, components);
        let local = self.material(&fields.material);
        let stresses = || local.iter().map(|local| &local.stress);
        let single = |name: &str, components: usize, values: Vec<f64>| {
            PointArray::new(name, components, values).stored(Stored::Single)
        };
        let mut point_data = vec![
            PointArray::new("displacement", 3, displacement),
            single("J", 1, local.iter().map(|local| local.jacobian).collect()),
            single("von_mises_stress", 1, stresses().map(von_mises).collect()),
            single("pressure", 1, local.iter().map(LocalFields::pressure).collect()),
            single("principal_green_lagrange_strain", 3, principal_strains(&local)),
            single("nodal_spacing", 1, self.spacing.clone()),
        ];
        if let Some(pressures) = &fields.contact_pressure {
            let displacement = &point_data[0].values;
            let gaps = contact_gaps(
                (&simulation.model.contact, fields.time),
                &mesh.vertices,
                displacement,
            );
            point_data.push(single("contact_gap", 1, gaps));
            point_data.push(single("contact_pressure", 1, self.not_negative(pressures)));
        }
        if let Some(mode) = mode {
            point_data.push(single("unstable_mode", 3, vectors(&self.rows, mode, components)));
        }
        if let Some(fibres) = &self.fibres {
            point_data.push(single("fibre", 3, fibres.clone()));
        }
        if let Some(bars) = &fields.error_bar {
            point_data.push(single("displacement_error_bar", 1, self.not_negative(bars)));
        }
        point_data.push(single("cauchy_stress", 9, stresses().flatten().copied().collect()));
        let boundary = on_boundary.iter().map(|on| f64::from(*on)).collect();
        point_data.push(PointArray::new("on_boundary", 1, boundary).stored(Stored::Integer));
        let regions = mesh.regions.iter().map(|region| f64::from(*region)).collect();
        let data = vec![PointArray::new("region", 1, regions).stored(Stored::Integer)];
        numbers.push(("display_mesh_edge_m", *edge));
        if let Dimension::PlaneStrain { thickness, .. } = simulation.discretisation.dimension {
            numbers.push(("slab_thickness_m", thickness));
        }
        let cells = VtuCells { corners: mesh.corners, points: &mesh.cells, data, purpose: PURPOSE };
        VtuFrame { numbers, points: &self.points, cells: Some(cells), point_data }
    }

    /// Motions \[component of node\] with their names, as fields.
    pub(crate) fn motions(
        &self,
        motions: &[(String, Vec<f64>)],
        components: usize,
    ) -> VtuFrame<'_> {
        let mesh = &self.display.mesh;
        let field = |(name, motion): &(String, Vec<f64>)| {
            PointArray::new(name, 3, vectors(&self.rows, motion, components)).stored(Stored::Single)
        };
        let point_data = motions.iter().map(field).collect();
        let regions = mesh.regions.iter().map(|region| f64::from(*region)).collect();
        let data = vec![PointArray::new("region", 1, regions).stored(Stored::Integer)];
        let cells = VtuCells { corners: mesh.corners, points: &mesh.cells, data, purpose: PURPOSE };
        VtuFrame { numbers: Vec::new(), points: &self.points, cells: Some(cells), point_data }
    }

    /// Moves its vertices by offsets \[component of node\] \[m\].
    pub(crate) fn move_by(&mut self, offsets: &[f64], components: usize) {
        let moves = vectors(&self.rows, offsets, components);
        for (point, own) in self.points.iter_mut().zip(moves.as_chunks::<3>().0) {
            point.iter_mut().zip(own).for_each(|(x, w)| *x += w);
        }
    }

    /// Its surface in space: vertices \[m\] and triangles, anticlockwise seen from outside.
    pub(crate) fn surface(&self) -> (Vec<Vector3>, Vec<[u32; 3]>) {
        let sides = self.display.mesh.boundary();
        let triangles: Vec<[u32; 3]> =
            sides.iter().filter_map(|(side, _)| side[..].try_into().ok()).collect();
        let mut numbers: HashMap<u32, u32> = HashMap::new();
        let mut vertices = Vec::new();
        let mut number = |vertex: u32| {
            *numbers.entry(vertex).or_insert_with(|| {
                vertices.push(Vector3::from(self.points[vertex as usize]));
                vertices.len() as u32 - 1
            })
        };
        let triangles = triangles.into_iter().map(|corners| corners.map(&mut number)).collect();
        (vertices, triangles)
    }

    /// A frame as what pictures are drawn from.
    pub(crate) fn drawn(&self, frame: VtuFrame) -> Body {
        let field = |array: PointArray| Field {
            name: array.name,
            components: array.components,
            values: array.values,
        };
        let fields = frame.point_data.into_iter().map(field).collect();
        Body { mesh: self.display.mesh.clone(), fields }
    }

    /// A field that shape functions of either sign must not make negative.
    fn not_negative(&self, values: &[f64]) -> Vec<f64> {
        interpolated(&self.rows, values, 1).into_iter().map(|value| value.max(0.0)).collect()
    }

    /// J, stress and strain at the vertices, each of its region.
    fn material(&self, fields: &NodalFields) -> Vec<LocalFields> {
        let vertices = self.display.mesh.vertices.par_iter().zip(&self.owners).enumerate();
        let at = |(vertex, (X, region)): (usize, (&Vector3, &u16))| {
            let row = self.rows.row(vertex);
            fields.at(X, *region, &self.rows.nodes[row.clone()], &self.rows.phi[row])
        };
        vertices.map(at).collect()
    }
}

/// The region of each vertex of a mesh, on borders the first.
fn owners(mesh: &Mesh) -> Vec<u16> {
    let mut owners = vec![u16::MAX; mesh.vertices.len()];
    for (cell, region) in mesh.iter().zip(&mesh.regions) {
        for &vertex in cell {
            let owner = &mut owners[vertex as usize];
            *owner = (*owner).min(*region);
        }
    }
    owners
}

/// Principal values, the largest first, of the Green–Lagrange strain.
fn principal_strains(local: &[LocalFields]) -> Vec<f64> {
    let principal = |local: &LocalFields| -> [f64; 3] {
        let e = &local.strain;
        let E = Matrix3::new(e[0], e[3], e[5], e[3], e[1], e[4], e[5], e[4], e[2]);
        let mut values: [f64; 3] = E.symmetric_eigenvalues().into();
        values.sort_by(|a, b| b.total_cmp(a));
        values
    };
    local.par_iter().flat_map_iter(principal).collect()
}

/// √(3/2 s : s) with the deviator s of a Cauchy stress by rows \[Pa\].
fn von_mises(stress: &[f64; 9]) -> f64 {
    let mean = (stress[0] + stress[4] + stress[8]) / 3.0;
    let part = |k: usize| stress[k] - if k.is_multiple_of(4) { mean } else { 0.0 };
    (1.5 * (0..9).map(|k| part(k).powi(2)).sum::<f64>()).sqrt()
}

/// Points whose rows are made one after the other.
const PIECE: usize = 32;
/// Points whose rows are packed at once: those are stored twice.
const BATCH: usize = 16 * PIECE;

/// φ at points of the body; where a thin part has too few nodes around, that at the nearest node.
fn rows_near(approximation: &Approximation, positions: &[Vector3]) -> Rows {
    let nodes = &approximation.nodes;
    let at_nearest = |X: &Vector3| -> Support {
        let squared = |node: &Vector3| (node - X).norm_squared();
        let nearest = nodes.iter().enumerate();
        let nearest = nearest.min_by(|a, b| squared(a.1).total_cmp(&squared(b.1)));
        let Some((number, node)) = nearest else { return Support::default() };
        approximation.evaluate(node).unwrap_or_else(|_| Support {
            nodes: vec![number as u32],
            phi: vec![1.0],
            ..Support::default()
        })
    };
    let evaluate = |piece: &[Vector3]| -> Vec<Support> {
        let support = |X: &Vector3| approximation.evaluate(X).unwrap_or_else(|_| at_nearest(X));
        piece.iter().map(support).collect()
    };
    let mut rows = Rows::default();
    for batch in positions.chunks(BATCH) {
        let pieces: Vec<Vec<Support>> = batch.par_chunks(PIECE).map(evaluate).collect();
        for support in pieces.into_iter().flatten() {
            rows.nodes.extend(support.nodes);
            rows.phi.extend(support.phi);
            rows.starts.push(rows.nodes.len());
        }
    }
    rows.nodes.shrink_to_fit();
    rows.phi.shrink_to_fit();
    rows
}

/// Vectors \[vertex\]\[x, y, z\] of the field with these nodal parameters.
fn vectors(rows: &Rows, parameters: &[f64], components: usize) -> Vec<f64> {
    let value = |i| <[f64; 3]>::from(rows.interpolate(i, parameters, components));
    (0..rows.len()).into_par_iter().flat_map_iter(value).collect()
}

/// Values \[vertex\]\[component\] from those at the nodes.
fn interpolated(rows: &Rows, values: &[f64], components: usize) -> Vec<f64> {
    let mut all = vec![0.0; components * rows.len()];
    all.par_chunks_mut(components).enumerate().for_each(|(i, sums)| {
        for entry in rows.row(i) {
            let at = components * rows.nodes[entry] as usize;
            for (sum, value) in sums.iter_mut().zip(&values[at..at + components]) {
                *sum += rows.phi[entry] * value;
            }
        }
    });
    all
}

#[cfg(test)]
mod tests;
