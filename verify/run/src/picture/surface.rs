//! The boundary of a mesh as triangles with normals.
#![allow(non_snake_case)]

use crate::display::Mesh;
use mtled::algebra::tensor::Vector3;
use rayon::prelude::*;

/// Cosine of the angle between neighbours that are drawn as one smooth face \[–\].
const SMOOTH: f64 = 0.75;

/// A corner of a triangle as it is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    /// Where it is drawn \[m\].
    pub at: Vector3,
    /// Towards the outside.
    pub normal: Vector3,
    /// The field there.
    pub value: f64,
}

/// A triangle of the boundary, or of a plane body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangle {
    pub corners: [Corner; 3],
    pub region: u16,
}

/// The triangles that show a mesh whose vertices are drawn at `places` \[m\] with these values:
/// its boundary in space, all of it in a plane.
pub(crate) fn triangles(mesh: &Mesh, places: &[Vector3], values: &[f64]) -> Vec<Triangle> {
    let sides: Vec<(Vec<u32>, usize)> = match mesh.corners {
        3 => mesh.iter().map(<[u32]>::to_vec).zip(0..).collect(),
        _ => mesh.boundary(),
    };
    let area = |side: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|n| places[side[n] as usize]);
        (b - a).cross(&(c - a))
    };
    let areas: Vec<Vector3> = sides.iter().map(|(side, _)| area(side)).collect();
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); places.len()];
    for (number, (side, _)) in sides.iter().enumerate() {
        side.iter().for_each(|&vertex| around[vertex as usize].push(number as u32));
    }
    let normal_at = |vertex: u32, own: &Vector3| -> Vector3 {
        let direction = own.normalize();
        let alike = around[vertex as usize].iter().map(|&n| &areas[n as usize]);
        let alike = alike.filter(|area| area.dot(&direction) > SMOOTH * area.norm());
        alike.sum::<Vector3>().try_normalize(0.0).unwrap_or(direction)
    };
    let triangle = |((side, cell), area): (&(Vec<u32>, usize), &Vector3)| {
        let corner = |n: usize| {
            let vertex = side[n] as usize;
            Corner { at: places[vertex], normal: normal_at(side[n], area), value: values[vertex] }
        };
        // One without an area shows nothing.
        (area.norm() > 0.0)
            .then(|| Triangle { corners: [0, 1, 2].map(corner), region: mesh.regions[*cell] })
    };
    sides.par_iter().zip(&areas).filter_map(triangle).collect()
}
