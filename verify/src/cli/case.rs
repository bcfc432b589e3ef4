//! `mtled case …`.

use super::common::{COULD_NOT_RUN, Common, Format};
use super::load::{SetArgs, located};
use super::messages::place;
use super::streams::{print_data, print_json, print_text};
use anyhow::{Result, bail};
use clap::Subcommand;
use mtled::Simulation;
use mtled_case::bundled::{CASES, TEMPLATES, Template};
use mtled_case::scene::{Diagnostic, Mistakes, Override, schema};
use mtled_checks::escape::printable;
use mtled_checks::report::write_atomically;
use mtled_run::run::{load, warnings};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(Debug, Subcommand)]
pub(crate) enum CaseCommand {
    /// Print a commented case to start from, or write it to a file.
    New {
        /// Kind of case; without one the kinds are listed.
        template: Option<String>,
        /// A file that is not there yet.
        #[arg(short, long, requires = "template")]
        out: Option<PathBuf>,
    },
    /// Report the mistakes in case files with file, line and key.
    Check {
        /// Case files, or names of bundled cases.
        #[arg(required = true)]
        files: Vec<PathBuf>,
        #[command(flatten)]
        set: SetArgs,
    },
    /// List the bundled cases.
    List,
    /// Print a bundled case.
    Show {
        /// Name of the case, as `mtled case list` prints it.
        name: String,
    },
    /// Print the JSON Schema of a case file.
    Schema,
}

pub(crate) fn case(command: &CaseCommand, common: &Common) -> Result<u8> {
    match command {
        CaseCommand::New { template: None, .. } => list_templates(common)?,
        CaseCommand::New { template: Some(name), out } => new(name, out.as_deref(), common)?,
        CaseCommand::Check { files, set } => return check(files, &set.overrides, common),
        CaseCommand::List => {
            let names: Vec<&str> = CASES.iter().map(|(name, _)| *name).collect();
            common.print_result(&|| Ok(format!("{}\n", json!(names))), &|| {
                names.iter().map(|name| format!("{name}\n")).collect()
            })?;
        }
        CaseCommand::Show { name } => match CASES.iter().find(|(bundled, _)| bundled == name) {
            Some((_, text)) => {
                let json = || Ok(format!("{}\n", json!({ "name": name, "text": text })));
                common.print_result(&json, &|| text.to_string())?;
            }
            None => {
                bail!("there is no bundled case \"{name}\"; `mtled case list` prints their names")
            }
        },
        CaseCommand::Schema => print_data(&format!("{}\n", schema()))?,
    }
    Ok(0)
}

fn list_templates(common: &Common) -> Result<()> {
    let json = || {
        let row =
            |template: &Template| json!({ "name": template.name, "purpose": template.purpose });
        Ok(format!("{:#}\n", TEMPLATES.iter().map(row).collect::<Value>()))
    };
    let line = |template: &Template| format!("{:<10}{}\n", template.name, template.purpose);
    common.print_result(&json, &|| TEMPLATES.iter().map(line).collect())
}

fn new(name: &str, out: Option<&Path>, common: &Common) -> Result<()> {
    let Some(template) = TEMPLATES.iter().find(|template| template.name == name) else {
        let names: Vec<&str> = TEMPLATES.iter().map(|template| template.name).collect();
        bail!("there is no template \"{name}\"; there are {}", names.join(", "))
    };
    let Some(file) = out else {
        let json = || Ok(format!("{}\n", json!({ "name": name, "text": template.text })));
        return common.print_result(&json, &|| template.text.to_string());
    };
    if file.exists() {
        bail!("{} is there already; give another name", file.display());
    }
    write_atomically(file, template.text.as_bytes())?;
    let shown = file.display().to_string();
    common.print_summary(&|| Ok(format!("{}\n", json!({ "written": shown }))), &|| {
        format!("written: {0}\nnext: mtled case check {0}\n", printable(&shown))
    })
}

/// What is known about a case file.
struct Checked<'a> {
    file: &'a Path,
    mistakes: Vec<Diagnostic>,
    warnings: Vec<String>,
}

/// Prints the mistakes of case files; in JSON they are the result.
fn check(files: &[PathBuf], overrides: &[Override], common: &Common) -> Result<u8> {
    let mut all = Vec::new();
    for file in files {
        let checked = examine(file, overrides)?;
        if common.format == Format::Human {
            checked.print(common)?;
        }
        all.push(checked);
    }
    if common.format == Format::Json {
        let cases: Vec<Value> = all.iter().map(Checked::to_json).collect();
        print_json(&format!("{:#}\n", json!({ "schema_version": 1, "cases": cases })))?;
    }
    let valid = all.iter().all(|checked| checked.mistakes.is_empty());
    Ok(if valid { 0 } else { COULD_NOT_RUN })
}

/// The mistakes of a case file. It is discretised, since empty selections and poor supports
/// show only then.
fn examine<'a>(file: &'a Path, overrides: &[Override]) -> Result<Checked<'a>> {
    let warnings = load(file, overrides).and_then(|case| match Simulation::new(&case.problem) {
        Ok(simulation) => Ok(warnings(&case, &simulation)),
        Err(error) => Err(located(&case, &error)),
    });
    match warnings {
        Ok(warnings) => Ok(Checked { file, mistakes: Vec::new(), warnings }),
        Err(error) => {
            let Mistakes(mistakes) = error.downcast()?;
            Ok(Checked { file, mistakes, warnings: Vec::new() })
        }
    }
}

impl Checked<'_> {
    fn print(&self, common: &Common) -> Result<()> {
        common.mistakes(&self.mistakes);
        if self.mistakes.is_empty() {
            let file = printable(&self.file.display().to_string());
            print_text(&format!("{file}: no mistakes\n"))?;
        }
        self.warnings.iter().for_each(|warning| common.warn_about(self.file, warning));
        Ok(())
    }

    fn to_json(&self) -> Value {
        let mistake = |mistake: &Diagnostic| {
            let mut object = place(mistake);
            object["message"] = mistake.message.clone().into();
            object
        };
        json!({
            "file": self.file.display().to_string(),
            "valid": self.mistakes.is_empty(),
            "mistakes": self.mistakes.iter().map(mistake).collect::<Vec<_>>(),
            "warnings": self.warnings,
        })
    }
}
