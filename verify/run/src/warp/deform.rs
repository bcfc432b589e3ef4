//! Images and fields on the grid of an image.
#![allow(non_snake_case)]

use super::error::WarpError;
use super::field::DisplacementField;
use super::inverse::{Source, TOLERANCE, source_of};
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled_io::files::image::{Grid, Image, Interpolation};
use rayon::prelude::*;
use std::path::Path;

/// An image in the deformed space, and where its voxels came from.
#[derive(Debug)]
pub struct Deformed {
    /// Stored numbers, first index fastest.
    pub voxels: Vec<u8>,
    /// X − x \[voxel\] \[m\].
    pub sources: Vec<[f32; 3]>,
    /// Voxels for which no source was found.
    pub unconverged: usize,
    /// The largest |X + u(X) − x| \[m\].
    pub largest_residual: f64,
    /// Most evaluations of the field for one voxel.
    pub most_iterations: usize,
    /// Voxels that came from outside of the image; they are 0.
    pub from_outside: usize,
}

impl Deformed {
    fn empty() -> Deformed {
        Deformed {
            voxels: Vec::new(),
            sources: Vec::new(),
            unconverged: 0,
            largest_residual: 0.0,
            most_iterations: 0,
            from_outside: 0,
        }
    }

    fn count(&mut self, source: &Source) {
        self.unconverged += usize::from(source.residual > TOLERANCE);
        self.largest_residual = self.largest_residual.max(source.residual);
        self.most_iterations = self.most_iterations.max(source.iterations);
        self.sources.push(single(&source.vector));
    }

    fn append(&mut self, row: Deformed) {
        self.voxels.extend(row.voxels);
        self.sources.extend(row.sources);
        self.unconverged += row.unconverged;
        self.largest_residual = self.largest_residual.max(row.largest_residual);
        self.most_iterations = self.most_iterations.max(row.most_iterations);
        self.from_outside += row.from_outside;
    }
}

fn single(vector: &Vector3) -> [f32; 3] {
    [vector.x as f32, vector.y as f32, vector.z as f32]
}

/// The image after the deformation, on its own grid: the value at x is that at X(x).
pub fn deform(field: &DisplacementField, image: &Image, how: Interpolation) -> Deformed {
    let rows: Vec<Deformed> = (0..image.grid.size[1] * image.grid.size[2])
        .into_par_iter()
        .map(|row| deform_row(field, image, how, row))
        .collect();
    rows.into_iter().fold(Deformed::empty(), |mut all, row| {
        all.append(row);
        all
    })
}

/// One line of voxels along the first index, each starting where the sources of the two before
/// lead, with the gradient found at the last one.
fn deform_row(
    field: &DisplacementField,
    image: &Image,
    how: Interpolation,
    row: usize,
) -> Deformed {
    let (grid, [nx, ny, _]) = (&image.grid, image.grid.size);
    let mut deformed = Deformed::empty();
    let [mut before, mut last] = [Vector3::zeros(); 2];
    let mut inverse = Matrix3::identity();
    for i in 0..nx {
        let voxel = [i, row % ny, row / ny];
        let source = source_of(field, &grid.centre(voxel), &(2.0 * last - before), inverse);
        (before, last, inverse) = (last, source.vector, source.inverse);
        // Exactly the voxel where nothing moves.
        let index = Vector3::from(voxel.map(|n| n as f64)) + grid.steps(&source.vector);
        let inside = image.sample(&index, how, &mut deformed.voxels);
        deformed.from_outside += usize::from(!inside);
        deformed.count(&source);
    }
    deformed
}

/// u \[voxel\] \[m\] at the voxels of the undeformed space.
pub fn forward_field(field: &DisplacementField, grid: &Grid) -> Vec<[f32; 3]> {
    let [nx, ny, nz] = grid.size;
    (0..nx * ny * nz)
        .into_par_iter()
        .map(|n| single(&field.at(&grid.centre([n % nx, n / nx % ny, n / (nx * ny)]))))
        .collect()
}

/// Number of nodes of the body that lie outside of the voxels of an image; an image without
/// any of them, at `path`, is refused.
pub fn nodes_outside(
    field: &DisplacementField,
    grid: &Grid,
    path: &Path,
) -> Result<usize, WarpError> {
    let nodes = field.nodes();
    let inside = nodes.iter().filter(|X| grid.contains(&grid.index_of(X))).count();
    match inside {
        0 => Err(WarpError::OtherSpace {
            path: path.to_path_buf(),
            image: grid.bounds(),
            body: field.node_bounds(),
        }),
        inside => Ok(nodes.len() - inside),
    }
}
