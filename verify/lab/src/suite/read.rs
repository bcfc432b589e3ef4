//! The suite of a user's own cases: a TOML file that names them and what is asked of each.

use crate::lab::store::Source;
use crate::lab::sweep::{REFINEMENT, ReferenceSource};
use anyhow::{Context, Result};
use mtled_case::scene::{Diagnostic, Document, Override, deserialise, one_error, read_text};
use mtled_run::accuracy::{Group, ReferenceSolution};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The tables of the file.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SuiteFormat {
    /// Accepted figures, relative to the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub baseline: Option<PathBuf>,
    /// At least one.
    pub case: Vec<CaseFormat>,
}

/// One case of the file.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CaseFormat {
    /// The case file, relative to the suite.
    pub file: PathBuf,
    /// Other values under some keys, as with `--set`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<Override>,
    /// What errors are measured against, relative to the suite.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<PathBuf>,
    /// Warnings that are accepted.
    #[serde(default)]
    pub warnings: usize,
    /// Whether the affine patch test is run on the body with the recipe of the case.
    #[serde(default = "yes")]
    pub patch: bool,
    /// Largest error of each group over its largest value \[–\].
    #[serde(default)]
    pub error: BTreeMap<Group, f64>,
}

fn yes() -> bool {
    true
}

/// A suite with its cases and references, read and checked.
#[derive(Debug)]
pub struct Suite {
    /// Stem of the file name.
    pub name: String,
    /// The file as it was named.
    pub file: PathBuf,
    /// Accepted figures.
    pub baseline: Option<PathBuf>,
    /// In the order of the file.
    pub cases: Vec<SuiteCase>,
}

/// A case and what is asked of it.
#[derive(Debug)]
pub struct SuiteCase {
    /// The case.
    pub source: Arc<Source>,
    /// What errors are measured against.
    pub reference: Option<ReferenceSolution>,
    /// Largest error of each group over its largest value \[–\].
    pub errors: BTreeMap<Group, f64>,
    /// Warnings that are accepted.
    pub warnings: usize,
    /// Whether the affine patch test is run too.
    pub patch: bool,
}

impl Suite {
    /// Reads a suite, its cases and their references; mistakes are located.
    pub fn read(file: &Path) -> Result<Suite> {
        let (document, format) = parsed(file)?;
        let mistake = |diagnostic| one_error(vec![diagnostic]);
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut cases: Vec<SuiteCase> = Vec::new();
        for (index, case) in format.case.iter().enumerate() {
            let case = SuiteCase::read(case, index, folder, &document)?;
            let name = &case.source.name;
            if cases.iter().any(|other| other.source.name == *name) {
                let message = format!("there is another case {name}: names of files must differ");
                let key = format!("case[{index}].file");
                return Err(mistake(document.diagnostic(&key, message)));
            }
            cases.push(case);
        }
        let name = file.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into());
        let baseline = format.baseline.map(|path| folder.join(path));
        Ok(Suite { name, file: file.to_path_buf(), baseline, cases })
    }
}

impl Suite {
    /// The case files that a suite names, relative to it.
    pub fn files(file: &Path) -> Result<Vec<PathBuf>> {
        Ok(parsed(file)?.1.case.into_iter().map(|case| case.file).collect())
    }
}

/// The tables of a suite.
fn parsed(file: &Path) -> Result<(Document, SuiteFormat)> {
    let shown = file.display().to_string();
    let mistake = |diagnostic| one_error(vec![diagnostic]);
    let text = read_text(file).map_err(|error| {
        mistake(Diagnostic::of_file(
            &shown,
            format!(
                "cannot be read: {error}; the suites are quick, full, and files such as those that \
                 `mtled init` writes"
            ),
        ))
    })?;
    let document = Document::parse(&text, &shown).map_err(mistake)?;
    let format: SuiteFormat = deserialise(&document).map_err(mistake)?;
    if format.case.is_empty() {
        let message = "has no case: add a table [[case]] with a file".to_string();
        return Err(mistake(document.diagnostic("case", message)));
    }
    Ok((document, format))
}

impl SuiteCase {
    fn read(
        format: &CaseFormat,
        index: usize,
        folder: &Path,
        document: &Document,
    ) -> Result<SuiteCase> {
        let mistake = |key: &str, message: String| {
            one_error(vec![document.diagnostic(&format!("case[{index}].{key}"), message)])
        };
        let path = folder.join(&format.file);
        if !path.is_file() {
            return Err(mistake("file", format!("there is no file {}", path.display())));
        }
        let name = path.display().to_string();
        let source = Source::find(&name, folder, &format.set)?;
        let reference = match &format.reference {
            None => None,
            Some(reference) => {
                let stored = ReferenceSource::File(folder.join(reference)).stored(&source);
                stored.map_err(|error| {
                    let again = "`mtled init --references` makes those of finer runs again";
                    mistake("reference", format!("{error:#}; {again}"))
                })?
            }
        };
        for (group, bound) in &format.error {
            let key = format!("error.{}", group.name());
            if !(*bound > 0.0 && bound.is_finite()) {
                let message = format!("is {bound}; it must be positive, such as 0.02 for 2 %");
                return Err(mistake(&key, message));
            }
            match &reference {
                None => {
                    let message =
                        "an error needs a reference to be measured against: reference = …";
                    return Err(mistake(&key, message.into()));
                }
                Some(known) if !known.has(&source.case, *group) => {
                    let message = "the reference has nothing of this kind that is not zero";
                    return Err(mistake(&key, message.into()));
                }
                Some(_) => {}
            }
        }
        Ok(SuiteCase {
            source,
            reference,
            errors: format.error.clone(),
            warnings: format.warnings,
            patch: format.patch,
        })
    }

    /// Instants of the values of its runs \[s\].
    pub(crate) fn times(&self) -> Result<Vec<f64>> {
        match &self.reference {
            Some(reference) => Ok(reference.times.clone()),
            None => (ReferenceSource::Own(REFINEMENT).times(&self.source))
                .with_context(|| self.source.name.clone()),
        }
    }
}
