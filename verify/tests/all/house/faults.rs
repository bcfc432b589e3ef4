//! Deliberate faults change what is in the source of the solver.

use std::path::{Path, PathBuf};
use toml_edit::DocumentMut;

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect()
}

#[test]
fn every_text_that_a_fault_replaces_is_in_the_source_once() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let files = [files("harness/faults"), files("harness/faults/cures")].concat();
    let mut changes = 0;
    for file in &files {
        let fault: DocumentMut = std::fs::read_to_string(file).unwrap().parse().unwrap();
        let Some(list) = fault.get("change").and_then(|change| change.as_array_of_tables()) else {
            continue;
        };
        for change in list {
            let text = |key: &str| change.get(key).and_then(|value| value.as_str()).unwrap_or("");
            let source = std::fs::read_to_string(root.join(text("file"))).unwrap();
            let wanted = [text("before"), text("text"), text("after")].concat();
            assert_eq!(source.matches(&wanted).count(), 1, "{}: {wanted}", file.display());
            changes += 1;
        }
    }
    assert!(files.len() > 30 && changes > 30, "{} files, {changes} changes", files.len());
}
