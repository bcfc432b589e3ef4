//! Nothing imports upward, and no room is too large to know.

use std::path::{Path, PathBuf};

/// Rust files under a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// Modules of a crate in the order of its `lib.rs`.
fn floors(src: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(src.join("lib.rs")).unwrap();
    let modules = text.lines().filter_map(|line| line.strip_prefix("pub mod "));
    modules.map(|module| module.trim_end_matches(';').to_string()).collect()
}

/// The top-level module that a file belongs to.
fn module_of(src: &Path, file: &Path) -> String {
    let inside = file.strip_prefix(src).unwrap();
    let first = inside.components().next().unwrap().as_os_str().to_string_lossy().into_owned();
    first.trim_end_matches(".rs").to_string()
}

/// Imports of `crate::module` that stand below the importing module.
fn upward_imports(src: &Path) -> Vec<String> {
    let floors = floors(src);
    let floor = |module: &str| floors.iter().position(|known| known == module);
    let mut found = Vec::new();
    for file in sources(src) {
        let Some(own) = floor(&module_of(src, &file)) else { continue };
        let text = std::fs::read_to_string(&file).unwrap();
        for line in text.lines().take_while(|line| !line.starts_with("#[cfg(test)]")) {
            let Some(path) = line.split("crate::").nth(1) else { continue };
            let module: String =
                path.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if floor(&module).is_some_and(|other| other > own) {
                found.push(format!("{}: {}", file.display(), line.trim()));
            }
        }
    }
    found
}

fn crates() -> [PathBuf; 2] {
    let verify = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    [verify.join("../solver/src"), verify.join("src")]
}

#[test]
fn nothing_imports_upward() {
    let found: Vec<String> = crates().iter().flat_map(|src| upward_imports(src)).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn the_solver_does_not_print_and_does_not_know_the_harness() {
    for file in sources(&crates()[0]) {
        let text = std::fs::read_to_string(&file).unwrap();
        for word in ["println!", "eprintln!", "mtled_verify"] {
            assert!(!text.contains(word), "{} has {word}", file.display());
        }
    }
}

#[test]
fn no_file_is_longer_than_400_lines() {
    for file in crates().iter().flat_map(|src| sources(src)) {
        let lines = std::fs::read_to_string(&file).unwrap().lines().count();
        assert!(lines <= 400, "{} has {lines} lines", file.display());
    }
}
