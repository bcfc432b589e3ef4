//! Messages on standard error: lines of text, or JSON objects.

use super::common::{Common, Format};
use super::streams::to_standard_error;
use mtled_case::scene::{Diagnostic, Mistakes};
use mtled_checks::escape::{printable_json, printable_lines};
use serde_json::{Map, Value, json};
use std::fmt::Display;
use std::path::Path;

impl Common {
    /// Reports progress or what was done, unless quiet.
    pub(crate) fn note(&self, text: &str) {
        if !self.quiet {
            self.message("note", text, text, None);
        }
    }

    /// Reports what the user should know, unless quiet.
    pub(crate) fn warn(&self, text: impl Display) {
        if !self.quiet {
            self.message("warning", &format!("warning: {text}"), &text.to_string(), None);
        }
    }

    /// As [`Self::warn`], about a file.
    pub(crate) fn warn_about(&self, file: &Path, text: impl Display) {
        if !self.quiet {
            let shown = format!("{}: warning: {text}", file.display());
            let place = json!({ "file": file.display().to_string() });
            self.message("warning", &shown, &text.to_string(), Some(place));
        }
    }

    /// Reports something that is wrong, also if quiet.
    pub(crate) fn complain(&self, text: impl Display) {
        self.message("error", &text.to_string(), &text.to_string(), None);
    }

    /// Reports the mistakes in a case file.
    pub(crate) fn mistakes(&self, mistakes: &[Diagnostic]) {
        for mistake in mistakes {
            let place = Some(place(mistake));
            self.message("error", &mistake.to_string(), &mistake.message, place);
        }
    }

    /// Reports the error that ends the program.
    pub(crate) fn failure(&self, error: &anyhow::Error) {
        let outermost = error.chain().next().and_then(|error| error.downcast_ref::<Mistakes>());
        let inner = error.chain().find_map(|error| error.downcast_ref::<Mistakes>());
        match (outermost, inner, self.format) {
            (Some(Mistakes(mistakes)), ..) => self.mistakes(mistakes),
            (None, Some(Mistakes(mistakes)), Format::Json) => {
                let around: Vec<String> = (error.chain())
                    .take_while(|error| !error.is::<Mistakes>())
                    .map(ToString::to_string)
                    .collect();
                for mistake in mistakes {
                    let text = format!("{}: {}", around.join(": "), mistake.message);
                    self.message("error", "", &text, Some(place(mistake)));
                }
            }
            _ => {
                let text = chain_text(error);
                self.message("error", &format!("error: {text}"), &text, None);
            }
        }
    }

    /// A line of text, or of JSON with the place of what it is about.
    fn message(&self, severity: &str, shown: &str, message: &str, place: Option<Value>) {
        match self.format {
            Format::Human => {
                to_standard_error(&printable_lines(shown));
            }
            Format::Json => {
                let mut object = Map::new();
                object.insert("severity".into(), severity.into());
                object.insert("message".into(), message.into());
                object.extend(
                    place.and_then(|place| place.as_object().cloned()).into_iter().flatten(),
                );
                to_standard_error(&printable_json(&Value::Object(object).to_string()));
            }
        }
    }
}

/// An error and its causes; a message that ends with its cause already is not followed by it.
pub(crate) fn chain_text(error: &anyhow::Error) -> String {
    error.chain().map(ToString::to_string).fold(String::new(), |text, cause| match text.as_str() {
        "" => cause,
        known if known.ends_with(&cause) => text,
        known => format!("{known}: {cause}"),
    })
}

/// File, line, column and key of a mistake; a mistake in a whole file has no line.
pub(crate) fn place(mistake: &Diagnostic) -> Value {
    let location = &mistake.location;
    let mut place = json!({ "file": location.file });
    if location.line > 0 {
        place["line"] = location.line.into();
        place["column"] = location.column.into();
    }
    if !mistake.key.is_empty() {
        place["key"] = mistake.key.clone().into();
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::anyhow;

    #[test]
    fn a_cause_is_told_once() {
        let told = anyhow!("plan.toml cannot be read: no such file");
        let cause = anyhow!("no such file").context("plan.toml cannot be read: no such file");
        assert_eq!(chain_text(&cause), chain_text(&told));
        let outer = cause.context("the plan cannot be used");
        assert_eq!(
            chain_text(&outer),
            "the plan cannot be used: plan.toml cannot be read: no such file"
        );
    }
}
