//! The method book and the code refer to each other by names that exist.

use std::collections::BTreeSet;
use std::path::Path;

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

fn solver() -> (String, String) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../solver");
    let mut text = String::new();
    sources(&root.join("src"), &mut text);
    (std::fs::read_to_string(root.join("docs/method.md")).unwrap(), text)
}

fn words(text: &str) -> BTreeSet<&str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect()
}

/// Rows of the table of equations: number and what stands in backticks in its last column.
fn table(book: &str) -> Vec<(&str, Vec<&str>)> {
    let start = book.find("## 27 ").expect("the book ends with its table of equations");
    let rows = book[start..].lines().filter(|line| line.starts_with("| ")).skip(1);
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
