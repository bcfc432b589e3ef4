//! What a folder of results may contain at any moment.

use serde_json::Value;
use std::path::{Path, PathBuf};

/// The files of a run that nothing disturbed.
pub struct Calm {
    /// Its case file.
    pub case: String,
    folder: PathBuf,
    /// Of the body and of the nodes.
    pvds: [String; 2],
    result: Value,
}

impl Calm {
    /// The run of a case in its folder.
    pub fn read(folder: &Path, case: &str) -> Calm {
        let pvds = ["case.pvd", "case_nodes.pvd"]
            .map(|name| std::fs::read_to_string(folder.join(name)).unwrap());
        assert!(pvds.iter().all(|pvd| named(pvd).len() > 1), "{pvds:?}");
        let result = result(&folder.join("result.json"));
        Calm { case: case.to_string(), folder: folder.to_path_buf(), pvds, result }
    }
}

/// result.json without times.
fn result(path: &Path) -> Value {
    let mut result: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    result["timings"] = Value::Null;
    result
}

/// All files below a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        match entry.path() {
            path if path.is_dir() => all.extend(files(&path)),
            path => all.push(path),
        }
    }
    all
}

/// Files that a PVD names.
fn named(pvd: &str) -> Vec<&str> {
    pvd.split("file=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// Fails where a JSON file does not parse, where the PVD names a frame that is not there or of
/// another run, or where result.json is that of another run.
pub fn assert_whole(folder: &Path, runs: &[Calm]) {
    for file in files(folder) {
        let text = || std::fs::read_to_string(&file).unwrap();
        match file.extension().and_then(|extension| extension.to_str()) {
            Some("json") => {
                let parsed: Result<Value, _> = serde_json::from_str(&text());
                parsed.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
            }
            Some("pvd") => assert_frames(&file, &text(), runs),
            _ => {}
        }
    }
}

fn assert_frames(file: &Path, pvd: &str, runs: &[Calm]) {
    let folder = file.parent().unwrap();
    for name in named(pvd) {
        assert!(folder.join(name).exists(), "{} names {name}, which is not there", file.display());
    }
    if runs.is_empty() {
        return;
    }
    let run = runs.iter().find(|run| run.pvds.iter().any(|own| own == pvd));
    let run = run.unwrap_or_else(|| panic!("{} is of no run:\n{pvd}", file.display()));
    for name in named(pvd) {
        let same = std::fs::read(folder.join(name)).unwrap()
            == std::fs::read(run.folder.join(name)).unwrap();
        assert!(same, "{name} is not of the run that the PVD is of");
    }
    let path = folder.join("result.json");
    if path.exists() {
        assert!(result(&path) == run.result, "result.json is not of the run that the PVD is of");
    }
}
