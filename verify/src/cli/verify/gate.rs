//! The baseline of `mtled verify`, and annotations for GitHub Actions.

use crate::cli::streams::command_to_standard_error;
use anyhow::Context;
use clap::Args;
use mtled_checks::escape::printable;
use mtled_checks::gate::{
    Baseline, Clouds, GateError, Reason, compare, difference, read_baseline, settle, update,
};
use mtled_checks::report::{ensure_writable, github, read_report, write_atomically};
use mtled_checks::study::Report;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The default file of the baseline.
const BASELINE: &str = "reports/baseline.json";

#[derive(Debug, Args)]
pub(crate) struct GateArgs {
    /// Compare every check with this file; exit code 1 if one got worse or is missing [default for a
    /// suite of your own: the baseline that it names].
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// Update the baseline from this run instead [default file: reports/baseline.json, or that
    /// of your own suite]; lines of unchanged checks stay as they are.
    #[arg(long, requires = "reason")]
    update_baseline: bool,
    /// Why the figures may change, for readers of the diff.
    #[arg(long, value_name = "TEXT", requires = "update_baseline")]
    reason: Option<String>,
    /// Runs of the same code on other node clouds (`mtled verify --seed`), whose scatter gives
    /// the bands. A suite of your own runs on some itself.
    #[arg(long, value_name = "RESULTS", num_args = 1.., requires = "update_baseline")]
    scatter: Vec<PathBuf>,
}

/// What to do with the baseline, which is read before a long run.
#[derive(Debug)]
pub(crate) enum Gate {
    None,
    Compare(Baseline),
    Update {
        path: PathBuf,
        old: Option<Baseline>,
        reason: Reason,
        clouds: Vec<Report>,
        paths: Vec<PathBuf>,
    },
}

impl GateArgs {
    /// What is to be done with a run of a suite, which may name a baseline itself.
    pub(crate) fn read(&self, suite: &str, named: Option<&Path>) -> anyhow::Result<Gate> {
        let named = self.baseline.as_deref().or(named);
        if !self.update_baseline {
            let Some(path) = named else { return Ok(Gate::None) };
            let baseline = read_baseline(path)?;
            baseline.check_suite(suite).with_context(|| path.display().to_string())?;
            return Ok(Gate::Compare(baseline));
        }
        let path = named.unwrap_or(Path::new(BASELINE)).to_path_buf();
        let old = match read_baseline(&path) {
            Ok(baseline) => Some(baseline),
            Err(GateError::Absent { .. } | GateError::Version { .. }) => None,
            Err(error) => return Err(error.into()),
        };
        // A baseline that cannot be written must not be discovered after a long run.
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        ensure_writable(folder.unwrap_or(Path::new(".")))?;
        let reason = Reason::new(self.reason.as_deref().unwrap_or_default())?;
        let clouds: Vec<Report> =
            self.scatter.iter().map(|path| read_report(path)).collect::<Result<_, _>>()?;
        Clouds::new(&clouds)?;
        Ok(Gate::Update { path, old, reason, clouds, paths: self.scatter.clone() })
    }
}

impl Gate {
    /// Whether a baseline is to be written whose bands need runs on other clouds.
    pub(crate) fn needs_clouds(&self) -> bool {
        matches!(self, Gate::Update { clouds, .. } if clouds.is_empty())
    }

    /// Takes the scatter from these runs on other clouds.
    pub(crate) fn with_clouds(self, runs: Vec<Report>) -> Gate {
        match self {
            Gate::Update { path, old, reason, .. } => {
                let paths = (1..=runs.len()).map(|n| format!("cloud {n}").into()).collect();
                Gate::Update { path, old, reason, clouds: runs, paths }
            }
            other => other,
        }
    }

    /// Adds the comparison to the report; `whole` means that all studies were run.
    pub(crate) fn judge(&self, report: &mut Report, whole: bool) -> Result<(), GateError> {
        match self {
            Gate::None => {}
            Gate::Compare(baseline) => {
                settle(report, baseline);
                report.comparison = Some(compare(report, baseline, whole)?);
            }
            // What is taken up is judged from now on; why it cannot be is said when it is written.
            Gate::Update { old, reason, clouds, .. } => {
                if let Ok(new) = update(report, old.as_ref(), &Clouds::new(clouds)?, reason, whole)
                {
                    settle(report, &new);
                }
            }
        }
        Ok(())
    }

    /// Updates the baseline on request; returns what changed in it.
    pub(crate) fn write(&self, report: &Report, whole: bool) -> anyhow::Result<Vec<String>> {
        let Gate::Update { path, old, reason, clouds, paths } = self else { return Ok(Vec::new()) };
        let scatter = Clouds::new(clouds)?;
        let new = update(report, old.as_ref(), &scatter, reason, whole)?;
        write_atomically(path, new.to_json().as_bytes())?;
        let mut lines = difference(old.as_ref(), &new);
        if !scatter.is_empty() {
            let (failing, alarms) = (scatter.failing(), scatter.left_out(report));
            for (suspects, reason) in
                [(&failing, "violates its bounds"), (&alarms, "is outside the bands of the others")]
            {
                lines.extend(suspects.iter().map(|suspect| {
                    let path = paths[suspect.run].display();
                    format!("{path} {reason}: {}", suspect.checks.join(", "))
                }));
            }
            let (count, all) = (alarms.len(), scatter.runs());
            lines.push(format!(
                "{count} of {all} cloud families are outside the bands of the others"
            ));
        }
        lines.push(format!("baseline: {}, {} checks", path.display(), new.checks.len()));
        Ok(lines)
    }
}

/// Writes annotations to standard error and the summary to the file that the job shows.
pub(crate) fn report_to_github(report: &Report, folder: &Path) -> anyhow::Result<()> {
    if std::env::var("GITHUB_ACTIONS").is_ok_and(|value| value == "true") {
        for line in github::annotations(report, folder) {
            command_to_standard_error(&printable(&line));
        }
    }
    let path = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|path| !path.is_empty());
    let Some(path) = path.map(PathBuf::from) else { return Ok(()) };
    let written = std::fs::metadata(&path).map_or(0, |meta| meta.len() as usize);
    let capacity = github::SUMMARY_LIMIT.saturating_sub(written);
    let mut file = std::fs::OpenOptions::new();
    let written = file
        .create(true)
        .append(true)
        .open(&path)
        .and_then(|mut file| file.write_all(github::step_summary(report, capacity).as_bytes()));
    written.with_context(|| format!("cannot write {}", path.display()))
}
