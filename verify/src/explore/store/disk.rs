//! Records on disk.

use super::record::{Record, SCHEMA_VERSION};
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
    #[error("{file} cannot be read: {source}")]
    Unreadable { file: String, source: std::io::Error },
    #[error("{file} is no record of a run ({reason}); remove it, or name another store")]
    NotARecord { file: String, reason: String },
    #[error("{0:#}")]
    Unwritable(anyhow::Error),
}

impl Store {
    pub fn new(folder: &Path) -> Store {
        Store { folder: folder.to_path_buf() }
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn file(&self, key: &str) -> PathBuf {
        self.folder.join(&key[..2.min(key.len())]).join(format!("{key}.json"))
    }

    /// The record of a key, if there is one.
    pub fn find(&self, key: &str) -> Result<Option<Record>, StoreError> {
        let file = self.file(key);
        if file.exists() { read(&file).map(Some) } else { Ok(None) }
    }

    /// Keeps a record, whole or not at all.
    pub fn keep(&self, record: &Record) -> Result<(), StoreError> {
        let text = serde_json::to_string(record).map_err(|e| StoreError::Unwritable(e.into()))?;
        write_atomically(&self.file(&record.key), (text + "\n").as_bytes())
            .map_err(StoreError::Unwritable)
    }

    /// Forgets a record.
    pub fn remove(&self, key: &str) -> Result<(), StoreError> {
        let file = self.file(key);
        std::fs::remove_file(&file).map_err(|error| unreadable(&file, error))
    }

    /// Every record, in the order of their keys.
    pub fn all(&self) -> Result<Vec<Record>, StoreError> {
        self.files(|name| name.ends_with(".json") && !name.starts_with('.'))?
            .iter()
            .map(|file| read(file))
            .collect()
    }

    /// What writers that were killed have left.
    pub fn leftovers(&self) -> Result<Vec<PathBuf>, StoreError> {
        self.files(|name| name.starts_with('.') && name.ends_with(".tmp"))
    }

    fn files(&self, wanted: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>, StoreError> {
        let mut found = Vec::new();
        for folder in entries(&self.folder)?.iter().filter(|path| is_shelf(path)) {
            let inside = entries(folder)?;
            found.extend(inside.into_iter().filter(|path| {
                path.file_name().and_then(|name| name.to_str()).is_some_and(&wanted)
            }));
        }
        found.sort();
        Ok(found)
    }
}

/// Whether a folder is one of those that hold records.
fn is_shelf(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    path.is_dir() && name.len() == 2 && name.chars().all(|c| c.is_ascii_hexdigit())
}

/// What a folder holds; nothing where there is none.
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

fn read(file: &Path) -> Result<Record, StoreError> {
    let text = std::fs::read_to_string(file).map_err(|error| unreadable(file, error))?;
    let refused =
        |reason: String| StoreError::NotARecord { file: file.display().to_string(), reason };
    let record: Record = serde_json::from_str(&text).map_err(|error| refused(error.to_string()))?;
    if record.schema_version != SCHEMA_VERSION {
        return Err(refused(format!(
            "layout {}, this program reads {SCHEMA_VERSION}",
            record.schema_version
        )));
    }
    Ok(record)
}
