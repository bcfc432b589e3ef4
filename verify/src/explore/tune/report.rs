//! A search as a page of report and as a screen of text.

use super::cases::Recommendation;
use super::effects::{change_words, main_effects};
use super::score::front;
use super::{Goal, Trial, Tuned, Wanted};
use crate::explore::sweep::percent;
use mtled_checks::report::four_digits;
use mtled_checks::study::shorthand::{line, number, styled, text};
use mtled_checks::study::{
    Axis, Bound, Cell, Check, Figure, Kind, Plot, SeriesStyle, Study, Table,
};

/// The goal in words.
fn goal_words(goal: Goal) -> String {
    match goal {
        Goal::Error(target) => format!("an error of at most {}", percent(target)),
        Goal::Budget(cpu_s) => format!("at most {} CPU s", four_digits(cpu_s)),
    }
}

/// One screen.
pub fn tune_text(wanted: &Wanted, tuned: &Tuned) -> String {
    let mut lines = vec![format!(
        "{}: {} of the {}",
        wanted.source.name,
        goal_words(wanted.goal),
        tuned.group.words()
    )];
    lines.push(format!("  truth: {}; known to {}", tuned.truth, percent(tuned.bar)));
    lines.push(format!(
        "  {} trials of {} recipes, {} refused or failed",
        tuned.trials.len(),
        tuned.candidates.len(),
        tuned.dropped
    ));
    match &tuned.winner {
        None => lines.push("  no recipe that was tried meets it".into()),
        Some(winner) => {
            lines.push(format!(
                "  recipe: spacing x{}, {}",
                four_digits(winner.factor),
                tuned.candidates[winner.candidate].words()
            ));
            lines.push(format!("  {}", measured(winner, "on the clouds of the search")));
        }
    }
    if let Some(confirmed) = &tuned.confirmed {
        lines.push(format!("  {}", measured(confirmed, "on clouds that nobody had looked at")));
    }
    lines.push(String::new());
    lines.push("  error      CPU s    recipe (no other is both cheaper and better)".into());
    for trial in front(&tuned.trials) {
        lines.push(format!(
            "  {:9}  {:7}  spacing x{}, {}",
            percent(trial.worst()),
            four_digits(trial.cpu_s),
            four_digits(trial.factor),
            tuned.candidates[trial.candidate].words()
        ));
    }
    lines.join("\n")
}

fn measured(trial: &Trial, place: &str) -> String {
    format!(
        "{} {place}: {} CPU s in the middle, the largest error {}",
        trial.errors.len(),
        four_digits(trial.cpu_s),
        percent(trial.worst())
    )
}

/// One page.
pub fn tune_study(wanted: &Wanted, tuned: &Tuned) -> Study {
    let mut study = Study {
        id: format!("tune-{}", wanted.source.name),
        title: format!("Tuning: {}", wanted.source.case.title),
        claim: format!(
            "The cheapest recipe found for {} of the {}, and what the answer is sensitive to.",
            goal_words(wanted.goal),
            tuned.group.words()
        ),
        command: wanted.command.clone(),
        ..Study::default()
    };
    study.checks.extend(confirmation(wanted, tuned));
    study.figures.push(Figure::Plot(pareto(wanted, tuned)));
    study.tables.push(front_table(tuned));
    if let Some(winner) = &tuned.winner {
        study.figures.push(Figure::Plot(changes_figure(tuned, winner)));
        study.tables.push(changes_table(tuned, winner));
    }
    study.tables.push(effects_table(tuned));
    study.tables.push(trials_table(tuned));
    study.notes.extend(tune_text(wanted, tuned).lines().take(6).map(|l| l.trim().to_string()));
    study.notes.push(
        "The error of a recipe is the largest over its clouds; a recipe meets a wanted error if \
         that, half the range over the clouds and the truth's own error together stay below it. \
         Expected costs between spacings use the order that is seen, within 0.7 to 3, and h⁻ᵈ⁻¹."
            .into(),
    );
    study
}

