//! The plan of the house: which module may import which, how large files and folders may
//! be, and what the solver must not know.

use super::imports::imports;
use super::rules::{circles, downward_imports};
use super::tokens::tokens;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Source folders of the crates.
const CRATES: [&str; 12] = [
    "solver/src",
    "verify/checks/src",
    "verify/io/src",
    "verify/case/src",
    "verify/run/src",
    "verify/metamorphic/src",
    "verify/harness/src",
    "verify/lab/src",
    "verify/src",
    "verify/fuzz/src",
    "verify/python/src",
    "benches/src",
];
/// Programs of their own for those who work here.
const MAY_PRINT: [&str; 3] = ["verify/metamorphic/src", "verify/fuzz/src", "benches/src"];
/// Crates that stand on the solver.
const HARNESS: [&str; 6] =
    ["mtled_io", "mtled_case", "mtled_run", "mtled_harness", "mtled_lab", "mtled_verify"];
const MOST_FILES: usize = 15;
const MOST_LINES: usize = 400;
/// Lines of a function.
const LONGEST_FUNCTION: usize = 60;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Files below a folder of the repository whose names have one of some extensions.
fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if !name.starts_with('.') && !name.starts_with("target") && name != "__pycache__" {
                found.extend(files(&path, extensions));
            }
        } else if path.extension().is_some_and(|e| extensions.contains(&e.to_str().unwrap())) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Files of a crate with their paths from its source folder.
fn sources(folder: &str) -> Vec<(String, String)> {
    let src = root().join(folder);
    let name = |path: &Path| path.strip_prefix(&src).unwrap().display().to_string();
    files(&src, &["rs"]).iter().map(|path| (name(path), read(path))).collect()
}

fn none(found: Vec<String>) {
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn imports_make_no_circle_between_the_entries_of_any_folder() {
    let mut found = Vec::new();
    for folder in CRATES {
        let imports = imports(&sources(folder));
        assert!(folder == "benches/src" || imports.len() > 10, "{folder}: no imports were read");
        found.extend(circles(&imports).iter().map(|circle| format!("{folder}: {circle}")));
    }
    none(found);
}

#[test]
fn no_room_imports_one_that_stands_further_down() {
    let downward = |folder: &&str| {
        downward_imports(&read(&root().join(folder).join("lib.rs")), &imports(&sources(folder)))
    };
    none(CRATES.iter().flat_map(downward).collect());
}

/// Files of a crate that have one of some tokens.
fn naming(folder: &str, words: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for (path, text) in sources(folder) {
        let tokens = tokens(&text);
        let named = tokens.iter().find(|token| words.contains(&token.as_str()));
        found.extend(named.map(|word| format!("{folder}/{path} has {word}")));
    }
    found
}

#[test]
fn the_solver_does_not_print_and_does_not_know_the_harness() {
    let printing = ["print", "println", "eprint", "eprintln", "dbg"];
    none(naming("solver/src", &[&printing[..], &HARNESS, &["mtled_checks"]].concat()));
}

#[test]
fn nothing_prints_with_macros_that_end_the_program_where_a_stream_cannot_be_written() {
    let printing = ["print", "println", "eprint", "eprintln", "dbg"];
    let mut found = Vec::new();
    for folder in CRATES.iter().filter(|folder| !MAY_PRINT.contains(folder)) {
        for (path, text) in sources(folder) {
            let tokens = tokens(&text);
            let call = |pair: &[String]| printing.contains(&pair[0].as_str()) && pair[1] == "!";
            found.extend(tokens.windows(2).any(call).then(|| format!("{folder}/{path} prints")));
        }
    }
    none(found);
}

#[test]
fn checks_and_reports_know_no_mechanics() {
    none(naming("verify/checks/src", &[&["mtled"], &HARNESS[..]].concat()));
}

#[test]
fn no_folder_has_more_than_15_files_and_no_file_more_than_400_lines() {
    let python = ["reference/mtled_reference", "verify/python/mtled", "verify/python/tests"];
    let mut found = Vec::new();
    for (folder, extension) in
        CRATES.map(|folder| (folder, "rs")).into_iter().chain(python.map(|f| (f, "py")))
    {
        let mut counts: BTreeMap<PathBuf, usize> = BTreeMap::new();
        for path in files(&root().join(folder), &[extension]) {
            *counts.entry(path.parent().unwrap().to_path_buf()).or_default() += 1;
            let lines = read(&path).lines().count();
            if lines > MOST_LINES {
                found.push(format!("{} has {lines} lines", path.display()));
            }
        }
        let large = counts.iter().filter(|(_, count)| **count > MOST_FILES);
        found
            .extend(large.map(|(folder, count)| format!("{} has {count} files", folder.display())));
    }
    none(found);
}

#[test]
fn every_function_fits_on_a_screen() {
    let mut found = Vec::new();
    for folder in CRATES {
        for (name, text) in sources(folder) {
            let lines: Vec<&str> = text.lines().collect();
            for (start, line) in lines.iter().enumerate() {
                let code = line.trim_start();
                let after = ["pub ", "pub(crate) ", "pub(super) ", "const ", "unsafe "]
                    .iter()
                    .fold(code, |code, word| code.strip_prefix(word).unwrap_or(code));
                if !after.starts_with("fn ") {
                    continue;
                }
                let end = format!("{}}}", &line[..line.len() - code.len()]);
                let length = lines[start..].iter().position(|line| *line == end).unwrap_or(0) + 1;
                if length > LONGEST_FUNCTION {
                    found.push(format!("{folder}/{name}:{}: {length} lines", start + 1));
                }
            }
        }
    }
    none(found);
}

#[test]
fn nothing_is_cited_that_is_not_there() {
    // In parts, since this file is read too.
    let phrases =
        [["method", " §"], ["the", " issue"], ["the", " seed"]].map(|parts| parts.concat());
    let mut found = Vec::new();
    for path in files(&root(), &["rs", "py", "toml", "md"]) {
        if path.ends_with("CHANGELOG.md") {
            continue;
        }
        for (number, line) in read(&path).lines().enumerate() {
            let line = line.to_lowercase();
            let phrase = phrases.iter().find(|phrase| line.contains(phrase.as_str()));
            found.extend(phrase.map(|p| format!("{}:{}: {p}", path.display(), number + 1)));
        }
    }
    none(found);
}

/// Circles of a made-up crate.
fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    circles(&imports(&made_up(files)))
}

