//! Case files: one TOML file states one problem; every mistake in it is
//! reported with file, line, column, key and what was expected.

mod build;
mod case;
mod deserialise;
mod diagnostic;
mod document;
mod edit;
pub(crate) mod format;
mod key_path;
mod knob;
mod nearest;
mod problem_hash;
mod read;

pub use case::{Case, Probe, ProbeKind};
pub use deserialise::deserialise;
pub use diagnostic::{Diagnostic, Mistakes, one_error};
pub use document::Document;
pub use edit::{EditError, NotAnOverride, Override, edited, with_absolute_paths, with_paths_from};
pub use knob::{Knob, Level, Levels, Setting};
pub use nearest::nearest;
pub use problem_hash::problem_hash;
pub(crate) use read::tables;
pub use read::{parse_case, parse_overridden, read_case, read_overridden, read_text, schema};
