//! The error bars of `mtled solve` against errors that are known.

mod answers;
mod subjects;
mod tables;

use crate::studies::error_bars::answers::{Answered, answered};
use crate::studies::error_bars::subjects::{Set, plans};
use crate::studies::error_bars::tables::{
    Counts, SETS, answers_table, cost_table, counts_table, figure,
};
use crate::studies::workbench::Workbench;
use anyhow::{Context, Result};
use mtled_checks::study::{Bound, Check, Figure, Kind, Study};
use rayon::prelude::*;

/// What is wanted of the fraction of errors within their bars \[–\].
const WITHIN: f64 = 0.9;
/// What is wanted of the fraction of bars within a factor of 3 of their error \[–\].
const USEFUL: f64 = 0.8;
/// What is wanted of the work for the bars over that of the run \[–\].
const COST: f64 = 0.3;

/// Solves every subject with its error bars and counts how often they hold.
pub fn error_bars(bench: &Workbench, study: &mut Study) -> Result<()> {
    let solve = |plan: &subjects::Plan| -> Result<Option<Answered>> {
        let Some(subject) = plan.subject(bench)? else { return Ok(None) };
        answered(&subject).map(Some).with_context(|| subject.name.clone())
    };
    let plans = plans(bench);
    let all: Vec<Answered> = plans
        .par_iter()
        .with_max_len(1)
        .map(solve)
        .filter_map(Result::transpose)
        .collect::<Result<Vec<_>>>()?;
    add_checks(study, &all);
    study.tables.extend([counts_table(&all), cost_table(&all), answers_table(&all)]);
    study.figures.push(Figure::Plot(figure(&all)));
    study.notes.extend(NOTES.map(String::from));
    Ok(())
}

const NOTES: [&str; 1] = ["TODO"];

fn add_checks(study: &mut Study, all: &[Answered]) {
    for (set, id, label) in SETS {
        let counts = Counts::of(all, &|s, _| s == set);
        for (what, claim, value, bound) in [
            ("within", "errors within their bars", counts.within(), WITHIN),
            ("useful", "bars within a factor of 3 of the error", counts.useful(), USEFUL),
        ] {
            study.checks.push(Check::new(
                &format!("error_bars/{id}/{what}"),
                &format!("{label}: {claim}, fraction of {}", counts.judged),
                Kind::Reference,
                value,
                Bound::AtLeast(bound),
                "1",
                "",
            ));
        }
    }
    let bundled = all.iter().filter(|subject| subject.set == Set::Bundled);
    let work = bundled.map(|subject| subject.work).fold(0.0, f64::max);
    study.checks.push(Check::new(
        "error_bars/work",
        "bundled cases: neighbours visited for the bars over those of the run, largest",
        Kind::Exact,
        work,
        Bound::AtMost(COST),
        "1",
        "at most 30 % of the run is wanted",
    ));
}
