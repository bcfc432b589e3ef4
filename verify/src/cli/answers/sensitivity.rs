//! `mtled sensitivity`.

use crate::cli::common::{Common, INCONCLUSIVE, STOPPED};
use crate::cli::load::SetArgs;
use crate::cli::progress::progress_bar;
use anyhow::{Context, Result};
use clap::Args;
use mtled_checks::escape::printable;
use mtled_lab::lab::store::Source;
use mtled_lab::sensitivity::{Unmeasured, measure, to_json, to_text};
use mtled_run::run::{audit_doubts, ensure_fits};

#[derive(Debug, Args)]
pub(crate) struct SensitivityArgs {
    /// Case file (TOML), or name of a bundled case. Its solution is static, without friction.
    case: String,
    #[command(flatten)]
    set: SetArgs,
    /// An answer, such as force/top, the length of a vector, or displacement/middle.z, a component;
    /// may be repeated [default: the displacements of all probes, of lattices their mean, the
    /// forces of all supports and the strain energy].
    #[arg(long = "of", value_name = "ANSWER")]
    answers: Vec<String>,
    /// Solve the case again on both sides of each number, and show by how much the sensitivities
    /// differ from these differences, over their size.
    #[arg(long)]
    check: bool,
}

pub(crate) fn sensitivity(arguments: &SensitivityArgs, common: &Common) -> Result<u8> {
    let folder = tempfile::tempdir().context("cannot make a folder for a bundled case")?;
    let source = Source::find(&arguments.case, folder.path(), &arguments.set.overrides)?;
    ensure_fits(&source.case)?;
    let bar = progress_bar(common);
    let notify = |part: &str| bar.set_message(printable(part));
    let found = measure(&source, &arguments.answers, arguments.check, &notify);
    bar.finish_and_clear();
    let found = match found {
        Ok(found) => found,
        Err(Unmeasured::Stopped) => return Ok(STOPPED),
        Err(Unmeasured::Case(mistakes)) => return Err(mtled_case::scene::one_error(mistakes)),
        Err(reason) => return Err(reason.into()),
    };
    for doubt in source.case.notes.iter().chain(&found.doubts) {
        common.warn(doubt);
    }
    let doubts = audit_doubts(&found.audit);
    doubts.iter().for_each(|doubt| common.complain(doubt));
    common.print_result(&|| Ok(format!("{}\n", to_json(&found))), &|| to_text(&found))?;
    Ok(if doubts.is_empty() { 0 } else { INCONCLUSIVE })
}
