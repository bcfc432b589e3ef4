//! A search as a report and as text.

use super::effects::{change_label, main_effects};
use super::score::front;
use super::search::Tuned;
use super::trial::{Goal, Trial, TuneRequest};
use crate::lab::label::{knob_label, optional, percent};
use mtled_checks::report::four_digits;
use mtled_checks::study::{
    Bound, Cell, Check, Figure, Kind, Plot, SeriesStyle, Study, Table, axis, line, number, styled,
    text,
};

fn goal_label(goal: Goal) -> String {
    match goal {
        Goal::Error(target) => format!("an error of at most {}", percent(target)),
        Goal::Budget(cpu_s) => format!("at most {} CPU s", four_digits(cpu_s)),
    }
}

/// The result on one screen.
pub fn tune_text(request: &TuneRequest, tuned: &Tuned) -> String {
    let mut lines = head(request, tuned);
    if tuned.trials.is_empty() {
        return lines.join("\n");
    }
    lines.push(String::new());
    lines.push("  error      CPU s    recipe (no other is both cheaper and more accurate)".into());
    for trial in front(&tuned.trials) {
        lines.push(format!(
            "  {:9}  {:7}  {}",
            percent(trial.worst()),
            four_digits(trial.cpu_s),
            recipe(tuned, trial)
        ));
    }
    lines.join("\n")
}

fn recipe(tuned: &Tuned, trial: &Trial) -> String {
    let label = tuned.candidates[trial.candidate].label();
    format!("spacing x{}, {label}", four_digits(trial.factor))
}

fn head(request: &TuneRequest, tuned: &Tuned) -> Vec<String> {
    let mut lines = vec![
        format!(
            "{}: {} of the {}",
            request.source.name,
            goal_label(request.goal),
            tuned.group.label()
        ),
        format!("  reference: {}; its own error is {}", tuned.reference, percent(tuned.bar)),
        format!(
            "  {} trials of {} recipes, {} refused or failed",
            tuned.trials.len(),
            tuned.candidates.len(),
            tuned.failed
        ),
    ];
    match &tuned.winner {
        None => lines.push(match &tuned.undecided {
            Some(reason) => format!("  inconclusive: {reason}"),
            None => "  no recipe that was tried meets the goal".into(),
        }),
        Some(winner) => {
            lines.push(format!("  recipe: {}", recipe(tuned, winner)));
            lines.push(measured(winner, "of the search"));
        }
    }
    lines.extend(
        tuned.confirmed.iter().map(|trial| measured(trial, "that the search has not used")),
    );
    lines
}

fn measured(trial: &Trial, which: &str) -> String {
    format!(
        "  on {} clouds {which}: median {} CPU s, largest error {}",
        trial.errors.len(),
        four_digits(trial.cpu_s),
        percent(trial.worst())
    )
}

/// The report.
pub fn tune_study(request: &TuneRequest, tuned: &Tuned) -> Study {
    let mut study = Study {
        id: format!("tune-{}", request.source.name),
        title: format!("Tuning: {}", request.source.case.title),
        claim: format!(
            "The cheapest recipe found for {} of the {}, and what error and cost are sensitive to.",
            goal_label(request.goal),
            tuned.group.label()
        ),
        command: request.command.clone(),
        ..Study::default()
    };
    study.undecided.extend(tuned.undecided.clone());
    if tuned.trials.is_empty() {
        return study;
    }
    study.checks.extend(confirmation(request, tuned));
    study.figures.push(Figure::Plot(pareto(request, tuned)));
    study.leading = 1;
    let title = "Front: no other recipe is both cheaper and more accurate";
    study.tables.push(trials_table(title, tuned, front(&tuned.trials)));
    if let Some(winner) = &tuned.winner {
        study.figures.push(Figure::Plot(changes_figure(tuned, winner)));
        study.tables.push(changes_table(tuned, winner));
    }
    study.tables.push(effects_table(tuned));
    study.tables.push(trials_table("Every trial", tuned, tuned.trials.iter().collect()));
    study.notes.extend(head(request, tuned).iter().map(|line| line.trim().to_string()));
    study.notes.push(
        "The error of a recipe is the largest over its clouds. A recipe meets a target error if this \
         error, half the range over the clouds and the error of the reference together stay below \
         it. Expected costs at other spacings use the observed order, limited to 0.7 to 3, and a \
         cost that grows as h⁻ᵈ⁻¹."
            .into(),
    );
    study
}

/// The goal on clouds that the search has not used. CPU times are shown but not judged: they
/// are those of this machine at this time.
fn confirmation(request: &TuneRequest, tuned: &Tuned) -> Option<Check> {
    let (value, limit, unit) = match (&tuned.confirmed, request.goal) {
        (Some(trial), Goal::Error(target)) => (100.0 * trial.worst(), 100.0 * target, "%"),
        (Some(_), Goal::Budget(_)) => return None,
        (None, Goal::Error(_)) if tuned.undecided.is_some() => return None,
        (None, Goal::Error(target)) => (f64::INFINITY, 100.0 * target, "%"),
        (None, Goal::Budget(cpu_s)) => (f64::INFINITY, cpu_s, "s"),
    };
    Some(Check::new(
        &format!("tune-{}/confirmed", request.source.name),
        "largest error of the chosen recipe on clouds that the search has not used",
        Kind::Reference,
        value,
        Bound::AtMost(limit),
        unit,
        &format!("the goal of the user; the error of the reference is {}", percent(tuned.bar)),
    ))
}