/// The goal on clouds that the search has not seen.
fn confirmation(wanted: &Wanted, tuned: &Tuned) -> Option<Check> {
    let (value, limit, unit) = match (&tuned.confirmed, wanted.goal) {
        (Some(trial), Goal::Error(target)) => (100.0 * trial.worst(), 100.0 * target, "%"),
        (Some(trial), Goal::Budget(cpu_s)) => (trial.cpu_s, cpu_s, "s"),
        (None, Goal::Error(target)) => (f64::INFINITY, 100.0 * target, "%"),
        (None, Goal::Budget(cpu_s)) => (f64::INFINITY, cpu_s, "s"),
    };
    // A time is of this machine and this minute: shown, not judged.
    let judged = matches!(wanted.goal, Goal::Error(_)) || tuned.confirmed.is_none();
    judged.then(|| {
        Check::new(
            &format!("tune-{}/confirmed", wanted.source.name),
            "largest error of the chosen recipe on clouds that the search has not seen",
            Kind::Reference,
            value,
            Bound::AtMost(limit),
            unit,
            &format!("wanted by the user; the truth itself is known to {}", percent(tuned.bar)),
        )
    })
}

fn pareto(wanted: &Wanted, tuned: &Tuned) -> Plot {
    let point = |trial: &Trial| (trial.cpu_s, 100.0 * trial.worst());
    let ended = tuned.trials.iter().filter(|trial| trial.worst().is_finite());
    let mut series = vec![
        styled("recipes", ended.map(point).collect(), SeriesStyle::Points),
        styled(
            "front",
            front(&tuned.trials).into_iter().map(point).collect(),
            SeriesStyle::LineAndPoints,
        ),
    ];
    if let Some(winner) = &tuned.winner {
        series.push(styled("chosen", vec![point(winner)], SeriesStyle::Points));
    }
    if let Goal::Error(target) = wanted.goal {
        let all = || tuned.trials.iter().map(|trial| trial.cpu_s);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
        series.push(line("wanted", vec![(low, 100.0 * target), (high, 100.0 * target)]));
    }
    Plot {
        title: format!("{}: error against CPU time", wanted.source.case.title),
        caption:
            "Every recipe that was tried, at every spacing; the largest error over its clouds."
                .into(),
        x: Axis { label: "CPU time, one thread".into(), unit: "s".into(), log: true },
        y: Axis { label: "error".into(), unit: "%".into(), log: true },
        series,
        slopes: Vec::new(),
    }
}

fn trial_columns() -> Vec<mtled_checks::study::Column> {
    vec![
        text("recipe"),
        number("spacing over that of the case", "1"),
        number("clouds", "1"),
        number("largest error", "%"),
        number("smallest error", "%"),
        number("CPU time", "s"),
        text("what came of it"),
    ]
}

fn trial_row(tuned: &Tuned, trial: &Trial) -> Vec<Cell> {
    let least = trial.errors.iter().copied().fold(f64::INFINITY, f64::min);
    let shown = |value: f64| match value.is_finite() {
        true => Cell::Number(100.0 * value),
        false => Cell::Text("–".into()),
    };
    vec![
        Cell::Text(tuned.candidates[trial.candidate].words()),
        Cell::Number(trial.factor),
        Cell::Number(trial.errors.len() as f64),
        shown(trial.worst()),
        shown(least),
        Cell::Number(trial.cpu_s),
        Cell::Text(
            trial.failure.clone().map_or("ended".into(), |reason| format!("failed: {reason}")),
        ),
    ]
}

fn front_table(tuned: &Tuned) -> Table {
    Table {
        title: "Front: no other is both cheaper and better".into(),
        columns: trial_columns(),
        rows: front(&tuned.trials).into_iter().map(|trial| trial_row(tuned, trial)).collect(),
    }
}

fn trials_table(tuned: &Tuned) -> Table {
    Table {
        title: "Every trial".into(),
        columns: trial_columns(),
        rows: tuned.trials.iter().map(|trial| trial_row(tuned, trial)).collect(),
    }
}

fn changes_table(tuned: &Tuned, winner: &Trial) -> Table {
    let row = |change: &Trial| {
        let ratio = change.worst() / winner.worst();
        vec![
            Cell::Text(change_words(&tuned.candidates, winner, change)),
            if ratio.is_finite() { Cell::Number(ratio) } else { Cell::Text("–".into()) },
            Cell::Number(change.cpu_s / winner.cpu_s),
            Cell::Text(change.failure.clone().unwrap_or_else(|| "ended".into())),
        ]
    };
    Table {
        title: "One change of the chosen recipe at a time".into(),
        columns: vec![
            text("change"),
            number("error over that of the chosen", "1"),
            number("CPU time over that of the chosen", "1"),
            text("what came of it"),
        ],
        rows: tuned.changes.iter().map(row).collect(),
    }
}

