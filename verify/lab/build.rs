//! A fingerprint of the sources that decide the result of a run.

use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rustc-env=MTLED_SOURCES={:016x}", fingerprint());
    println!("cargo::rerun-if-changed=build.rs");
}

/// Of the solver, of all that reads cases and makes records, of what measures their figures, of the
/// versions of dependencies, where they are locked, and of what the compiler was told. DefaultHasher
/// may change with the compiler, which may change results too.
fn fingerprint() -> u64 {
    let variable = |name: &str| std::env::var(name).unwrap_or_else(|_| panic!("{name} is not set"));
    // From the build script of the solver that this build is linked with, wherever it lies.
    let solver = PathBuf::from(variable("DEP_MTLED_SOURCES"));
    let here = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    // A packed crate has a lock file of its own.
    let locked = [here.join("../../Cargo.lock"), here.join("Cargo.lock")];
    let mut hasher = DefaultHasher::new();
    // Beside a packed crate there are none: their versions are locked.
    let beside = ["io/src", "case/src", "run/src", "checks/src/measure.rs"];
    let beside = beside.map(|path| here.join("..").join(path)).into_iter().filter(|p| p.exists());
    let locked = locked.into_iter().find(|file| file.is_file());
    let folders = [solver, here.join("src")].into_iter().chain(beside).chain(locked);
    options().iter().for_each(|option| hasher.write(option.as_bytes()));
    for folder in folders {
        println!("cargo::rerun-if-changed={}", folder.display());
        for file in sources(&folder) {
            let bytes = std::fs::read(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            // The same on checkouts with other line ends.
            hasher.write(&bytes.into_iter().filter(|byte| *byte != b'\r').collect::<Vec<u8>>());
        }
    }
    hasher.finish()
}

/// Features of this crate, which chooses those of the solver, the processor and its instructions,
/// and flags of the compiler.
fn options() -> Vec<String> {
    println!("cargo::rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    let decides = |name: &str| {
        let named =
            ["CARGO_CFG_TARGET_ARCH", "CARGO_CFG_TARGET_FEATURE", "CARGO_ENCODED_RUSTFLAGS"];
        name.starts_with("CARGO_FEATURE_") || named.contains(&name)
    };
    let mut options: Vec<String> = std::env::vars()
        .filter(|(name, _)| decides(name))
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    options.sort();
    options
}

/// All files below a folder, in the order of their names, or the file itself.
fn sources(folder: &Path) -> Vec<PathBuf> {
    if folder.is_file() {
        return vec![folder.to_path_buf()];
    }
    let entries = std::fs::read_dir(folder);
    let entries = entries.unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths.iter().flat_map(|path| sources(path)).collect()
}
