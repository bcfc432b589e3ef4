//! A folder for the input with sentinels around it.

use crate::mutate::Input;
use crate::target::Target;
use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Folder of the input, from the root of the sandbox.
const WORK: &str = "a/b/work";
/// Files that must stay as they are.
const SENTINELS: &[&str] = &[
    "x",
    "x.json",
    "a/x",
    "a/x.json",
    "a/b/x",
    "a/b/x.json",
    "a/b/x.svg",
    "a/b/.x.tmp",
    "outside/x",
    "outside/x.json",
    "a/b/work/x",
    "a/b/work/x.json",
    "a/b/work/x.svg",
];
/// Stands for the folder `outside` in inputs.
const OUTSIDE: &[u8] = b"@OUTSIDE@";

/// A temporary folder with the folder of the input three levels below.
#[derive(Debug)]
pub(crate) struct Sandbox {
    root: tempfile::TempDir,
    companions: Vec<(String, Vec<u8>)>,
}

/// Every path with size and time of the last change.
pub(crate) type Listing = BTreeMap<PathBuf, (u64, Option<SystemTime>)>;

impl Sandbox {
    /// A sandbox whose inputs lie beside `companions`, names and contents.
    pub(crate) fn new(companions: Vec<(String, Vec<u8>)>) -> Result<Sandbox> {
        let root = tempfile::Builder::new().prefix("mtled-fuzz").tempdir()?;
        for sentinel in SENTINELS {
            write(&root.path().join(sentinel), b"sentinel")?;
        }
        Ok(Sandbox { root, companions })
    }

    /// The folder of the input.
    pub(crate) fn work(&self) -> PathBuf {
        self.root.path().join(WORK)
    }

    /// A folder for what one child prints and for its temporary files.
    pub(crate) fn logs(&self) -> PathBuf {
        self.root.path().join(".logs")
    }

    /// A file for the messages of a worker.
    pub(crate) fn messages(&self) -> PathBuf {
        self.root.path().join(".messages")
    }

    /// Makes the folder anew with one input; returns its path from there.
    pub(crate) fn place(&self, target: Target, input: &Input) -> Result<String> {
        let work = self.work();
        remove(&work)?;
        remove(&self.logs())?;
        std::fs::create_dir_all(self.logs())?;
        for (name, bytes) in &self.companions {
            write(&work.join(name), bytes)?;
        }
        for sentinel in SENTINELS {
            let path = self.root.path().join(sentinel);
            if !path.exists() {
                write(&path, b"sentinel")?;
            }
        }
        let place = target.place(&input.extension);
        write(&work.join(&place), &target.sealed(self.with_paths(&input.bytes)))?;
        Ok(place)
    }

    /// The input with the path of the folder `outside`.
    fn with_paths(&self, bytes: &[u8]) -> Vec<u8> {
        let outside = self.root.path().join("outside");
        let mut new = bytes.to_vec();
        while let Some(at) = new.windows(OUTSIDE.len()).position(|window| window == OUTSIDE) {
            new.splice(
                at..at + OUTSIDE.len(),
                outside.as_os_str().as_encoded_bytes().iter().copied(),
            );
        }
        new
    }

    /// Everything but `excepted`, a path from the folder of the input.
    pub(crate) fn listing(&self, excepted: &str) -> Result<Listing> {
        let mut listing = Listing::new();
        let excepted = [self.work().join(excepted), self.logs(), self.messages()];
        list(self.root.path(), &excepted, &mut listing)?;
        Ok(listing)
    }

    /// A path that differs between two listings, from the root.
    pub fn difference(&self, before: &Listing, after: &Listing) -> Option<String> {
        let differs = |path: &&PathBuf| before.get(*path) != after.get(*path);
        let path = before.keys().chain(after.keys()).find(differs)?;
        let what = match (before.contains_key(path), after.contains_key(path)) {
            (true, true) => "changed",
            (true, false) => "removed",
            _ => "written",
        };
        let path = path.strip_prefix(self.root.path()).unwrap_or(path);
        Some(format!("{} was {what}", path.display()))
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

fn remove(folder: &Path) -> Result<()> {
    match std::fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error.into()),
        _ => Ok(()),
    }
}

/// Folders count too, without their times, which change with their entries.
fn list(folder: &Path, excepted: &[PathBuf], listing: &mut Listing) -> Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if excepted.contains(&path) {
            continue;
        }
        let data = std::fs::symlink_metadata(&path)?;
        if data.is_dir() {
            listing.insert(path.clone(), (0, None));
            list(&path, excepted, listing)?;
        } else {
            listing.insert(path, (data.len(), data.modified().ok()));
        }
    }
    Ok(())
}
