//! Options that several commands share.

use crate::accuracy::Group;
use crate::explore::sweep::ReferenceSource;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct StoreArgs {
    /// Folder of the records; stored runs are not repeated.
    #[arg(long, default_value = "reports/runs", value_name = "DIR", help_heading = "Files")]
    pub store: PathBuf,
}

/// How errors are measured and where files go.
#[derive(Debug, Args)]
pub struct ErrorArgs {
    /// Reference solution: "any" (the bundled reference of the problem, else finer runs of the
    /// solver), "own" (finer runs of the solver), or a reference file.
    #[arg(long, alias = "truth", default_value = "any", value_name = "any|own|FILE")]
    reference: String,
    /// Quantities whose error is measured [default: the first that the case has].
    #[arg(long, value_enum)]
    pub quantity: Option<Group>,
    #[command(flatten)]
    pub store: StoreArgs,
    /// Folder for index.html, results.json and figures
    /// [default: reports/ and the name of the study or of the command and the case].
    #[arg(long, value_name = "DIR", help_heading = "Files")]
    out: Option<PathBuf>,
}

impl ErrorArgs {
    /// Where the reference solution comes from.
    pub fn reference(&self) -> ReferenceSource {
        match self.reference.as_str() {
            "any" => ReferenceSource::Any,
            "own" => ReferenceSource::Own,
            file => ReferenceSource::File(PathBuf::from(file)),
        }
    }

    /// Folder of the report, by default `path` below `reports`.
    pub fn out(&self, path: &[&str]) -> PathBuf {
        let preset =
            || path.iter().fold(Path::new("reports").to_path_buf(), |to, part| to.join(part));
        self.out.clone().unwrap_or_else(preset)
    }
}
