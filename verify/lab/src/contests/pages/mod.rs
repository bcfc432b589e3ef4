//! Pages of the contest: one in front, one for each solver, one for each problem. They need no
//! network.

mod history;

pub use history::History;

use super::identity::Identity;
use super::judged::{CaseRuns, Judged, Spent};
use super::outcome::Outcome;
use super::report::{about_solver, notes, overview, plot};
use super::run_tables::{orders_of, runs_of, runs_on};
use super::tables::{budgets, endings, equal_errors, finest, losses, robustness, wins};
use anyhow::Result;
use mtled_checks::escape::{file_name, printable};
use mtled_checks::report::html::{Link, Page, Part, page_to_html};
use mtled_checks::report::write_atomically;
use mtled_checks::study::{Figure, Panels, Plot, SeriesStyle, Table};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const SEND: &str = "\
mtled contest list                            # the problems
mtled protocol job cube_shear try             # a job: try/job.json
# write mine.py, which reads the job and writes the answer (reference/adapters/README.md)
python3 mine.py try/job.json try/answer.json
mtled protocol check try/job.json try/answer.json
mtled contest run --solver 'mine=python3 mine.py {job} {answer}' --without-mtled --out mine
mtled contest check mine/results
# copy mine/results/mine to reference/results/mine and open a pull request";

/// Writes all pages into a folder, with one of the history of mtled where it is known.
pub fn write_pages(all: &Judged, history: Option<&History>, out: &Path) -> Result<()> {
    let mut first = front(all);
    if let Some(history) = history {
        write(&history.page(back()), out, HISTORY)?;
        let text = "mtled by commit".into();
        let links = vec![Link { href: HISTORY.into(), text, remark: String::new() }];
        first.parts.push(Part { title: "History".into(), links, ..Part::default() });
    }
    write(&first, out, "index.html")?;
    for n in 0..all.solvers.len() {
        write(&solver_page(all, n), out, &solver_file(&all.solvers[n].name))?;
    }
    for case in &all.cases {
        write(&problem_page(all, case), out, &problem_file(&case.of.id))?;
    }
    Ok(())
}

/// Page of the history.
const HISTORY: &str = "history.html";

fn write(page: &Page, out: &Path, name: &str) -> Result<()> {
    write_atomically(&out.join(name), page_to_html(page)?.as_bytes())
}

fn solver_file(name: &str) -> String {
    format!("solver-{}.html", file_name(name))
}

fn problem_file(id: &str) -> String {
    format!("problem-{}.html", file_name(id))
}

fn group_of(case: &CaseRuns) -> &'static str {
    let inputs = &case.of.source.case.problem_hash;
    Identity::of_inputs(inputs).map_or("of your own", |identity| &identity.group)
}

fn front(all: &Judged) -> Page {
    let (solvers, problems) = (all.solvers.len(), all.cases.len());
    let lead = format!(
        "{} on {}, each with a reference that has an error bar: how far the answers are off, \
         what they cost, and which runs ended without one. Every figure here is judged from the raw answers that \
         are stored beside the problems.",
        count(solvers, "program", "programs"),
        count(problems, "problem", "problems")
    );
    let overview = Part {
        title: "Error over CPU time".into(),
        figures: vec![overview(all)],
        ..Part::default()
    };
    let best = Part {
        title: "Smallest error for 0.1, 1, 10 and 100 CPU s".into(),
        tables: budgets(all),
        folded: true,
        ..Part::default()
    };
    let links = Part { title: "Solvers".into(), links: solver_links(all), ..Part::default() };
    let losses = losses(all);
    let parts = vec![
        endings_and_costs(all, losses.as_ref()),
        overview,
        best,
        equal_costs(all, losses),
        links,
        problem_links(all),
        your_solver(),
    ];
    let title = "Solvers of soft bodies on the same problems".into();
    Page { title, back: None, lead: vec![lead], parts, foot: notes(all) }
}

fn endings_and_costs(all: &Judged, losses: Option<&Table>) -> Part {
    let mut texts = Vec::new();
    if let Some(lost) = losses.map(|table| table.rows.len()) {
        texts.push(format!(
            "mtled itself loses at {lost} of these levels; each is in the table \"Where mtled loses\" below."
        ));
    }
    let processors: BTreeSet<&str> =
        all.machines.iter().map(|machine| machine.processor.as_str()).collect();
    if processors.len() > 1 {
        let names: Vec<String> = processors.into_iter().map(printable).collect();
        texts.push(format!(
            "Results are of several machines. Costs are those of the one that most are of; others have errors only: {}.",
            names.join(", ")
        ));
    }
    let tables = vec![robustness(all), wins(all)];
    Part { title: "Who answers, and what it costs".into(), texts, tables, ..Part::default() }
}

fn equal_costs(all: &Judged, losses: Option<Table>) -> Part {
    Part {
        title: "CPU time at equal error".into(),
        tables: losses.into_iter().chain([equal_errors(all, Spent::Process)]).collect(),
        folded: true,
        ..Part::default()
    }
}

fn your_solver() -> Part {
    let text = "Any program takes part that reads a JSON file and writes one. Its name and version, the machine, the \
                command and the raw answers go into a file per problem; a change of a problem makes a new version of it.";
    Part {
        title: "Your solver".into(),
        texts: vec![text.into()],
        code: Some(SEND.into()),
        ..Part::default()
    }
}

fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