fn made_up(files: &[(&str, &str)]) -> Vec<(String, String)> {
    files.iter().map(|(path, text)| (path.to_string(), text.to_string())).collect()
}

#[test]
fn a_circle_of_files_is_found_and_described() {
    let files = [
        ("lib.rs", "pub mod room;"),
        ("room/mod.rs", "mod a;\nmod b;"),
        ("room/a.rs", "use super::b::{B, More};\npub struct A;"),
        ("room/b.rs", "use crate::room::a::A;\npub struct B;"),
    ];
    let found = circles_of(&files);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("circle in room: a, b\n    room::a -> room::b"), "{}", found[0]);
}

#[test]
fn a_facade_with_reexports_is_no_circle_but_one_with_definitions_is() {
    let facade = |own: &'static str| {
        [
            ("room/mod.rs", own),
            ("room/a.rs", "pub struct A;"),
            ("room/b.rs", "use super::{A as Other, c::*};\npub struct B(Other);"),
            ("room/c.rs", "use crate::room::A;"),
        ]
    };
    let reexporting = "mod a; mod b; mod c;\npub use a::A;\npub use b::{B};";
    assert_eq!(circles_of(&facade(reexporting)), Vec::<String>::new());
    let defining = "mod b; mod c;\npub use b::B;\npub struct A;";
    assert!(circles_of(&facade(defining))[0].starts_with("circle in room: b, c, mod"));
}

#[test]
fn paths_in_expressions_and_types_count_and_circles_of_folders_are_found() {
    let files = [
        ("one/mod.rs", "pub mod inner;"),
        ("one/inner.rs", "fn f() -> crate::two::T { super::super::two::make() }"),
        ("two/mod.rs", "pub mod deep;\npub struct T;\npub fn make() -> T { deep::g() }"),
        ("two/deep.rs", "pub fn g() { let x = crate::one::inner::f(); }"),
    ];
    let found = circles_of(&files);
    assert!(
        found.iter().any(|circle| circle.starts_with("circle in the crate: one, two")),
        "{found:?}"
    );
}

#[test]
fn comments_literals_and_test_modules_do_not_count() {
    let a = "// use crate::b::B;\n/* crate::b::B /* crate::b */ */\n\
             const S: &str = \"crate::b::B \\\" crate::b::B\";\nconst R: &str = r#\"crate::b::B\"#;\n\
             const C: [char; 2] = ['\"', '\\''];\n#[cfg(test)]\nmod tests {\n    use crate::b::B;\n}\n\
             fn g<'a>(x: &'a str) -> &'a str { x }";
    let files = [("a.rs", a), ("b.rs", "use crate::a::S;"), ("a_tests.rs", "use crate::b::B;")];
    assert_eq!(circles_of(&files), Vec::<String>::new());
    let after = format!("{a}\nfn f() {{ crate::b::h(); }}");
    assert_eq!(circles_of(&[("a.rs", &after), files[1]]).len(), 1);
}

#[test]
fn an_import_from_a_room_further_down_is_reported() {
    let files = made_up(&[("low.rs", "use crate::{high::H, own};"), ("high.rs", "pub struct H;")]);
    let lib = |first: &str, second: &str| format!("//! Rooms.\npub mod {first};\nmod {second};\n");
    assert_eq!(downward_imports(&lib("high", "low"), &imports(&files)), Vec::<String>::new());
    let found = downward_imports(&lib("low", "high"), &imports(&files));
    assert_eq!(found, ["low imports high, which stands further down"]);
}
