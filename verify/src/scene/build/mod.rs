//! Tables of a case file → a sound problem. Mistakes are collected; a problem
//! is handed out only where there are none.

mod conditions;
mod geometry;
mod material;
pub mod recipe;
mod time;

use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::Document;
use crate::scene::format::geometry::UnitFormat;
use crate::scene::format::{CaseFormat, DimensionFormat};
use crate::scene::reading::nearest;
use crate::scene::{Case, problem_hash};
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{LabelField, LabelMap, Shape};
use mtled::problem::{Dimension, Problem};
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What every part of the conversion needs.
pub struct Builder<'a> {
    pub document: &'a Document,
    pub base_dir: &'a Path,
    pub dimension: Dimension,
    /// Of selectors that state none \[m\].
    pub tolerance: f64,
    pub body: Option<Shape>,
    /// The body, or its cross-section in plane strain.
    pub section: Option<Shape>,
    /// The label map of the body, if it has one.
    pub body_map: Option<Arc<LabelMap>>,
    /// Label maps read so far.
    pub maps: HashMap<(PathBuf, Option<UnitFormat>), Arc<LabelMap>>,
    /// Solids made of labels so far, costly to make.
    pub fields: Vec<Arc<LabelField>>,
    mistakes: Vec<Diagnostic>,
    hash: Sha256,
}

impl Builder<'_> {
    /// Notes a mistake at a key path.
    pub fn mistake(&mut self, key: &str, message: impl Display) {
        self.mistakes.push(self.document.diagnostic(key, message.to_string()));
    }

    /// How many mistakes have been noted.
    pub fn count(&self) -> usize {
        self.mistakes.len()
    }

    /// Demands a positive number.
    pub fn positive(&mut self, key: &str, value: f64) {
        if value <= 0.0 {
            self.mistake(key, format!("is {value}; it must be positive"));
        }
    }

    /// Demands a number that is not negative.
    pub fn not_negative(&mut self, key: &str, value: f64) {
        if value < 0.0 {
            self.mistake(key, format!("is {value}; it must not be negative"));
        }
    }

    /// Demands a count of at least one.
    pub fn at_least_one(&mut self, key: &str, value: usize) {
        if value == 0 {
            self.mistake(key, "is 0; it must be at least 1");
        }
    }

    /// A direction of length one.
    pub fn direction(&mut self, key: &str, value: &[f64; 3]) -> Vector3 {
        let vector = Vector3::from(*value);
        vector.try_normalize(0.0).unwrap_or_else(|| {
            self.mistake(key, "is zero; it must be a direction");
            Vector3::z()
        })
    }

    pub fn is_plane(&self) -> bool {
        self.dimension != Dimension::Three
    }

    /// In plane strain, refuses a z component other than zero.
    pub fn no_z(&mut self, key: &str, value: &[f64; 3]) {
        if self.is_plane() && value[2] != 0.0 {
            self.mistake(key, format!("has z = {}; it must be 0 in plane strain", value[2]));
        }
    }

    /// Complains about a name that is none of `known`.
    pub fn unknown_name(&mut self, key: &str, what: &str, name: &str, known: &[&str]) {
        let hint = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.is_empty() => format!("there is no {what}"),
            None => format!("known: {}", known.join(", ")),
        };
        self.mistake(key, format!("there is no {what} called `{name}`; {hint}"));
    }

    /// Refuses names that occur twice or are empty; each comes with its key.
    pub fn unique_names<'n>(&mut self, names: impl Iterator<Item = (String, &'n str)>) {
        let mut seen = HashMap::new();
        for (key, name) in names {
            if name.is_empty() {
                self.mistake(&key, "is empty; it must name something");
            } else if let Some(first) = seen.get(name) {
                self.mistake(&key, format!("`{name}` is already the name of {first}"));
            } else {
                seen.insert(name, key.trim_end_matches(".name").to_string());
            }
        }
    }

    /// Path of a file named in the case file.
    pub fn resolve(&self, file: &Path) -> PathBuf {
        self.base_dir.join(file)
    }

    /// Adds a file that the case refers to, to the hash of the case.
    pub fn hash_file(&mut self, key: &str, path: &Path) {
        match std::fs::read(path) {
            Ok(bytes) => self.hash.update(bytes),
            Err(error) => self.mistake(key, format!("cannot read {}: {error}", path.display())),
        }
    }
}

