//! Reading a case file: syntax, keys and types, then what they mean.

use crate::scene::build::build;
use crate::scene::case::Case;
use crate::scene::deserialise::deserialise;
use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::Document;
use crate::scene::format::CaseFormat;
use crate::scene::migrate::outdated;
use std::path::Path;

/// Reads a case file and the files it refers to.
pub fn read_case(path: &Path) -> Result<Case, Vec<Diagnostic>> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|error| vec![Diagnostic::of_file(&file, format!("cannot be read: {error}"))])?;
    parse_case(&text, &file, path.parent().unwrap_or(Path::new(".")))
}

/// Reads a case from text; other files are looked for from `base_dir`.
pub fn parse_case(text: &str, file_name: &str, base_dir: &Path) -> Result<Case, Vec<Diagnostic>> {
    let document = Document::parse(text, file_name).map_err(|mistake| vec![mistake])?;
    for mistakes in [document.numbers_that_are_not_finite(), outdated(&document)] {
        if !mistakes.is_empty() {
            return Err(mistakes);
        }
    }
    let format = deserialise(&document).map_err(|mistake| vec![mistake])?;
    build(&format, document, file_name, base_dir)
}

/// The JSON Schema of a case file.
pub fn schema() -> String {
    let schema = schemars::schema_for!(CaseFormat);
    serde_json::to_string_pretty(&schema).unwrap_or_default()
}
