//! A case: the problem of a case file with its probes and outputs.

use crate::scene::diagnostic::{Diagnostic, Location};
use crate::scene::document::Document;
use crate::scene::edit::Override;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::Shape;
use mtled::problem::Problem;

/// A case file without mistakes.
#[derive(Debug, Clone)]
pub struct Case {
    /// Stem of the file name.
    pub name: String,
    /// One line that names the problem.
    pub title: String,
    /// What is solved and why.
    pub description: String,
    /// Where the problem and its reference values come from.
    pub source: String,
    /// What is solved.
    pub problem: Problem,
    /// Where displacements are recorded.
    pub probes: Vec<Probe>,
    /// What is written.
    pub outputs: Outputs,
    /// What should be known about the files that it names, such as an image without a place.
    pub notes: Vec<String>,
    /// SHA-256 of the file and of every file it refers to, in hexadecimal.
    pub hash: String,
    /// Fingerprint of what is solved, whatever the recipe
    /// ([`problem_hash`](crate::scene::problem_hash())).
    pub problem_hash: String,
    pub(super) document: Document,
}

/// Where displacements are recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name in results.
    pub name: String,
    /// What is recorded.
    pub kind: ProbeKind,
}

/// What a probe records.
#[derive(Debug, Clone, PartialEq)]
pub enum ProbeKind {
    /// A reference position \[m\].
    Point(Vector3),
    /// Those of equally spaced reference positions that lie in the body.
    Lattice {
        /// \[m\], x fastest.
        positions: Vec<Vector3>,
        /// Number of positions outside the body.
        left_out: usize,
    },
    /// The centre of mass of the region of this name.
    CentreOfMass {
        /// Name of the region.
        region: String,
    },
}

impl ProbeKind {
    /// Number of positions of which the displacement is recorded.
    pub fn count(&self) -> usize {
        match self {
            ProbeKind::Point(_) | ProbeKind::CentreOfMass { .. } => 1,
            ProbeKind::Lattice { positions, .. } => positions.len(),
        }
    }

    /// Number of positions that lie outside the body and are not recorded.
    pub fn left_out(&self) -> usize {
        match self {
            ProbeKind::Lattice { left_out, .. } => *left_out,
            _ => 0,
        }
    }

    /// The reference positions \[m\] of a point or lattice, x fastest; none for
    /// a centre of mass.
    pub fn positions(&self) -> Vec<Vector3> {
        match self {
            ProbeKind::Point(point) => vec![*point],
            ProbeKind::Lattice { positions, .. } => positions.clone(),
            ProbeKind::CentreOfMass { .. } => Vec::new(),
        }
    }
}

/// Equally spaced positions from `min` to `max` \[m\], x fastest, `counts` along the axes.
pub(super) fn lattice(min: &Vector3, max: &Vector3, counts: &[usize; 3]) -> Vec<Vector3> {
    let at = |axis: usize, index: usize| {
        let fraction = index as f64 / (counts[axis].max(2) - 1) as f64;
        min[axis] + (max[axis] - min[axis]) * fraction
    };
    let (nx, ny) = (counts[0], counts[1]);
    (0..nx * ny * counts[2])
        .map(|n| Vector3::new(at(0, n % nx), at(1, n / nx % ny), at(2, n / (nx * ny))))
        .collect()
}

/// What is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Outputs {
    /// Number of VTU frames after the first.
    pub frames: usize,
    /// Times at which a step ends and a frame and a sample are taken, increasing \[s\]; where
    /// there are none, frames are taken at equal parts of the progress.
    pub times: Vec<f64>,
    /// Times at which a step ends and the state of a motion is written, increasing \[s\].
    pub states: Vec<f64>,
    /// Number of samples of histories.
    pub history: usize,
    /// Moments of reactions are taken about this point \[m\].
    pub moment_about: Vector3,
    /// Whether the volumes of regions are recorded.
    pub volumes: bool,
}

impl Case {
    /// Place of a key path such as `prescribe[0].where`; a table of an array can be
    /// named too, as in `prescribe.top`.
    pub fn locate(&self, key: &str) -> Option<Location> {
        self.document.locate(key)
    }

    /// The name of the file as it was given; of a bundled case, its name with `.toml`.
    pub fn file(&self) -> &str {
        self.document.file()
    }

    /// What stands under its keys in place of what the file has.
    pub fn overrides(&self) -> &[Override] {
        self.document.overrides()
    }

    /// The file as it was read, with the overrides written into it.
    pub fn text(&self) -> &str {
        self.document.text()
    }

    /// Where the body lies, for those who look for it elsewhere.
    pub fn place(&self) -> String {
        place(&self.problem.body)
    }

    /// A mistake that shows only after reading, such as a condition that
    /// selects no node, located like the others.
    pub fn diagnostic(&self, key: &str, message: String) -> Diagnostic {
        self.document.diagnostic(key, message)
    }
}

/// Where a solid lies, for those who look for it elsewhere, with three digits of its size; empty
/// for an unbounded one.
pub(crate) fn place(solid: &Shape) -> String {
    let Some((lower, upper)) = solid.bounding_box() else { return String::new() };
    // A cross-section has no ends along z.
    let axes = if lower.z.is_finite() && upper.z.is_finite() { 3 } else { 2 };
    let size = (0..axes).map(|axis| upper[axis] - lower[axis]).fold(f64::MIN_POSITIVE, f64::max);
    let digits = (3.0 - size.log10().ceil()).clamp(0.0, 12.0) as usize;
    let corner = |corner: &Vector3| {
        let numbers: Vec<_> = (0..axes).map(|axis| format!("{:.digits$}", corner[axis])).collect();
        numbers.join(", ")
    };
    format!("; the body lies between ({}) and ({}) m", corner(&lower), corner(&upper))
}
