//! Faces of any number of corners, as files have them.

use super::ears::{CutError, cut};
use super::space::Space;
use super::triangles::{SurfaceFile, Triangles};
use crate::files::error::{Mistake, check_finite};
use crate::files::unit::LengthUnit;
use mtled::algebra::tensor::Vector3;

/// Faces that share points.
#[derive(Debug, Default)]
pub(crate) struct Polygons {
    /// As they stand in the file.
    pub points: Vec<[f64; 3]>,
    /// Numbers of the points of all faces, one face after the other.
    corners: Vec<u32>,
    /// Where the corners of each face end.
    ends: Vec<usize>,
    /// Lines and points, which enclose nothing.
    pub lines: usize,
    /// Axes of the coordinates.
    pub space: Space,
}

impl Polygons {
    /// Takes the axes that a header or a comment states, if it states any.
    pub(crate) fn state_space(&mut self, text: &str) -> Result<(), Mistake> {
        self.space = Space::stated(text.as_bytes())?.unwrap_or(self.space);
        Ok(())
    }

    /// Adds a face; one of two corners is a line.
    pub(crate) fn push(&mut self, corners: impl IntoIterator<Item = u32>) {
        let first = self.corners.len();
        self.corners.extend(corners);
        if self.corners.len() < first + 3 {
            self.corners.truncate(first);
            self.lines += 1;
        } else {
            self.ends.push(self.corners.len());
        }
    }

    /// Adds the triangles of a strip, of which every second one runs the other way round.
    pub(crate) fn push_strip(&mut self, points: &[u32]) {
        if points.len() < 3 {
            self.lines += 1;
        }
        for (n, corners) in points.windows(3).enumerate() {
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            self.push(if n % 2 == 0 { [a, b, c] } else { [b, a, c] });
        }
    }

    /// Triangles along R, A and S \[m\].
    pub(crate) fn triangles(self, unit: LengthUnit) -> Result<SurfaceFile, Mistake> {
        if self.points.is_empty() {
            return Err(Mistake::NoPoints);
        }
        let space = self.space;
        let place = |point: &[f64; 3]| Vector3::from(space.to_ras(*point)) * unit.in_metres();
        let vertices: Vec<Vector3> = self.points.iter().map(place).collect();
        check_finite(&vertices)?;
        let mut triangles = Vec::with_capacity(self.ends.len());
        let mut first = 0;
        for (face, &end) in (1..).zip(&self.ends) {
            let corners = &self.corners[first..end];
            let count = vertices.len();
            if let Some(&point) = corners.iter().find(|&&point| point as usize >= count) {
                return Err(Mistake::NoSuchPoint { face, point: u64::from(point) + 1, count });
            }
            cut(&vertices, corners, &mut triangles).map_err(|error| of_face(error, face))?;
            first = end;
        }
        if triangles.is_empty() {
            return Err(Mistake::NoTriangles);
        }
        let mut notes = Vec::new();
        if self.lines > 0 {
            let lines = self.lines;
            notes.push(format!("{lines} lines or points are left out: they enclose nothing"));
        }
        Ok(SurfaceFile { surface: Triangles { vertices, triangles }, notes })
    }
}

fn of_face(error: CutError, face: usize) -> Mistake {
    match error {
        CutError::Crossed { at } => Mistake::CrossedFace { face, at: at.into() },
        CutError::TooMany { corners, most } => Mistake::LargeFace { face, corners, most },
    }
}
