//! The method book and the code refer to each other by names that exist.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Text of all Rust sources under a folder.
fn sources(folder: &Path, text: &mut String) {
    let mut entries: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            sources(&path, text);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            text.push_str(&std::fs::read_to_string(&path).unwrap());
            text.push_str(&format!("\n mod {};\n", path.file_stem().unwrap().display()));
        }
    }
}

/// Chapters of the method book, in the order of their first sections: name and text.
fn chapters(root: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(root.join("docs/method")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with(|c: char| c.is_ascii_digit()) && name.ends_with(".md") {
            found.push((name, std::fs::read_to_string(&path).unwrap()));
        }
    }
    found.sort();
    found
}

/// The folder of the solver.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../solver")
}

/// The text of all chapters and that of all sources.
fn solver() -> (String, String) {
    let mut text = String::new();
    sources(&root().join("src"), &mut text);
    let book: String = chapters(&root()).into_iter().map(|(_, chapter)| chapter + "\n").collect();
    (book, text)
}

fn words(text: &str) -> BTreeSet<&str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect()
}

/// Rows of the table of equations: number and what stands in backticks in its last column.
fn table(book: &str) -> Vec<(&str, Vec<&str>)> {
    let start = book.find("## 27 ").expect("the book has a table of equations");
    let section = book[start..].lines().skip(1).take_while(|line| !line.starts_with('#'));
    let rows = section.filter(|line| line.starts_with("| ")).skip(1);
    rows.map(|line| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        (cells[0], cells[cells.len() - 1].split('`').skip(1).step_by(2).collect())
    })
    .collect()
}

#[test]
fn every_name_in_the_table_of_equations_is_in_the_code() {
    let (book, code) = solver();
    let known = words(&code);
    let rows = table(&book);
    // Two follow from others.
    let named = rows.iter().filter(|(_, names)| !names.is_empty()).count();
    assert_eq!(named + 2, rows.len());
    for (equation, names) in rows {
        for part in names.iter().flat_map(|name| name.split("::")) {
            assert!(known.contains(part), "equation {equation}: {part} is not in the code");
        }
    }
}

#[test]
fn every_equation_that_the_code_cites_is_in_the_book() {
    let (book, code) = solver();
    let numbers: BTreeSet<&str> = table(&book).into_iter().map(|(number, _)| number).collect();
    let joined = code.replace("\n///", "").replace("\n//!", "").replace("\n    ///", "");
    let cited: Vec<&str> = joined
        .split("method book, eq. ")
        .skip(1)
        .map(|rest| rest.split(|c: char| !(c.is_ascii_digit() || c == '.')).next().unwrap())
        .map(|number| number.trim_end_matches('.'))
        .collect();
    assert!(cited.len() > 20, "{} citations", cited.len());
    for number in cited {
        assert!(numbers.contains(number), "the code cites equation {number}");
    }
}

#[test]
fn every_section_and_every_chapter_is_in_the_contents_and_in_the_documentation() {
    let contents = std::fs::read_to_string(root().join("docs/method.md")).unwrap();
    let modules = std::fs::read_to_string(root().join("src/method.rs")).unwrap();
    let mut numbers = Vec::new();
    for (name, chapter) in chapters(&root()) {
        assert!(modules.contains(&format!("../docs/method/{name}")), "no module for {name}");
        let stem = name.trim_end_matches(".md");
        for line in chapter.lines() {
            let Some(title) = line.strip_prefix("## ") else { continue };
            let number = title.split(' ').next().unwrap();
            let row = format!("| [{title}][section {number}] | [{stem}] |");
            assert!(contents.contains(&row), "the contents lack: {row}");
            numbers.push(number.parse::<usize>().unwrap());
        }
        let lines = chapter.lines().count();
        assert!(lines < 400, "{name} has {lines} lines");
    }
    numbers.sort_unstable();
    assert!(numbers.iter().copied().eq(1..=numbers.len()), "sections {numbers:?}");
}

#[test]
fn every_section_that_the_code_cites_is_in_the_book() {
    let (book, code) = solver();
    let joined = code.replace("\n///", "").replace("\n//!", "").replace("\n    ///", "");
    let cited = joined.split("method book, section ").skip(1);
    let numbers: BTreeSet<&str> =
        cited.map(|rest| rest.split(|c: char| !c.is_ascii_digit()).next().unwrap()).collect();
    assert!(numbers.len() > 10, "{} sections", numbers.len());
    for number in numbers {
        let heading = format!("\n## {number} ");
        assert!(book.contains(&heading), "the code cites section {number}");
    }
}
