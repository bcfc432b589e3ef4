//! Case files: one TOML file states one problem; every mistake in it is
//! reported with file, line, column, key and what was expected.

mod build;
mod diagnostic;
mod document;
mod edit;
mod format;
mod knob;
mod problem_hash;
mod reading;

pub use build::recipe::defaults;
pub use diagnostic::{Diagnostic, Location, one_error};
pub use edit::load::movable;
pub use edit::{EditError, edited};
pub use knob::{KNOBS, Knob, Level, Setting};
pub use problem_hash::problem_hash;

use document::Document;
use mtled::algebra::tensor::Vector3;
use mtled::problem::Problem;
use std::path::Path;

/// A case file that has been read and found sound.
#[derive(Debug, Clone)]
pub struct Case {
    /// Stem of the file name.
    pub name: String,
    pub title: String,
    pub description: String,
    pub source: String,
    pub problem: Problem,
    pub probes: Vec<Probe>,
    pub outputs: Outputs,
    /// SHA-256 of the file and of every file it refers to, in hexadecimal.
    pub hash: String,
    /// Fingerprint of what is solved, whatever the recipe ([`problem_hash`]).
    pub problem_hash: String,
    document: Document,
}

/// Where displacements are recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    pub name: String,
    pub kind: ProbeKind,
}

/// What a probe looks at.
#[derive(Debug, Clone, PartialEq)]
pub enum ProbeKind {
    /// A reference position \[m\].
    Point(Vector3),
    /// Equally spaced reference positions from `min` to `max` \[m\].
    Lattice { min: Vector3, max: Vector3, counts: [usize; 3] },
    /// The centre of mass of the region of this name.
    CentreOfMass { region: String },
}

impl ProbeKind {
    /// The reference positions \[m\] of a point or lattice, x fastest; none for
    /// a centre of mass.
    pub fn positions(&self) -> Vec<Vector3> {
        match self {
            ProbeKind::Point(point) => vec![*point],
            ProbeKind::Lattice { min, max, counts } => lattice(min, max, counts),
            ProbeKind::CentreOfMass { .. } => Vec::new(),
        }
    }
}

fn lattice(min: &Vector3, max: &Vector3, counts: &[usize; 3]) -> Vec<Vector3> {
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
    /// Number of VTU frames.
    pub frames: usize,
    /// Number of samples of histories.
    pub history: usize,
    /// Moments of reactions are taken about this point \[m\].
    pub moment_about: Vector3,
}

impl Case {
    /// Where a key path such as `prescribe[0].where` stands; an array of
    /// tables can be entered by name too, as in `prescribe.top`.
    pub fn locate(&self, key: &str) -> Option<Location> {
        self.document.locate(key)
    }

    /// The file as it was read.
    pub fn text(&self) -> &str {
        self.document.text()
    }

    /// A mistake that shows only after reading, such as a condition that
    /// selects no node, located like the others.
    pub fn diagnostic(&self, key: &str, message: String) -> Diagnostic {
        self.document.diagnostic(key, message)
    }
}

/// Reads a case file and the files it refers to.
pub fn read_case(path: &Path) -> Result<Case, Vec<Diagnostic>> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|error| vec![Diagnostic::of_file(&file, format!("cannot be read: {error}"))])?;
    parse_case(&text, &file, path.parent().unwrap_or(Path::new(".")))
}

/// Reads a case from text; other files are looked for from `base_dir`.
pub fn parse_case(text: &str, file_name: &str, base_dir: &Path) -> Result<Case, Vec<Diagnostic>> {
    let document = Document::parse(text, file_name).map_err(|mistake| vec![mistake])?;
    let numbers = document.numbers_that_are_not_finite();
    if !numbers.is_empty() {
        return Err(numbers);
    }
    let format = reading::deserialise(&document).map_err(|mistake| vec![mistake])?;
    build::build(&format, document, file_name, base_dir)
}

/// The JSON Schema of a case file.
pub fn schema() -> String {
    let schema = schemars::schema_for!(format::CaseFormat);
    serde_json::to_string_pretty(&schema).unwrap_or_default()
}
