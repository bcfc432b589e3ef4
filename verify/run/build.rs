//! Records the commit and the compiler for the provenance of results.

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
