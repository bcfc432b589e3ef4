//! Mistakes and shared state of the conversion.

use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::Document;
use crate::scene::format::UnitFormat;
use crate::scene::nearest::nearest;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{LabelField, LabelMap, Shape};
use mtled::problem::{Dimension, Mistake};
use mtled_io::files::visit_bytes;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What every part of the conversion needs.
pub(crate) struct Builder<'a> {
    /// The text, for the place of mistakes.
    pub document: &'a Document,
    /// Where files named in the case are looked for.
    pub base_dir: &'a Path,
    /// Space, or the plane of plane strain.
    pub dimension: Dimension,
    /// Of selectors that state none \[m\].
    pub tolerance: f64,
    pub body: Option<Shape>,
    /// The body, or its cross-section in plane strain.
    pub section: Option<Shape>,
    /// The solid of labels that the body is, or is cut from.
    pub body_labels: Option<Arc<LabelField>>,
    /// Its label map, with the labels of the body in the voxels beside it, once a selector asks for it.
    pub filled_map: Option<Arc<LabelMap>>,
    /// Label maps read so far.
    pub maps: HashMap<(PathBuf, Option<UnitFormat>, Option<usize>), Arc<LabelMap>>,
    /// Solids made of labels so far, costly to make.
    pub fields: Vec<Arc<LabelField>>,
    /// What should be known about the files of the case.
    pub notes: Vec<String>,
    /// Mistakes so far.
    pub mistakes: Vec<Diagnostic>,
    /// Of the case file and of the files that it names.
    pub hash: Sha256,
}

impl Builder<'_> {
    /// Records a mistake at a key path.
    pub(crate) fn mistake(&mut self, key: &str, message: impl Display) {
        self.mistakes.push(self.document.diagnostic(key, message.to_string()));
    }

    /// Records a mistake at a key path if there is one.
    pub(crate) fn refuse_if(&mut self, wrong: bool, key: &str, message: impl Display) {
        if wrong {
            self.mistake(key, message);
        }
    }

    /// Records what the solver refuses of a part of the problem, each at the key of its field.
    pub(crate) fn refused(&mut self, mistakes: Vec<Mistake>, key: impl Fn(&str) -> String) {
        for Mistake { field, wrong } in mistakes {
            self.mistake(&key(&field), wrong);
        }
    }

    /// Number of mistakes so far.
    pub(crate) fn count(&self) -> usize {
        self.mistakes.len()
    }

    /// Requires a positive number.
    pub(crate) fn positive(&mut self, key: &str, value: f64) {
        self.refuse_if(value <= 0.0, key, format!("is {value}; it must be positive"));
    }

    /// Requires a number that is not negative.
    pub(crate) fn not_negative(&mut self, key: &str, value: f64) {
        self.refuse_if(value < 0.0, key, format!("is {value}; it must not be negative"));
    }

    /// Requires a count of at least one.
    pub(crate) fn at_least_one(&mut self, key: &str, value: usize) {
        self.refuse_if(value == 0, key, "is 0; it must be at least 1");
    }

    /// Requires no more than `most` of something.
    pub(crate) fn at_most(&mut self, key: &str, what: &str, count: f64, most: f64) {
        let message = format!("asks for {count} {what}; at most {most} are allowed");
        self.refuse_if(count > most, key, message);
    }

    /// A direction of length one.
    pub(crate) fn direction(&mut self, key: &str, value: &[f64; 3]) -> Vector3 {
        let vector = Vector3::from(*value);
        vector.try_normalize(0.0).unwrap_or_else(|| {
            self.mistake(key, "is zero; it must be a direction");
            Vector3::z()
        })
    }

    /// Whether the problem is one of plane strain.
    pub(crate) fn is_plane(&self) -> bool {
        self.dimension != Dimension::Three
    }

    /// In plane strain, refuses a z component other than zero.
    pub(crate) fn no_z(&mut self, key: &str, value: &[f64; 3]) {
        if self.is_plane() && value[2] != 0.0 {
            self.mistake(key, format!("has z = {}; it must be 0 in plane strain", value[2]));
        }
    }

    /// Reports a name that is none of `known`.
    pub(crate) fn unknown_name(&mut self, key: &str, what: &str, name: &str, known: &[&str]) {
        let hint = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.is_empty() => format!("there is no {what}"),
            None => format!("known: {}", known.join(", ")),
        };
        self.mistake(key, format!("there is no {what} called `{name}`; {hint}"));
    }

    /// Refuses names that occur twice or are empty; each comes with its key.
    pub(crate) fn unique_names<'n>(&mut self, names: impl Iterator<Item = (String, &'n str)>) {
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
    pub(crate) fn resolve(&self, file: &Path) -> PathBuf {
        self.base_dir.join(file)
    }

    /// Takes down what was read of a file that the case names: all `files` that belong to it, and
    /// what should be known about them.
    pub(crate) fn has_read(&mut self, key: &str, file: &Path, files: &[PathBuf], notes: &[String]) {
        files.iter().for_each(|path| self.hash_file(key, path));
        let named = |note: &String| format!("{}: {note}", file.display());
        self.notes.extend(notes.iter().map(named));
    }

    /// Adds a file that the case refers to, to the hash of the case.
    pub(crate) fn hash_file(&mut self, key: &str, path: &Path) {
        if let Err(error) = visit_bytes(path, |bytes| self.hash.update(bytes)) {
            self.mistake(key, error);
        }
    }
}