/// Converts the whole case, or returns every mistake found.
pub fn build(
    format: &CaseFormat,
    document: Document,
    file_name: &str,
    base_dir: &Path,
) -> Result<Case, Vec<Diagnostic>> {
    let mut builder = Builder {
        document: &document,
        base_dir,
        dimension: Dimension::Three,
        tolerance: recipe::tolerance(&format.discretisation),
        body: None,
        section: None,
        body_map: None,
        maps: HashMap::new(),
        fields: Vec::new(),
        mistakes: Vec::new(),
        hash: Sha256::new_with_prefix(document.text()),
    };
    let problem = builder.problem(format);
    let probes = builder.probes(format);
    let outputs = builder.outputs(&format.output);
    let problem_hash = problem_hash(document.text(), base_dir)
        // A file that is missing has been noted where it stands.
        .inspect_err(|reason| {
            if builder.mistakes.is_empty() {
                builder.mistake("", reason);
            }
        })
        .unwrap_or_default();
    let Builder { mistakes, hash, .. } = builder;
    match problem {
        Some(problem) if mistakes.is_empty() => Ok(Case {
            name: Path::new(file_name).file_stem().unwrap_or_default().to_string_lossy().into(),
            title: format.title.clone(),
            description: format.description.trim().to_string(),
            source: format.source.trim().to_string(),
            problem,
            probes,
            outputs,
            hash: hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect(),
            problem_hash,
            document,
        }),
        _ => Err(mistakes),
    }
}

impl Builder<'_> {
    fn problem(&mut self, format: &CaseFormat) -> Option<Problem> {
        self.dimension = self.dimension_of(format);
        self.read_body(&format.geometry.shape);
        let regions = self.regions(format);
        let recipe = self.recipe(&format.discretisation);
        let conditions = self.conditions(&format.prescribe);
        let loads = self.loads(format);
        let obstacles = self.obstacles(&format.obstacle);
        let motion = self.motion(&format.time);
        self.names(format);
        Some(Problem {
            dimension: self.dimension,
            body: self.body.clone()?,
            regions,
            recipe: recipe?,
            conditions,
            loads,
            obstacles,
            motion,
        })
    }

    fn dimension_of(&mut self, format: &CaseFormat) -> Dimension {
        match (format.dimension, &format.plane) {
            (DimensionFormat::Three, None) => Dimension::Three,
            (DimensionFormat::Three, Some(_)) => {
                self.mistake("plane", "belongs to dimension = \"plane_strain\"; remove it in 3d");
                Dimension::Three
            }
            (DimensionFormat::PlaneStrain, None) => {
                let message = "is plane_strain; it needs a [plane] with thickness and z";
                self.mistake("dimension", message);
                Dimension::PlaneStrain { thickness: 1.0, z: 0.0 }
            }
            (DimensionFormat::PlaneStrain, Some(plane)) => {
                self.positive("plane.thickness", plane.thickness);
                Dimension::PlaneStrain { thickness: plane.thickness, z: plane.z }
            }
        }
    }

    /// Everything that is reported by name has one of its own.
    fn names(&mut self, format: &CaseFormat) {
        fn named<'n, T>(
            table: &'static str,
            rows: &'n [T],
            name: fn(&T) -> &str,
        ) -> impl Iterator<Item = (String, &'n str)> {
            rows.iter().enumerate().map(move |(n, row)| (format!("{table}[{n}].name"), name(row)))
        }
        self.unique_names(named("region", &format.region, |row| &row.name));
        self.unique_names(named("probe", &format.probe, |row| &row.name));
        let conditions = named("prescribe", &format.prescribe, |row| &row.name)
            .chain(named("traction", &format.traction, |row| &row.name))
            .chain(named("obstacle", &format.obstacle, |row| &row.name));
        self.unique_names(conditions);
    }
}