fn changes_figure(tuned: &Tuned, winner: &Trial) -> Plot {
    let ended = tuned.changes.iter().filter(|change| change.worst().is_finite());
    let series = ended.map(|change| {
        let point = (change.cpu_s / winner.cpu_s, change.worst() / winner.worst());
        styled(&change_words(&tuned.candidates, winner, change), vec![point], SeriesStyle::Points)
    });
    let mut series: Vec<_> = series.collect();
    series.push(styled("chosen", vec![(1.0, 1.0)], SeriesStyle::Points));
    Plot {
        title: "What one change does to error and cost".into(),
        caption: "To the lower left of the chosen recipe a change would be better in both; the \
                  largest error over the clouds, middle of their CPU times."
            .into(),
        x: Axis { label: "CPU time over that of the chosen".into(), unit: "1".into(), log: true },
        y: Axis { label: "error over that of the chosen".into(), unit: "1".into(), log: true },
        series,
        slopes: Vec::new(),
    }
}

fn effects_table(tuned: &Tuned) -> Table {
    let rows = main_effects(&tuned.candidates, &tuned.trials).into_iter().map(|effect| {
        vec![
            Cell::Text(effect.knob.name().replace('_', " ")),
            Cell::Text(effect.level.to_string()),
            Cell::Number(effect.error),
            Cell::Number(effect.cpu),
            Cell::Number(effect.trials as f64),
        ]
    });
    Table {
        title: "Main effects in the first round".into(),
        columns: vec![
            text("knob"),
            text("level"),
            number("error over the mean of all", "1"),
            number("CPU time over the mean of all", "1"),
            number("trials", "1"),
        ],
        rows: rows.collect(),
    }
}

/// The table over all cases.
pub fn recommendation_study(found: &Recommendation, command: &str) -> Study {
    let mut columns = vec![
        text("recipe"),
        number("mean over the cases", "1"),
        number("median", "1"),
        number("largest", "1"),
        number("failures", "1"),
    ];
    columns.extend(found.cases.iter().map(|case| number(case, "1")));
    let row = |row: &super::cases::Row| {
        let mut cells = vec![
            Cell::Text(found.candidates[row.candidate].words()),
            Cell::Number(row.mean),
            Cell::Number(row.median),
            Cell::Number(row.worst),
            Cell::Number(row.failures as f64),
        ];
        cells.extend(row.ratios.iter().map(|ratio| match ratio {
            ratio if ratio.is_finite() => Cell::Number(*ratio),
            ratio if ratio.is_nan() => Cell::Text("–".into()),
            _ => Cell::Text("fails".into()),
        }));
        cells
    };
    let mut study = Study {
        id: "tune-cases".into(),
        title: "One recipe for all cases".into(),
        claim: format!(
            "Recommended: {}. What each recipe is expected to cost at the error of the case's own \
             recipe, over what that costs, case by case; the smallest median first.",
            found.candidates[found.chosen().candidate].words()
        ),
        command: command.to_string(),
        ..Study::default()
    };
    study.tables.push(Table {
        title: "Expected CPU time at equal error, over the case's own recipe".into(),
        columns,
        rows: found.rows.iter().map(row).collect(),
    });
    study.notes.push(
        "Each recipe is run at 1.6 and 1.25 times the spacing of the case, on one and two clouds, and \
         compared with the case's own recipe at the same spacing. What its cost would be at the same \
         error follows from one order for all recipes of a case, the median of what they show, each \
         within 0.7 to 3, and from costs that grow like h⁻ᵈ⁻¹. The means are geometric, over both \
         spacings and over the cases where it ends."
            .into(),
    );
    study.notes.push(
        "Recommended is, of the recipes with the fewest failures whose median is within 10 % of the \
         smallest, which is what times of the same work leave in doubt, the one that costs least in \
         its worst case."
            .into(),
    );
    study.notes.extend(found.skipped.iter().map(|skipped| format!("Left out: {skipped}")));
    study
}