fn solver_links(all: &Judged) -> Vec<Link> {
    let link = |(n, solver): (usize, &super::judged::JudgedSolver)| {
        let counts = endings(&all.cases, n);
        Link {
            href: solver_file(&solver.name),
            text: printable(&solver.name),
            remark: format!("{} of {} runs answered", counts.answered, counts.runs),
        }
    };
    all.solvers.iter().enumerate().map(link).collect()
}

fn problem_links(all: &Judged) -> Part {
    let mut groups: BTreeMap<&str, Vec<&CaseRuns>> = BTreeMap::new();
    for case in &all.cases {
        groups.entry(group_of(case)).or_default().push(case);
    }
    let link = |group: &str, case: &CaseRuns| Link {
        href: problem_file(&case.of.id),
        text: case.of.id.clone(),
        remark: format!("{}. {}", printable(&case.of.source.case.title), printable(group)),
    };
    let links = groups.iter().flat_map(|(group, cases)| cases.iter().map(|case| link(group, case)));
    Part { title: "Problems".into(), links: links.collect(), ..Part::default() }
}

fn back() -> Option<Link> {
    let text = "All solvers and problems".into();
    Some(Link { href: "index.html".into(), text, remark: String::new() })
}

fn solver_page(all: &Judged, n: usize) -> Page {
    let name = printable(&all.solvers[n].name);
    let counts = endings(&all.cases, n);
    let panels = all.cases.iter().filter(|case| !case.costs[n].is_empty()).map(|case| {
        let plot = plot(&names(all), case, all.spent(), SeriesStyle::Floor);
        let floor = all.solvers.len();
        let own = plot.series.into_iter().filter(|s| [Some(n), Some(floor)].contains(&s.colour));
        Figure::Plot(Plot { title: case.of.id.clone(), series: own.collect(), ..plot })
    });
    let panels: Vec<Figure> = panels.collect();
    let figures = if panels.is_empty() {
        Vec::new()
    } else {
        let title = "Error over CPU time".into();
        let caption =
            "From coarse to fine. Below the error bar of the reference nothing is decided.".into();
        vec![Figure::Panels(Panels { title, caption, panels })]
    };
    Page {
        title: format!("{name} on the problems of the contest"),
        back: back(),
        lead: vec![
            about_solver(all, n),
            format!(
                "Of {} runs {} answered, {} were refused, {} ran out of time and {} were faulty; answers on {} problems \
                 are doubtful.",
                counts.runs,
                counts.answered,
                counts.refused,
                counts.timed_out,
                counts.faulty,
                counts.doubtful
            ),
        ],
        parts: vec![
            Part { title: "Error and cost".into(), figures, ..Part::default() },
            refusals(all, n),
            Part {
                title: "Orders, doubts and all runs".into(),
                tables: vec![orders_of(&name, &all.cases, n), runs_of(&name, &all.cases, n)],
                ..Part::default()
            },
        ],
        foot: notes(all).into_iter().take(4).collect(),
    }
}

/// What a program did not answer, a line per problem and reason.
fn refusals(all: &Judged, n: usize) -> Part {
    let mut reasons: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for case in &all.cases {
        for run in &case.runs[n] {
            if !matches!(run.outcome, Outcome::Answered(_)) {
                let problems = reasons.entry(run.outcome.label()).or_default();
                if problems.last() != Some(&case.of.id.as_str()) {
                    problems.push(&case.of.id);
                }
            }
        }
    }
    let text = |(reason, problems): (&String, &Vec<&str>)| {
        format!("{}: {}.", problems.join(", "), reason.trim_end_matches('.'))
    };
    let texts: Vec<String> = if reasons.is_empty() {
        vec!["Every run ended with an answer.".into()]
    } else {
        reasons.iter().map(text).collect()
    };
    Part { title: "Runs without an answer".into(), texts, ..Part::default() }
}

fn problem_page(all: &Judged, case: &CaseRuns) -> Page {
    let parsed = &case.of.source.case;
    let words: Vec<&str> = parsed.description.split_whitespace().collect();
    let description = printable(&words.join(" "));
    let own = Judged {
        solvers: all.solvers.clone(),
        cases: vec![case.clone()],
        machines: all.machines.clone(),
        time_limits_s: all.time_limits_s.clone(),
    };
    let figure = Figure::Plot(plot(&names(all), case, all.spent(), SeriesStyle::Line));
    Page {
        title: format!("{}: {}", case.of.id, printable(&parsed.title)),
        back: back(),
        lead: vec![description, format!("Group: {}.", group_of(case))],
        parts: vec![
            Part {
                title: "Error over CPU time".into(),
                figures: vec![figure],
                tables: vec![finest(&own), equal_errors(&own, all.spent())],
                ..Part::default()
            },
            Part {
                title: "All runs".into(),
                tables: vec![runs_on(case, &names(all))],
                folded: true,
                ..Part::default()
            },
            Part {
                title: "The problem".into(),
                texts: vec![
                    format!("Reference: {}.", printable(&case.of.reference.source)),
                    format!("Fingerprint of the inputs: {}.", parsed.problem_hash),
                ],
                code: Some(parsed.text().to_string()),
                ..Part::default()
            },
        ],
        foot: notes(all).into_iter().take(4).collect(),
    }
}

fn names(all: &Judged) -> Vec<String> {
    all.solvers.iter().map(|solver| printable(&solver.name)).collect()
}
