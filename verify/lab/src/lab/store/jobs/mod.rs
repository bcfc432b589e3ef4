//! Runs that are performed elsewhere: files with some of them each, and the workflows that perform
//! the files, by Snakemake or as an array of Slurm jobs.

use super::disk::Store;
use super::task::{Job, Source, Task};
use anyhow::{Context, Result, bail};
use mtled_case::scene::{Override, Setting, read_text};
use mtled_checks::report::write_atomically;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Version of the layout of a part.
const SCHEMA_VERSION: u32 = 1;
const SNAKEFILE: &str = include_str!("Snakefile");
const SLURM_PROFILE: &str = include_str!("slurm.yaml");
const ARRAY: &str = include_str!("array.sbatch");

/// Where runs are planned instead of being performed.
#[derive(Debug, Clone)]
pub struct JobPlan {
    /// Folder of the parts and the workflows.
    pub folder: PathBuf,
    /// Into how many parts the runs are dealt, at most.
    pub parts: usize,
}

/// Runs have been planned, and nothing more can be done before they are performed.
#[derive(Debug, thiserror::Error)]
#[error(
    "{runs} runs are planned in {parts} parts: `snakemake -s {}/Snakefile -j 2` or `sbatch \
     {}/array.sbatch` performs them; then run this command again", folder.display(), folder.display()
)]
pub struct Planned {
    /// Runs that the store does not have.
    pub runs: usize,
    /// Files with some of them each.
    pub parts: usize,
    /// Folder of these files.
    pub folder: PathBuf,
}

/// Some runs, as a file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Part {
    schema_version: u32,
    runs: Vec<PlannedRun>,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlannedRun {
    /// Of its record, so that what has changed since is not run under its name.
    key: String,
    job: Job,
    /// Case file.
    case: PathBuf,
    overrides: Vec<Override>,
    settings: Vec<Setting>,
    times_s: Vec<f64>,
}

impl JobPlan {
    /// Removes the parts of an earlier plan, which are done or out of date.
    pub(crate) fn clear(&self) -> Result<()> {
        let Ok(entries) = std::fs::read_dir(&self.folder) else { return Ok(()) };
        for entry in entries {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let end = [".json", ".done", ".log"].iter().any(|end| name.ends_with(end));
            if name.starts_with("part-") && end {
                std::fs::remove_file(&path).with_context(|| path.display().to_string())?;
            }
        }
        Ok(())
    }

    /// Deals tasks that are not stored into parts and writes these with their workflows.
    pub(crate) fn write(&self, tasks: &[(String, &Task)], store: &Store) -> Result<Planned> {
        self.clear()?;
        std::fs::create_dir_all(store.folder())
            .with_context(|| format!("cannot make the store {}", store.folder().display()))?;
        let parts = self.parts.min(tasks.len()).max(1);
        for part in 0..parts {
            let own = tasks.iter().skip(part).step_by(parts);
            let runs = own.map(|(key, task)| planned(key, task)).collect::<Result<_>>()?;
            let text =
                serde_json::to_string_pretty(&Part { schema_version: SCHEMA_VERSION, runs })?;
            let file = self.folder.join(format!("part-{:04}.json", part + 1));
            write_atomically(&file, (text + "\n").as_bytes())?;
        }
        let store = store.folder().canonicalize()?.display().to_string();
        let snakefile = SNAKEFILE.replace("STORE", &serde_json::to_string(&store)?);
        let jobs = self.folder.canonicalize()?.display().to_string();
        let array = ARRAY
            .replace("PARTS", &parts.to_string())
            .replace("--store STORE", &format!("--store {}", quoted(&store)))
            .replace("--output=JOBS", &format!("--output={jobs}"))
            .replace("JOBS", &quoted(&jobs));
        for (name, text) in [
            ("Snakefile", snakefile.as_str()),
            ("slurm/config.yaml", SLURM_PROFILE),
            ("array.sbatch", &array),
        ] {
            write_atomically(&self.folder.join(name), text.as_bytes())?;
        }
        Ok(Planned { runs: tasks.len(), parts, folder: self.folder.clone() })
    }
}

/// A text as one word of a shell.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''"))
}

fn planned(key: &str, task: &Task) -> Result<PlannedRun> {
    let case = task.source.file.canonicalize();
    Ok(PlannedRun {
        key: key.to_string(),
        job: task.job,
        case: case.with_context(|| format!("cannot find {}", task.source.file.display()))?,
        overrides: task.source.case.overrides().to_vec(),
        settings: task.settings.clone(),
        times_s: task.times.clone(),
    })
}

/// The tasks of a part; refused where a case, or the program, is not what it was.
pub fn read_part(file: &Path) -> Result<Vec<Task>> {
    let shown = file.display();
    let text = read_text(file).with_context(|| format!("cannot read {shown}"))?;
    let part: Part = serde_json::from_str(&text)
        .with_context(|| format!("{shown} is not a part of planned runs"))?;
    if part.schema_version != SCHEMA_VERSION {
        bail!(
            "{shown} has schema version {}, this program reads {SCHEMA_VERSION}",
            part.schema_version
        );
    }
    let mut sources: HashMap<String, Arc<Source>> = HashMap::new();
    let mut tasks = Vec::new();
    for run in part.runs {
        let of = format!("{} {:?}", run.case.display(), run.overrides);
        let source = match sources.get(&of) {
            Some(source) => source.clone(),
            None => {
                let folder = run.case.parent().unwrap_or(Path::new("."));
                let found = Source::find(&run.case.display().to_string(), folder, &run.overrides)?;
                sources.entry(of).or_insert(found).clone()
            }
        };
        let task = Task { job: run.job, source, settings: run.settings, times: run.times_s };
        if task.key()? != run.key {
            bail!(
                "{shown}: {} is not what was planned: the case has changed since, or this is another \
                 version of mtled; plan the runs again",
                task.label()
            );
        }
        tasks.push(task);
    }
    Ok(tasks)
}