fn pareto(request: &TuneRequest, tuned: &Tuned) -> Plot {
    let points = |trials: Vec<&Trial>| {
        trials.into_iter().map(|trial| (trial.cpu_s, 100.0 * trial.worst())).collect()
    };
    let finished = tuned.trials.iter().filter(|trial| trial.worst().is_finite()).collect();
    let mut series = vec![
        styled("recipes", points(finished), SeriesStyle::Points),
        styled("front", points(front(&tuned.trials)), SeriesStyle::LineAndPoints),
    ];
    if let Some(winner) = &tuned.winner {
        series.push(styled("chosen", points(vec![winner]), SeriesStyle::Points));
    }
    if let Goal::Error(target) = request.goal {
        let all = || tuned.trials.iter().map(|trial| trial.cpu_s);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
        series.push(line("target", vec![(low, 100.0 * target), (high, 100.0 * target)]));
    }
    Plot {
        title: format!("{}: error against CPU time", request.source.case.title),
        caption:
            "Every recipe that was tried, at every spacing; the largest error over its clouds."
                .into(),
        x: axis("CPU time, one thread", "s", true),
        y: axis("error", "%", true),
        series,
        slopes: Vec::new(),
    }
}

fn trials_table(title: &str, tuned: &Tuned, trials: Vec<&Trial>) -> Table {
    let finite = |error: f64| optional(Some(100.0 * error).filter(|percent| percent.is_finite()));
    let row = |trial: &&Trial| {
        vec![
            Cell::Text(tuned.candidates[trial.candidate].label()),
            Cell::Number(trial.factor),
            Cell::Number(trial.errors.len() as f64),
            finite(trial.worst()),
            finite(trial.least()),
            Cell::Number(trial.cpu_s),
            outcome(trial),
        ]
    };
    Table {
        title: title.into(),
        columns: vec![
            text("recipe"),
            number("spacing over that of the case", "1"),
            number("clouds", "1"),
            number("largest error", "%"),
            number("smallest error", "%"),
            number("CPU time", "s"),
            text("outcome"),
        ],
        rows: trials.iter().map(row).collect(),
    }
}

fn outcome(trial: &Trial) -> Cell {
    Cell::Text(trial.failure.as_ref().map_or("ok".into(), |reason| format!("failed: {reason}")))
}

fn changes_table(tuned: &Tuned, winner: &Trial) -> Table {
    let row = |change: &Trial| {
        let ratio = change.worst() / winner.worst();
        vec![
            Cell::Text(change_label(&tuned.candidates, winner, change)),
            optional(Some(ratio).filter(|ratio| ratio.is_finite())),
            Cell::Number(change.cpu_s / winner.cpu_s),
            outcome(change),
        ]
    };
    Table {
        title: "One change of the chosen recipe at a time".into(),
        columns: vec![
            text("change"),
            number("error over that of the chosen", "1"),
            number("CPU time over that of the chosen", "1"),
            text("outcome"),
        ],
        rows: tuned.changes.iter().map(row).collect(),
    }
}

fn changes_figure(tuned: &Tuned, winner: &Trial) -> Plot {
    let finished = tuned.changes.iter().filter(|change| change.worst().is_finite());
    let series = finished.map(|change| {
        let point = (change.cpu_s / winner.cpu_s, change.worst() / winner.worst());
        styled(&change_label(&tuned.candidates, winner, change), vec![point], SeriesStyle::Points)
    });
    let mut series: Vec<_> = series.collect();
    series.push(styled("chosen", vec![(1.0, 1.0)], SeriesStyle::Points));
    Plot {
        title: "Effect of one change on error and cost".into(),
        caption:
            "A change to the lower left of the chosen recipe would be better in both. Largest \
                  error and median CPU time over the clouds."
                .into(),
        x: axis("CPU time over that of the chosen", "1", true),
        y: axis("error over that of the chosen", "1", true),
        series,
        slopes: Vec::new(),
    }
}

fn effects_table(tuned: &Tuned) -> Table {
    let rows = main_effects(&tuned.candidates, &tuned.trials).into_iter().map(|effect| {
        vec![
            Cell::Text(knob_label(effect.knob)),
            Cell::Text(effect.level.to_string()),
            Cell::Number(effect.error),
            Cell::Number(effect.cpu),
            Cell::Number(effect.trials as f64),
        ]
    });
    Table {
        title: "Main effects in the first round".into(),
        columns: vec![
            text("setting"),
            text("level"),
            number("error over the mean of all", "1"),
            number("CPU time over the mean of all", "1"),
            number("trials", "1"),
        ],
        rows: rows.collect(),
    }
}
