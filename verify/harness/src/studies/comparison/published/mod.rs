//! Problems of others with their numbers, beside ours.

mod answers;
pub mod numbers;
mod runs;
mod tables;

use self::answers::answer;
use self::numbers::{By, Number, Problem, case, problems, unpack};
use self::runs::{Plan, Solved, solved};
use self::tables::{Row, costs_table, numbers_table, sources_table};
use crate::studies::workbench::{Suite, Workbench, relative_error};
use anyhow::{Context, Result};
use mtled_checks::study::{Bound, Check, Kind, Study};
use mtled_run::machine::on_threads;
use mtled_run::specimens::spacing::{respaced, spacing_of};
use rayon::prelude::*;

/// Solves every problem at the spacing of its cases, in the full suite at three.
pub(crate) fn published(bench: &Workbench, study: &mut Study) -> Result<()> {
    let folder = tempfile::tempdir()?;
    unpack(folder.path())?;
    let problems = problems()?;
    let mut plans = Vec::new();
    for (published, problem) in &problems {
        for of in &problem.cases {
            if of.only_full && bench.suite == Suite::Quick {
                continue;
            }
            let case = case(published, &of.name, folder.path())?;
            let own = spacing_of(&case.problem)?;
            for spacing in bench.pick(vec![own], of.spacings.clone()) {
                let is_own = relative_error(spacing, own) < 1e-3;
                let spacing = if is_own { own } else { spacing };
                let case = respaced(&case, spacing)?;
                let modes = problem.modes(&of.name);
                plans.push(Plan { problem: published.name.into(), case, spacing, is_own, modes });
            }
        }
    }
    let with_bars = bench.suite == Suite::Full;
    let runs = plans
        .into_par_iter()
        .with_max_len(1)
        .map(|plan| on_threads(1, || solved(plan, with_bars)).context("a pool of one thread"))
        .collect::<Result<Vec<Solved>>>()?;
    report(bench, study, &runs, &problems)
}

/// Tables and checks of all runs.
fn report(
    bench: &Workbench,
    study: &mut Study,
    runs: &[Solved],
    problems: &[(&mtled_reference::Published, Problem)],
) -> Result<()> {
    let mut rows = Vec::new();
    for run in runs {
        let of_run = problems.iter().find(|(published, _)| published.name == run.problem);
        let (_, problem) = of_run.context("a run without a problem")?;
        for number in problem.numbers.iter().filter(|number| number.case == run.case.name) {
            let row = row(run, number)?;
            // Figures of the quick suite alone are stored.
            let of = problem.cases.iter().find(|of| of.name == run.case.name);
            let is_stored = number.missed.is_empty() || of.is_some_and(|of| !of.only_full);
            if run.is_own && is_stored {
                study.checks.push(check(bench, &problem.title, &row, number));
            }
            rows.push((row, number));
        }
    }
    study.tables.extend([numbers_table(&rows), costs_table(runs), sources_table(&rows)]);
    for (published, problem) in problems {
        study.notes.push(format!("{} ({}): {}", problem.title, published.name, problem.remark));
        for number in problem.numbers.iter().filter(|number| !number.missed.is_empty()) {
            let Number { case, name, missed, .. } = number;
            study.notes.push(format!("Missed: {}, {case}, {name}: {missed}.", problem.title));
        }
    }
    Ok(())
}

fn row(run: &Solved, number: &Number) -> Result<Row> {
    let ours = match &run.found {
        Ok(found) => {
            let of = || format!("{}/{}/{}", run.problem, run.case.name, number.name);
            Ok(answer(&run.case, found, number).with_context(of)?)
        }
        Err(reason) => Err(reason.clone()),
    };
    let quantity =
        number.answer.rsplit_once('/').map_or(number.answer.as_str(), |(first, _)| first);
    Ok(Row {
        problem: run.problem.clone(),
        case: run.case.name.clone(),
        spacing: run.spacing,
        nodes: run.nodes,
        is_own: run.is_own,
        ours,
        bar: run.bars.get(quantity).cloned().unwrap_or_default(),
    })
}

/// The difference over the scale is at most spread and tolerance; a number that is known to be
/// missed is held to its stored figure instead, so that it does not get worse. Without an answer the
/// difference is as large as none may be.
fn check(bench: &Workbench, title: &str, row: &Row, number: &Number) -> Check {
    let difference = row.difference(number).unwrap_or(f64::INFINITY);
    let id = number.id(&row.problem);
    let label = format!("{title}: {}, difference over its scale", number.name);
    if !number.missed.is_empty() {
        let remark = format!("the bound {} is missed: {}", number.bound(), number.missed);
        return bench.regression(&id, &label, difference, "1", &remark);
    }
    let kind = match number.by {
        By::ClosedForm | By::SeriesHere => Kind::Exact,
        By::Others | By::FiniteElementsHere => Kind::Reference,
    };
    Check::new(&id, &label, kind, difference, Bound::AtMost(number.bound()), "1", &number.source)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{land, turek_hron};
    use mtled_reference::PUBLISHED;

    #[test]
    fn every_number_belongs_to_a_case_and_has_a_source() {
        let folder = tempfile::tempdir().unwrap();
        unpack(folder.path()).unwrap();
        let mut ids = Vec::new();
        for (published, problem) in problems().unwrap() {
            for of in &problem.cases {
                let case = case(published, &of.name, folder.path()).unwrap();
                let own = spacing_of(&case.problem).unwrap();
                let own =
                    of.spacings.iter().filter(|spacing| relative_error(**spacing, own) < 1e-3);
                assert_eq!((own.count(), of.spacings.len()), (1, 3), "{}", of.name);
            }
            for number in &problem.numbers {
                assert!(problem.cases.iter().any(|of| of.name == number.case), "{}", number.case);
                assert!(!number.source.is_empty() && number.scale() > 0.0 && number.spread >= 0.0);
                assert!((0.0..=0.03).contains(&number.tolerance), "{}", number.tolerance);
                let is_frequency = number.answer.starts_with("frequency/");
                let modes = number.modes().filter(|(first, last)| (1..=*last).contains(first));
                assert_eq!(modes.is_some(), is_frequency, "{}", number.answer);
                ids.push(number.id(published.name));
            }
        }
        let count = ids.len();
        ids.sort();
        ids.dedup();
        assert_eq!(ids.len(), count);
    }

    #[test]
    fn at_least_nine_problems_have_numbers_of_others() {
        let problems = problems().unwrap();
        let of_others = |problem: &Problem| problem.numbers.iter().any(|n| n.by == By::Others);
        assert!(problems.iter().filter(|(_, problem)| of_others(problem)).count() >= 9);
        assert!(PUBLISHED.len() >= 23);
    }

    #[test]
    fn numbers_that_other_studies_have_too_are_the_same() {
        let problems = problems().unwrap();
        let value = |problem: &str, case: &str, name: &str| {
            let (_, found) = problems.iter().find(|(other, _)| other.name == problem).unwrap();
            let number = found.numbers.iter().find(|n| n.case == case && n.name == name).unwrap();
            (number.value, number.spread)
        };
        let same = |found: (f64, f64), known: crate::exact::Published| {
            assert_eq!(found, (known.value, known.uncertainty));
        };
        same(value("turek_hron", "turek_hron_csm1", "tip across"), turek_hron::CSM1[1]);
        same(value("turek_hron", "turek_hron_csm2", "tip across"), turek_hron::CSM2[1]);
        same(value("turek_hron", "turek_hron_csm3", "mean across"), turek_hron::CSM3_MEAN);
        same(value("land_1", "land_1", "height of the tip"), land::TIP_OF_BEAM);
    }
}
