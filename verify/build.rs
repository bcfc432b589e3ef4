//! Records the commit and the compiler for the provenance of results.

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
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../.git/HEAD");
    println!("cargo::rerun-if-changed=../.git/logs/HEAD");
}
