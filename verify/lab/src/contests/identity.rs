//! Identities of the problems of the benchmark: a name with a version, and the hashes of what is
//! asked and of what answers are compared with.

use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// A problem of the benchmark. Where its inputs or its references change it becomes the next
/// version, so that results of one version are always about the same thing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identity {
    /// Such as `cube_shear-v1`.
    pub id: String,
    /// Name of the bundled case.
    pub case: String,
    /// What is hard about it.
    pub group: String,
    /// Fingerprint of the problem, that of reference files.
    pub inputs: String,
    /// SHA-256 of its reference files.
    pub references: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    problem: Vec<Identity>,
}

/// The problems of the benchmark, in the order of their names.
pub fn benchmark() -> &'static [Identity] {
    static PROBLEMS: LazyLock<Vec<Identity>> = LazyLock::new(|| {
        // A test reads it.
        toml_edit::de::from_str::<Manifest>(mtled_reference::BENCHMARK)
            .map(|manifest| manifest.problem)
            .unwrap_or_default()
    });
    &PROBLEMS
}

impl Identity {
    /// The problem with these inputs.
    pub(crate) fn of_inputs(inputs: &str) -> Option<&'static Identity> {
        benchmark().iter().find(|identity| identity.inputs == inputs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::store::Source;
    use mtled_case::bundled::{REFERENCES, bundled_reference};
    use sha2::{Digest, Sha256};

    /// SHA-256, in hexadecimal, of the files that a case is compared with.
    fn hash_of_references(case: &str, inputs: &str) -> String {
        let mut hash = Sha256::new();
        hash.update(bundled_reference(case).unwrap_or_default());
        let finer = mtled_reference::FINEST_BLOCK;
        if finer.contains(inputs) {
            hash.update(finer);
        }
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }

    #[test]
    fn every_bundled_reference_is_a_problem_whose_hashes_are_those_of_the_manifest() {
        let folder = tempfile::tempdir().unwrap();
        let known = benchmark();
        let found: Vec<Identity> = REFERENCES
            .iter()
            .map(|(name, _)| {
                let inputs =
                    Source::find(name, folder.path(), &[]).unwrap().case.problem_hash.clone();
                let references = hash_of_references(name, &inputs);
                let of_case = known.iter().find(|identity| identity.case == *name);
                let (id, group) = of_case
                    .map(|identity| (identity.id.clone(), identity.group.clone()))
                    .unwrap_or_default();
                Identity { id, case: name.to_string(), group, inputs, references }
            })
            .collect();
        for (found, known) in found.iter().zip(known) {
            assert_eq!(found, known, "a problem that has changed becomes its next version");
        }
        assert_eq!(found.len(), known.len());
        assert!(known.iter().all(|identity| identity.id.contains("-v")));
    }
}
