//! Reading a case file: syntax, keys and types, then what they mean.

use crate::scene::build::build;
use crate::scene::case::Case;
use crate::scene::deserialise::deserialise;
use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::Document;
use crate::scene::edit::Override;
use crate::scene::format::CaseFormat;
use mtled_checks::input::refuse_named_pipe;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Reads a case file and the files it refers to.
pub fn read_case(path: &Path) -> Result<Case, Vec<Diagnostic>> {
    read_overridden(path, &[])
}

/// As [`read_case`], with other values under some keys.
pub fn read_overridden(path: &Path, overrides: &[Override]) -> Result<Case, Vec<Diagnostic>> {
    let file = path.display().to_string();
    let text = read_text(path)
        .map_err(|error| vec![Diagnostic::of_file(&file, format!("cannot be read: {error}"))])?;
    parse_overridden(&text, &file, path.parent().unwrap_or(Path::new(".")), overrides)
}

/// The longest case file or plan that is read \[byte\]; its tables take a hundred times as much
/// memory.
const LONGEST: u64 = 1 << 24;

/// The text of a case file or plan, which may come from a pipe of a shell but must end.
pub fn read_text(path: &Path) -> io::Result<String> {
    refuse_named_pipe(path)?;
    let mut text = String::new();
    File::open(path)?.take(LONGEST + 1).read_to_string(&mut text)?;
    if text.len() as u64 <= LONGEST {
        Ok(text)
    } else {
        let reason = format!(
            "it has more than {LONGEST} bytes: put points into a file that it names \
                 (`points`), or leave some out"
        );
        Err(io::Error::new(io::ErrorKind::FileTooLarge, reason))
    }
}

/// Reads a case from text; other files are looked for from `base_dir`.
pub fn parse_case(text: &str, file_name: &str, base_dir: &Path) -> Result<Case, Vec<Diagnostic>> {
    parse_overridden(text, file_name, base_dir, &[])
}

/// As [`parse_case`], with other values under some keys.
pub fn parse_overridden(
    text: &str,
    file_name: &str,
    base_dir: &Path,
    overrides: &[Override],
) -> Result<Case, Vec<Diagnostic>> {
    let document =
        Document::overridden(text, file_name, overrides).map_err(|mistake| vec![mistake])?;
    let mistakes = document.numbers_that_are_not_finite();
    if !mistakes.is_empty() {
        return Err(mistakes);
    }
    let format: CaseFormat = deserialise(&document).map_err(|mistake| vec![mistake])?;
    build(&format, document, file_name, base_dir)
}

/// The tables of a case without mistakes, as they are written.
pub(crate) fn tables(case: &Case) -> Result<CaseFormat, Diagnostic> {
    deserialise(&Document::parse(case.text(), case.file())?)
}

/// The JSON Schema of a case file.
pub fn schema() -> String {
    let schema = schemars::schema_for!(CaseFormat);
    serde_json::to_string_pretty(&schema).unwrap_or_default()
}
