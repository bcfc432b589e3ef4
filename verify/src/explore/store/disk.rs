//! Records in files.

use super::record::{RunRecord, SCHEMA_VERSION};
use mtled_checks::report::write_atomically;
use std::path::{Path, PathBuf};

/// A folder of records, `<first two digits of the key>/<key>.json`.
#[derive(Debug, Clone)]
pub struct Store {
    folder: PathBuf,
}

/// A record that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A file or folder cannot be read.
    #[error("{file} cannot be read: {source}")]
    Unreadable {
        /// Path of the file.
        file: String,
        /// What went wrong.
        source: std::io::Error,
    },
    /// A file is not a record of this program.
    #[error("{file} is not a record of a run ({reason}); remove it, or name another store")]
    NotARecord {
        /// Path of the file.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A record cannot be written.
    #[error("{0:#}")]
    Unwritable(anyhow::Error),
}

impl Store {
    /// The store in a folder, which need not exist yet.
    pub fn new(folder: &Path) -> Store {
        Store { folder: folder.to_path_buf() }
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn file(&self, key: &str) -> PathBuf {
        self.folder.join(&key[..2.min(key.len())]).join(format!("{key}.json"))
    }

    /// The record of a key, if there is one.
    pub fn find(&self, key: &str) -> Result<Option<RunRecord>, StoreError> {
        let file = self.file(key);
        if file.exists() { read(&file).map(Some) } else { Ok(None) }
    }

    /// Writes a record completely or not at all.
    pub fn write(&self, record: &RunRecord) -> Result<(), StoreError> {
        let text = serde_json::to_string(record).map_err(|e| StoreError::Unwritable(e.into()))?;
        write_atomically(&self.file(&record.key), (text + "\n").as_bytes())
            .map_err(StoreError::Unwritable)
    }

    /// Deletes a record.
    pub fn remove(&self, key: &str) -> Result<(), StoreError> {
        let file = self.file(key);
        std::fs::remove_file(&file).map_err(|error| unreadable(&file, error))
    }

    /// Every record, by key.
    pub fn all(&self) -> Result<Vec<RunRecord>, StoreError> {
        self.files(|name| name.ends_with(".json") && !name.starts_with('.'))?
            .iter()
            .map(|file| read(file))
            .collect()
    }

    /// Temporary files of programs that were killed.
    pub fn leftovers(&self) -> Result<Vec<PathBuf>, StoreError> {
        self.files(|name| name.starts_with('.') && name.ends_with(".tmp"))
    }

    fn files(&self, matches: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>, StoreError> {
        let mut files = Vec::new();
        for folder in entries(&self.folder)?.iter().filter(|path| has_records(path)) {
            let inside = entries(folder)?;
            files.extend(inside.into_iter().filter(|path| {
                path.file_name().and_then(|name| name.to_str()).is_some_and(&matches)
            }));
        }
        files.sort();
        Ok(files)
    }
}

/// Whether a folder is one of those with records.
fn has_records(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    path.is_dir() && name.len() == 2 && name.chars().all(|c| c.is_ascii_hexdigit())
}

/// Paths in a folder; none where it does not exist.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let listed = std::fs::read_dir(folder).map_err(|error| unreadable(folder, error))?;
    listed.map(|entry| entry.map(|e| e.path()).map_err(|e| unreadable(folder, e))).collect()
}

fn unreadable(file: &Path, source: std::io::Error) -> StoreError {
    StoreError::Unreadable { file: file.display().to_string(), source }
}

fn read(file: &Path) -> Result<RunRecord, StoreError> {
    let text = std::fs::read_to_string(file).map_err(|error| unreadable(file, error))?;
    let refused =
        |reason: String| StoreError::NotARecord { file: file.display().to_string(), reason };
    let record: RunRecord =
        serde_json::from_str(&text).map_err(|error| refused(error.to_string()))?;
    if record.schema_version != SCHEMA_VERSION {
        return Err(refused(format!(
            "its layout is {}, this program reads {SCHEMA_VERSION}",
            record.schema_version
        )));
    }
    Ok(record)
}
