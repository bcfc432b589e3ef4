//! The baseline of `mtled verify`, and what a job of GitHub Actions is told.

use clap::Args;
use mtled_checks::gate::{
    Baseline, Clouds, GateError, Reason, compare, difference, read_baseline, update,
};
use mtled_checks::report::{github, read_report, write_atomically};
use mtled_checks::study::Report;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Where a baseline is written if nobody says where.
const BASELINE: &str = "reports/baseline.json";

#[derive(Debug, Args)]
pub struct GateArgs {
    /// Compare every check with this file; exit code 1 where one got worse or
    /// is missing.
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// Write the baseline anew from this run instead [default file:
    /// reports/baseline.json]; what is the same keeps its line.
    #[arg(long, requires = "reason")]
    update_baseline: bool,
    /// Why the figures may change, for whoever reads the diff.
    #[arg(long, value_name = "TEXT", requires = "update_baseline")]
    reason: Option<String>,
    /// Runs of the same code over other clouds (`mtled verify --seed`): their
    /// scatter makes the bands.
    #[arg(long, value_name = "RESULTS", num_args = 1.., requires = "update_baseline")]
    scatter: Vec<PathBuf>,
}

/// What is to be done with the baseline, read before a long run and not after.
#[derive(Debug)]
pub enum Gate {
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
    pub fn read(&self) -> anyhow::Result<Gate> {
        if !self.update_baseline {
            return match &self.baseline {
                Some(path) => Ok(Gate::Compare(read_baseline(path)?)),
                None => Ok(Gate::None),
            };
        }
        let path = self.baseline.clone().unwrap_or_else(|| BASELINE.into());
        let old = match read_baseline(&path) {
            Ok(baseline) => Some(baseline),
            Err(GateError::Absent { .. } | GateError::Version { .. }) => None,
            Err(error) => return Err(error.into()),
        };
        let reason = Reason::new(self.reason.as_deref().unwrap_or_default())?;
        let clouds: Vec<Report> =
            self.scatter.iter().map(|path| read_report(path)).collect::<Result<_, _>>()?;
        Clouds::new(&clouds)?;
        Ok(Gate::Update { path, old, reason, clouds, paths: self.scatter.clone() })
    }
}

impl Gate {
    /// Adds the comparison to the report; `whole` if all studies were run.
    pub fn judge(&self, report: &mut Report, whole: bool) -> Result<(), GateError> {
        if let Gate::Compare(baseline) = self {
            report.comparison = Some(compare(report, baseline, whole)?);
        }
        Ok(())
    }

    /// Writes the baseline where that was asked for; returns what changed in it.
    pub fn write(&self, report: &Report, whole: bool) -> anyhow::Result<Vec<String>> {
        let Gate::Update { path, old, reason, clouds, paths } = self else { return Ok(Vec::new()) };
        let scatter = Clouds::new(clouds)?;
        let new = update(report, old.as_ref(), &scatter, reason, whole)?;
        write_atomically(path, new.to_json().as_bytes())?;
        let mut lines = difference(old.as_ref(), &new);
        if !scatter.is_empty() {
            let (failing, alarms) = (scatter.failing(), scatter.left_out(report));
            for (suspects, words) in
                [(&failing, "breaks its bounds"), (&alarms, "is worse than the rest allow")]
            {
                lines.extend(suspects.iter().map(|suspect| {
                    let path = paths[suspect.run].display();
                    format!("{path} {words}: {}", suspect.checks.join(", "))
                }));
            }
            let (count, all) = (alarms.len(), scatter.runs());
            lines.push(format!(
                "{count} of {all} clouds, each left out in turn, are worse than the rest allow"
            ));
        }
        lines.push(format!("baseline: {}, {} checks", path.display(), new.checks.len()));
        Ok(lines)
    }
}

/// Annotations on standard error, and the summary where the job shows it.
pub fn tell_github(report: &Report, folder: &Path) -> anyhow::Result<()> {
    if std::env::var("GITHUB_ACTIONS").is_ok_and(|value| value == "true") {
        for line in github::annotations(report, folder) {
            eprintln!("{line}");
        }
    }
    let Some(path) = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|path| !path.is_empty()) else {
        return Ok(());
    };
    let written = std::fs::metadata(&path).map_or(0, |meta| meta.len() as usize);
    let room = github::SUMMARY_LIMIT.saturating_sub(written);
    let mut file = std::fs::OpenOptions::new().create(true).append(true).open(&path)?;
    file.write_all(github::step_summary(report, room).as_bytes())?;
    Ok(())
}
