//! Records in files.

use super::record::{RunRecord, SCHEMA_VERSION};
use super::seal::{Seal, seal_of, sealed};
use super::task::KEY_DIGITS;
use mtled_checks::escape::printable_json;
use mtled_checks::report::write_atomically;
use mtled_checks::temporary::{abandoned, remove_abandoned};
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
    #[error("{} cannot be read: {source}", file.display())]
    Unreadable {
        /// Path of the file.
        file: PathBuf,
        /// What went wrong.
        source: std::io::Error,
    },
    /// A file is not a record of this program.
    #[error(
        "{} is not a record of a run ({reason}); `mtled runs prune --corrupt` removes it", file.display()
    )]
    NotARecord {
        /// Path of the file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A record of a version that wrote no checksums.
    #[error(
        "{} has no checksum: an earlier version wrote it, and a changed digit in it would not be \
         noticed; `mtled runs prune` removes it, and a study makes it again", file.display()
    )]
    NoChecksum {
        /// Path of the file.
        file: PathBuf,
    },
    /// A text is not the key of a record.
    #[error(
        "`{0}` is not the key of a record, which has {KEY_DIGITS} digits from 0 to 9 and a to f"
    )]
    NotAKey(String),
    /// A record cannot be written.
    #[error("{0:#}")]
    Unwritable(anyhow::Error),
}

/// What a store contains.
#[derive(Debug, Default)]
pub struct Contents {
    /// Every record that can be read, by key.
    pub records: Vec<RunRecord>,
    /// Files in the place of records that are none.
    pub corrupt: Vec<Corrupt>,
}

/// A file in the place of a record that is none.
#[derive(Debug)]
pub struct Corrupt {
    /// Its path.
    pub file: PathBuf,
    /// What is wrong with it.
    pub error: StoreError,
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

    /// Where the record of a key is; only a key leads to a file.
    fn file(&self, key: &str) -> Result<PathBuf, StoreError> {
        if is_key(key) {
            Ok(self.folder.join(&key[..2]).join(format!("{key}.json")))
        } else {
            Err(StoreError::NotAKey(key.to_string()))
        }
    }

    /// The record of a key, if there is one.
    pub fn find(&self, key: &str) -> Result<Option<RunRecord>, StoreError> {
        let file = self.file(key)?;
        if file.exists() { read(&file).map(Some) } else { Ok(None) }
    }

    /// Writes a record completely or not at all.
    pub fn write(&self, record: &RunRecord) -> Result<(), StoreError> {
        let file = self.file(&record.key)?;
        let text = serde_json::to_string(record).map_err(|e| StoreError::Unwritable(e.into()))?;
        let text = sealed(&printable_json(&text));
        write_atomically(&file, text.as_bytes()).map_err(StoreError::Unwritable)?;
        file.parent().into_iter().for_each(remove_abandoned);
        Ok(())
    }

    /// Deletes a record.
    pub fn remove(&self, key: &str) -> Result<(), StoreError> {
        let file = self.file(key)?;
        std::fs::remove_file(&file).map_err(|error| unreadable(&file, error))
    }

    /// Every record, and what is in the place of one.
    pub fn contents(&self) -> Result<Contents, StoreError> {
        let mut contents = Contents::default();
        for file in self.files(|name| name.ends_with(".json") && !name.starts_with('.'))? {
            match read(&file) {
                Ok(record) => contents.records.push(record),
                Err(error) => contents.corrupt.push(Corrupt { file, error }),
            }
        }
        Ok(contents)
    }

    /// Temporary files of programs that were killed, and none that is still written.
    pub fn leftovers(&self) -> Result<Vec<PathBuf>, StoreError> {
        let mut files = Vec::new();
        for folder in entries(&self.folder)?.iter().filter(|path| has_records(path)) {
            files.extend(abandoned(folder).map_err(|error| unreadable(folder, error))?);
        }
        Ok(files)
    }

    fn files(&self, matches: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>, StoreError> {
        let mut files = Vec::new();
        for folder in entries(&self.folder)?.iter().filter(|path| has_records(path)) {
            let inside = entries(folder)?;
            files.extend(inside.into_iter().filter(|path| matches(name_of(path))));
        }
        files.sort();
        Ok(files)
    }
}

impl Corrupt {
    /// Whether an earlier version wrote it, whose records have no checksum.
    pub fn is_old(&self) -> bool {
        matches!(self.error, StoreError::NoChecksum { .. })
    }

