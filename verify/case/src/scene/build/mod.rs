//! Tables of a case file → a sound problem. Mistakes are collected; a problem
//! is returned only where there are none.

mod builder;
mod conditions;
mod data;
mod fibres;
mod field;
mod geometry;
mod material;
mod recipe;
mod time;

use crate::scene::case::Case;
use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::Document;
use crate::scene::format::{CaseFormat, DimensionFormat};
use crate::scene::problem_hash::problem_hash;
use builder::Builder;
use mtled::problem::{Dimension, Mistake, Problem, Wrong};
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::path::Path;

/// Converts the whole case, or returns every mistake found.
pub(crate) fn build(
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
        body_labels: None,
        filled_map: None,
        maps: HashMap::new(),
        fields: Vec::new(),
        notes: Vec::new(),
        mistakes: Vec::new(),
        hash: Sha256::new_with_prefix(document.text()),
    };
    let problem = builder.problem(format);
    let probes = builder.probes(format);
    let outputs = builder.outputs(&format.output, &format.time);
    // The files that a case names are read again only where they can be used.
    let problem_hash = if builder.mistakes.is_empty() {
        problem_hash(document.text(), base_dir)
            .inspect_err(|reason| builder.mistake("", reason))
            .unwrap_or_default()
    } else {
        String::new()
    };
    let Builder { notes, mistakes, hash, .. } = builder;
    match problem {
        Some(problem) if mistakes.is_empty() => Ok(Case {
            name: Path::new(file_name).file_stem().unwrap_or_default().to_string_lossy().into(),
            title: format.title.clone(),
            description: format.description.trim().to_string(),
            source: format.source.trim().to_string(),
            problem,
            probes,
            outputs,
            notes,
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
        let problem = Problem {
            dimension: self.dimension,
            body: self.body.clone()?,
            regions,
            recipe: recipe?,
            conditions,
            loads,
            obstacles,
            motion,
        };
        // Each of the others has been refused where it stands.
        let unsolved = |found: &Mistake| matches!(found.wrong, Wrong::NoTime | Wrong::NoFriction);
        let refused = problem.check().into_iter().filter(unsolved);
        self.refused(refused.collect(), |_| "time.solver".into());
        if format.time.parts.is_some() && !problem.has_memory() {
            let message =
                "belongs to materials with viscosity (prony), and there is none; remove it";
            self.mistake("time.parts", message);
        }
        Some(problem)
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
            .chain(named("pressure", &format.pressure, |row| &row.name))
            .chain(named("spring", &format.spring, |row| &row.name))
            .chain(named("cavity", &format.cavity, |row| &row.name))
            .chain(named("obstacle", &format.obstacle, |row| &row.name));
        self.unique_names(conditions);
    }
}
