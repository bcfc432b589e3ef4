//! What the program writes before anything is solved: commented cases, manual pages.

use crate::common::program::mtled;
use mtled_case::bundled::TEMPLATES;
use tempfile::TempDir;

#[test]
fn templates_have_no_mistakes_but_the_files_that_the_user_has() {
    let folder = TempDir::new().unwrap();
    for template in &TEMPLATES {
        let file = format!("{}.toml", template.name);
        assert_eq!(mtled(&folder, &["case", "new", template.name, "-o", &file]).0, 0);
        let (code, _, messages) = mtled(&folder, &["case", "check", &file]);
        let own = template.text.contains("file = ");
        assert_eq!(code, if own { 2 } else { 0 }, "{messages}");
        let mistakes = messages.lines().filter(|line| line.starts_with(&file));
        let others: Vec<&str> = mistakes
            .filter(|line| !line.contains("No such file") && !line.contains("needs a `file`"))
            .collect();
        assert!(others.is_empty(), "{others:?}");
    }
}

#[test]
fn a_template_is_not_written_over_a_file() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("mine.toml"), "precious").unwrap();
    let (code, _, message) = mtled(&folder, &["case", "new", "block", "--out", "mine.toml"]);
    assert_eq!(code, 2);
    assert!(message.contains("mine.toml is there already"), "{message}");
    assert_eq!(std::fs::read_to_string(folder.path().join("mine.toml")).unwrap(), "precious");
}

#[test]
fn without_a_template_all_are_listed_and_an_unknown_one_is_answered_with_their_names() {
    let folder = TempDir::new().unwrap();
    let (code, listed, _) = mtled(&folder, &["case", "new"]);
    assert_eq!((code, listed.lines().count()), (0, TEMPLATES.len()));
    let (code, _, message) = mtled(&folder, &["case", "new", "blok"]);
    assert_eq!(code, 2);
    assert!(TEMPLATES.iter().all(|template| message.contains(template.name)), "{message}");
}

#[test]
fn the_manual_has_a_page_of_the_program_and_one_of_every_command() {
    let folder = TempDir::new().unwrap();
    let (code, page, _) = mtled(&folder, &["man"]);
    assert!(code == 0 && page.contains(".TH mtled 1"), "{page}");
    assert_eq!(mtled(&folder, &["man", "--out", "pages"]).0, 0);
    for name in ["mtled.1", "mtled-solve.1", "mtled-case-new.1"] {
        assert!(folder.path().join("pages").join(name).is_file(), "{name}");
    }
}
