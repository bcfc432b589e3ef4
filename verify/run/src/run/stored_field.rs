//! The displacement field of a run in a file: what evaluates it anywhere, beside the case.
#![allow(non_snake_case)]

use anyhow::Result;
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled_case::scene::{Case, Override};
use mtled_checks::escape::printable_json;
use mtled_checks::report::write_atomically;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Name of the file in the folder of a run.
pub(crate) const FIELD_FILE: &str = "displacement_field.json";

/// Version of the layout of the file.
const SCHEMA_VERSION: u32 = 1;

/// Lengths of a field are smaller: those of no body are as large.
const LARGEST_M: f64 = 1e12;

/// Nodes, influence radii and nodal parameters at the end of a run. With the basis, the weight
/// function and the dimension of its case they are the displacement field.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredField {
    schema_version: u32,
    /// The case that was solved.
    pub case: SolvedCase,
    /// Whether the user stopped the run before its end.
    pub stopped: bool,
    /// Reference positions \[node\] \[m\].
    pub nodes_m: Vec<[f64; 3]>,
    /// \[node\] \[m\]
    pub influence_radius_m: Vec<f64>,
    /// \[component of node\] \[m\]; displacements of the nodes only where shape functions
    /// interpolate.
    pub nodal_parameters_m: Vec<f64>,
}

/// The case that a field belongs to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolvedCase {
    /// Stem of the file name.
    pub name: String,
    /// [`Case::hash`].
    pub hash: String,
    /// Where the case file was, or the name of a bundled case.
    pub file: PathBuf,
    /// Values under its keys in place of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub overrides: Vec<Override>,
}

/// Why the field of a run cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // The messages say it.
pub enum FieldError {
    #[error(
        "{}: there is no displacement field; give the folder of a run of `mtled solve` that came to an end, and \
         solve again what an earlier version has solved", path.display()
    )]
    Missing { path: PathBuf },
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable { path: PathBuf, reason: String },
    #[error("{}: has the layout {found}, this program reads {SCHEMA_VERSION}; solve the case again", path.display())]
    OtherVersion { path: PathBuf, found: u32 },
    #[error(
        "{}: {nodes} nodes need as many radii and {components} parameters each, all less than {LARGEST_M:e} m, and there are {radii} \
         and {parameters}; the file is damaged, solve the case again", path.display()
    )]
    Damaged { path: PathBuf, nodes: usize, components: usize, radii: usize, parameters: usize },
    #[error(
        "{}: belongs to a case with the hash {}, but {case} has {}: the case file, or a file that it names, was \
         changed since; solve it again, or name the file that was solved with --case", path.display(),
        short(solved), short(found)
    )]
    OtherCase { path: PathBuf, solved: String, case: String, found: String },
}

/// The first digits of a hash.
fn short(hash: &str) -> &str {
    hash.get(..12).unwrap_or(hash)
}

impl StoredField {
    /// The field with nodal parameters `u` \[component of node\] \[m\].
    pub fn new(case: &Case, simulation: &Simulation, u: &[f64], stopped: bool) -> StoredField {
        let approximation = &simulation.discretisation.approximation;
        let file = Path::new(case.file());
        let file = if file.is_file() {
            std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf())
        } else {
            PathBuf::from(&case.name)
        };
        StoredField {
            schema_version: SCHEMA_VERSION,
            case: SolvedCase {
                name: case.name.clone(),
                hash: case.hash.clone(),
                file,
                overrides: case.overrides().to_vec(),
            },
            stopped,
            nodes_m: approximation.nodes.iter().map(|X| (*X).into()).collect(),
            influence_radius_m: approximation.influence_radius.clone(),
            nodal_parameters_m: u.to_vec(),
        }
    }

    /// Writes it to the folder of a run.
    pub(crate) fn write(&self, folder: &Path) -> Result<()> {
        let text = printable_json(&serde_json::to_string(self)?) + "\n";
        write_atomically(&folder.join(FIELD_FILE), text.as_bytes())
    }

    /// Reads it from the folder of a run.
    pub fn read(folder: &Path) -> Result<StoredField, FieldError> {
        let path = folder.join(FIELD_FILE);
        if !path.is_file() {
            return Err(FieldError::Missing { path });
        }
        let unreadable = |reason: String| FieldError::Unreadable { path: path.clone(), reason };
        let text = std::fs::read_to_string(&path).map_err(|error| unreadable(error.to_string()))?;
        let field: StoredField =
            serde_json::from_str(&text).map_err(|error| unreadable(error.to_string()))?;
        match field.schema_version {
            SCHEMA_VERSION => Ok(field),
            found => Err(FieldError::OtherVersion { path, found }),
        }
    }

    /// Refuses a field that belongs to another case, or whose numbers do not fit to it.
    pub fn check(&self, folder: &Path, case: &Case) -> Result<(), FieldError> {
        let path = folder.join(FIELD_FILE);
        if self.case.hash != case.hash {
            return Err(FieldError::OtherCase {
                path,
                solved: self.case.hash.clone(),
                case: case.file().to_string(),
                found: case.hash.clone(),
            });
        }
        let components = case.problem.dimension.components();
        let (nodes, radii) = (self.nodes_m.len(), self.influence_radius_m.len());
        let parameters = self.nodal_parameters_m.len();
        let numbers = self.nodes_m.iter().flatten().chain(&self.nodal_parameters_m);
        let sound = numbers.chain(&self.influence_radius_m).all(|number| number.abs() < LARGEST_M)
            && self.influence_radius_m.iter().all(|radius| *radius > 0.0);
        if nodes > 0 && radii == nodes && parameters == components * nodes && sound {
            Ok(())
        } else {
            Err(FieldError::Damaged { path, nodes, components, radii, parameters })
        }
    }

    /// Reference positions \[node\] \[m\].
    pub(crate) fn nodes(&self) -> Vec<Vector3> {
        self.nodes_m.iter().map(|X| Vector3::from(*X)).collect()
    }
}
