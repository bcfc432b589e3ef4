//! Records the commit and the compiler for the provenance of results, and a
//! fingerprint of the sources that decide the result of a run.

use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Of a packed crate, written by cargo: the commit it was packed from.
const PACKED_FROM: &str = ".cargo_vcs_info.json";
/// Digits of a commit that are recorded.
const DIGITS: usize = 12;

fn main() {
    let unknown = || "unknown".to_string();
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_string());
    let compiler = first_line(&rustc, &["--version"]).unwrap_or_else(unknown);
    let commit = packed_commit().or_else(checked_out_commit).unwrap_or_else(unknown);
    println!("cargo::rustc-env=MTLED_COMMIT={commit}");
    println!("cargo::rustc-env=MTLED_COMPILER={compiler}");
    println!("cargo::rustc-env=MTLED_SOURCES={:016x}", fingerprint());
    println!("cargo::rerun-if-changed=build.rs");
}

/// First line of what a program prints, if it succeeds.
fn first_line(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.lines().next().unwrap_or("").to_string())
}

fn packed_commit() -> Option<String> {
    let text = std::fs::read_to_string(PACKED_FROM).ok()?;
    println!("cargo::rerun-if-changed={PACKED_FROM}");
    let value = text.split_once("\"sha1\"")?.1.split('"').nth(1)?;
    value.get(..DIGITS).map(String::from)
}

/// The commit of the checkout that this file belongs to: a crate that was unpacked inside
/// another repository is none of its files.
fn checked_out_commit() -> Option<String> {
    first_line("git", &["ls-files", "--error-unmatch", "build.rs"])?;
    for file in ["HEAD", "logs/HEAD"] {
        let path = first_line("git", &["rev-parse", "--git-path", file])?;
        println!("cargo::rerun-if-changed={path}");
    }
    first_line("git", &["rev-parse", &format!("--short={DIGITS}"), "HEAD"])
}

/// Of the solver, of all that reads cases and makes records, which is everything here but the
/// command line, of what measures their figures, of the versions of dependencies, where they are
/// locked, and of what the compiler was told. DefaultHasher may
/// change with the compiler, which may change results too.
fn fingerprint() -> u64 {
    let variable = |name: &str| std::env::var(name).unwrap_or_else(|_| panic!("{name} is not set"));
    // From the build script of the solver that this build is linked with, wherever it lies.
    let solver = PathBuf::from(variable("DEP_MTLED_SOURCES"));
    let here = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    let (own, command_line) = (here.join("src"), here.join("src/cli"));
    // A packed crate has a lock file of its own.
    let locked = [here.join("../Cargo.lock"), here.join("Cargo.lock")];
    let mut hasher = DefaultHasher::new();
    // Beside a packed crate there is none: its version is locked.
    let measure = Some(here.join("checks/src/measure.rs")).filter(|file| file.is_file());
    let locked = locked.into_iter().find(|file| file.is_file());
    let folders = [solver, own].into_iter().chain(measure).chain(locked);
    options().iter().for_each(|option| hasher.write(option.as_bytes()));
    for folder in folders {
        println!("cargo::rerun-if-changed={}", folder.display());
        let decide = sources(&folder).into_iter().filter(|file| !file.starts_with(&command_line));
        for file in decide {
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
