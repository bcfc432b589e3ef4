//! Records the commit and the compiler for the provenance of results, and a
//! fingerprint of the sources that decide the result of a run.

use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    let first_line = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.lines().next().unwrap_or("").to_string())
    };
    let unknown = || "unknown".to_string();
    let commit = first_line("git", &["rev-parse", "--short=12", "HEAD"]).unwrap_or_else(unknown);
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_string());
    let compiler = first_line(&rustc, &["--version"]).unwrap_or_else(unknown);
    println!("cargo::rustc-env=MTLED_COMMIT={commit}");
    println!("cargo::rustc-env=MTLED_COMPILER={compiler}");
    println!("cargo::rustc-env=MTLED_SOURCES={:016x}", fingerprint());
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../.git/HEAD");
    println!("cargo::rerun-if-changed=../.git/logs/HEAD");
}

/// Of the solver and of what reads cases and makes records. DefaultHasher may change
/// with the compiler, which may change results too.
fn fingerprint() -> u64 {
    let here = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default());
    let mut hasher = DefaultHasher::new();
    for folder in
        ["../solver/src", "src/accuracy", "src/files", "src/run", "src/scene", "src/explore/store"]
    {
        println!("cargo::rerun-if-changed={folder}");
        for file in sources(&here.join(folder)) {
            hasher.write(&std::fs::read(&file).unwrap_or_default());
        }
    }
    hasher.finish()
}

/// All files below a folder, in the order of their names.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let below = |path: PathBuf| if path.is_dir() { sources(&path) } else { vec![path] };
    paths.into_iter().flat_map(below).collect()
}