    /// The key in the name of the file; none where it was not meant to be a record.
    pub fn key(&self) -> Option<&str> {
        key_of(&self.file)
    }
}

fn is_key(text: &str) -> bool {
    text.len() == KEY_DIGITS && text.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f'))
}

/// The key of the record that belongs into a file.
fn key_of(file: &Path) -> Option<&str> {
    let key = name_of(file).strip_suffix(".json").filter(|key| is_key(key))?;
    (name_of(file.parent()?) == &key[..2]).then_some(key)
}

fn name_of(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

/// Whether a folder, which must not be a link to another place, is one of those with records.
fn has_records(path: &Path) -> bool {
    let name = name_of(path);
    let is_folder = path.symlink_metadata().is_ok_and(|meta| meta.is_dir());
    is_folder && name.len() == 2 && name.chars().all(|c| c.is_ascii_hexdigit())
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
    StoreError::Unreadable { file: file.to_path_buf(), source }
}

fn read(file: &Path) -> Result<RunRecord, StoreError> {
    let refused = |reason: String| StoreError::NotARecord { file: file.to_path_buf(), reason };
    let key = key_of(file).ok_or_else(|| refused("its name is not a key".into()))?;
    let bytes = std::fs::read(file).map_err(|error| unreadable(file, error))?;
    let text = String::from_utf8(bytes).map_err(|error| refused(error.to_string()))?;
    let record: RunRecord =
        serde_json::from_str(&text).map_err(|error| refused(error.to_string()))?;
    if record.schema_version != SCHEMA_VERSION {
        return Err(refused(format!(
            "its layout is {}, this program reads {SCHEMA_VERSION}",
            record.schema_version
        )));
    }
    if record.key != key {
        return Err(refused(format!("it has the key `{}`", record.key)));
    }
    match seal_of(&text) {
        Seal::Whole => Ok(record),
        Seal::Missing => Err(StoreError::NoChecksum { file: file.to_path_buf() }),
        Seal::Broken => Err(refused("its checksum is that of another content".into())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::store::record::Timings;
    use crate::lab::store::{Job, RunOutcome, Stage};

    const KEY: &str = "0123456789abcdef0123456789abcdef";

    fn record(key: &str) -> RunRecord {
        let (processor, date) = (String::new(), String::new());
        RunRecord {
            schema_version: SCHEMA_VERSION,
            key: key.into(),
            job: Job::Solve,
            case: "cube".into(),
            solver: "another".into(),
            overrides: Vec::new(),
            settings: Vec::new(),
            times_s: Vec::new(),
            outcome: RunOutcome::Failed { stage: Stage::Refused, reason: "none".into() },
            timings: Timings { set_up_cpu_s: 0.0, solve_cpu_s: 0.0, processor, date },
        }
    }

    fn put(folder: &Path, name: &str, key: &str) -> PathBuf {
        let file = folder.join(name);
        let text = sealed(&serde_json::to_string(&record(key)).unwrap());
        write_atomically(&file, text.as_bytes()).unwrap();
        file
    }

    #[test]
    fn only_a_key_leads_to_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(&folder.path().join("store"));
        let long = "é".repeat(16);
        for key in
            ["../../outside", "", "ab", "/etc/passwd", "é", long.as_str(), &KEY.to_uppercase()]
        {
            assert!(matches!(store.write(&record(key)), Err(StoreError::NotAKey(_))), "{key}");
            assert!(matches!(store.remove(key), Err(StoreError::NotAKey(_))), "{key}");
            assert!(matches!(store.find(key), Err(StoreError::NotAKey(_))), "{key}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        store.write(&record(KEY)).unwrap();
        assert_eq!(store.find(KEY).unwrap(), Some(record(KEY)));
        store.remove(KEY).unwrap();
        assert_eq!(store.find(KEY).unwrap(), None);
    }

    #[test]
    fn files_that_are_no_records_are_named_beside_the_records() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        put(path, &format!("01/{KEY}.json"), KEY);
        let renamed = put(path, "ab/ab23456789abcdef0123456789abcdef.json", "../../outside");
        let misplaced = put(path, &format!("02/{KEY}.json"), KEY);
        let other = put(path, "ab/notes.json", KEY);
        std::fs::write(path.join("ab/ab.json"), [0xff, 0xfe]).unwrap();
        let Contents { records, corrupt } = Store::new(path).contents().unwrap();
        assert_eq!(records, [record(KEY)]);
        let files: Vec<&Path> = corrupt.iter().map(|corrupt| corrupt.file.as_path()).collect();
        assert_eq!(files, [&misplaced, &path.join("ab/ab.json"), &renamed, &other]);
        let meant: Vec<bool> = corrupt.iter().map(|corrupt| corrupt.key().is_some()).collect();
        assert_eq!(meant, [false, false, true, false]);
        assert!(corrupt[2].error.to_string().contains("it has the key `../../outside`"));
    }

    #[test]
    fn a_changed_digit_is_noticed_and_a_record_without_a_checksum_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path());
        store.write(&record(KEY)).unwrap();
        let file = store.file(KEY).unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        let changed = text.replace("\"set_up_cpu_s\":0.0", "\"set_up_cpu_s\":1.0");
        assert_ne!(text, changed);
        std::fs::write(&file, changed).unwrap();
        let error = store.find(KEY).unwrap_err().to_string();
        assert!(error.contains("its checksum is that of another content"), "{error}");
        std::fs::write(&file, serde_json::to_string(&record(KEY)).unwrap()).unwrap();
        assert!(matches!(store.find(KEY), Err(StoreError::NoChecksum { .. })));
        let Contents { records, corrupt } = store.contents().unwrap();
        assert!(records.is_empty() && corrupt[0].is_old());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_inside_a_store_leads_nowhere() {
        let folder = tempfile::tempdir().unwrap();
        let (store, outside) = (folder.path().join("store"), folder.path().join("01"));
        put(&outside, &format!("{KEY}.json"), KEY);
        std::fs::create_dir(&store).unwrap();
        std::os::unix::fs::symlink(&outside, store.join("01")).unwrap();
        assert!(Store::new(&store).contents().unwrap().records.is_empty());
    }
}
