//! A budget as a screen of text and as a page of report.

use super::{Budget, Share};
use crate::explore::sweep::percent;
use comfy_table::{Cell as Field, CellAlignment, ContentArrangement, Table as Screen, presets};
use mtled_checks::report::four_digits;
use mtled_checks::study::shorthand::{number, styled, text};
use mtled_checks::study::{Axis, Cell, Figure, Plot, SeriesStyle, Study, Table};

const HELD: &str = "the field off the prescribed values between nodes, rms over the held surfaces";

/// One screen.
pub fn budget_text(budget: &Budget) -> String {
    let mut screen = Screen::new();
    screen.load_style(presets::NOTHING);
    screen.set_content_arrangement(ContentArrangement::Dynamic);
    screen.set_header(["part", "size", "CPU time of the run", "how it is estimated"]);
    for row in rows(budget) {
        let [part, size, price, how] = row;
        screen.add_row([
            Field::new(part),
            Field::new(size).set_alignment(CellAlignment::Right),
            Field::new(price).set_alignment(CellAlignment::Right),
            Field::new(how),
        ]);
    }
    format!("{}\n\n{screen}\n\n{}\n", head(budget).join("\n"), price(budget).join("\n"))
}

fn head(budget: &Budget) -> Vec<String> {
    let Budget { source, base, total, truth, luck, group, .. } = budget;
    let figure = |name: &str| base.figure(name).map_or("–".into(), four_digits);
    let mut lines = vec![
        format!("{}: {}", source.name, source.case.title),
        format!(
            "  {} nodes, {} quadrature points, {} nodes per support",
            figure("nodes"),
            figure("points"),
            figure("mean_support")
        ),
        format!(
            "  error of the {}: {} rms, {} at most; the truth itself is known to {}",
            group.words(),
            percent(total.rms),
            percent(total.max),
            percent(total.bar)
        ),
        format!("  truth: {}", truth.source),
    ];
    if !luck.is_empty() {
        let all: Vec<String> = luck.iter().map(|error| percent(*error)).collect();
        lines.push(format!("  on other clouds of the same recipe: {}", all.join(", ")));
    }
    lines
}

fn size(share: &Share) -> Option<f64> {
    Some(share.part.factor * share.size?)
}

fn rows(budget: &Budget) -> Vec<[String; 4]> {
    let mut rows: Vec<[String; 4]> = (budget.shares.iter())
        .map(|share| {
            let how = match &share.failure {
                Some(reason) => format!("{}: that run fails: {reason}", share.part.how),
                None => share.part.how.clone(),
            };
            [
                share.part.name.to_string(),
                size(share).map_or("–".into(), percent),
                format!("x{:.2}", share.price),
                how,
            ]
        })
        .collect();
    if let Some(misfit) = budget.base.figure("held_misfit") {
        rows.push(["boundary".into(), percent(misfit), "–".into(), HELD.into()]);
    }
    rows
}

fn price(budget: &Budget) -> Vec<String> {
    let timings = &budget.base.timings;
    let mut lines = vec![format!(
        "  price: set-up {:.3} s, march {:.3} s of CPU time on one thread ({})",
        timings.set_up_cpu_s, timings.march_cpu_s, timings.processor
    )];
    if let Some(work) = budget.base.work() {
        lines.push(format!(
            "  {} evaluations of the internal force, {:.1} ns per point and neighbour; {} MB of memory \
             estimated",
            work.force_evaluations,
            1e9 * timings.march_cpu_s / work.neighbour_visits as f64,
            budget
                .base
                .figure("estimated_memory_bytes")
                .map_or("–".into(), |bytes| format!("{:.0}", bytes / 1e6))
        ));
    }
    lines.push(
        "  parts do not add up: they have signs, and those that are measured by a change of the \
         answer see what that change moves, not what is left."
            .into(),
    );
    lines
}

/// One page.
pub fn budget_study(budget: &Budget, command: &str) -> Study {
    let source = &budget.source;
    let mut study = Study {
        id: format!("budget-{}", source.name),
        title: format!("Error budget: {}", source.case.title),
        claim: "Where the error comes from, and what it costs to make each part smaller.".into(),
        command: command.to_string(),
        ..Study::default()
    };
    study.tables.push(Table {
        title: "Parts of the error".into(),
        columns: vec![
            text("part"),
            number("size", "%"),
            number("CPU time of that run over that of the case", "1"),
            text("how it is estimated"),
        ],
        rows: shown(budget),
    });
    study.figures.push(Figure::Plot(figure(budget)));
    study.notes.extend(head(budget).iter().chain(&price(budget)).map(|l| l.trim().to_string()));
    study
}

fn shown(budget: &Budget) -> Vec<Vec<Cell>> {
    let number = |value: Option<f64>| value.map_or(Cell::Text("–".into()), Cell::Number);
    let mut rows: Vec<Vec<Cell>> = (budget.shares.iter())
        .map(|share| {
            vec![
                Cell::Text(share.part.name.into()),
                number(size(share).map(|size| 100.0 * size)),
                Cell::Number(share.price),
                Cell::Text(share.part.how.clone()),
            ]
        })
        .collect();
    if let Some(misfit) = budget.base.figure("held_misfit") {
        rows.push(vec![
            Cell::Text("boundary".into()),
            Cell::Number(100.0 * misfit),
            Cell::Text("–".into()),
            Cell::Text(HELD.into()),
        ]);
    }
    rows.push(vec![
        Cell::Text("all, against the truth".into()),
        Cell::Number(100.0 * budget.total.rms),
        Cell::Number(1.0),
        Cell::Text(budget.truth.source.clone()),
    ]);
    rows
}

/// Each part over the price of the run that shows it.
fn figure(budget: &Budget) -> Plot {
    let parts = budget.shares.iter().filter_map(|share| {
        let size = size(share).filter(|size| *size > 0.0)?;
        Some(styled(share.part.name, vec![(share.price, 100.0 * size)], SeriesStyle::Points))
    });
    let mut series: Vec<_> = parts.collect();
    let mut all = styled(
        "all, against the truth",
        vec![(1.0, 100.0 * budget.total.rms)],
        SeriesStyle::Points,
    );
    all.error_bars = vec![100.0 * budget.total.bar];
    series.push(all);
    Plot {
        title: "Size of each part over the price of seeing it".into(),
        caption:
            "The run that makes a part smaller costs this many times the CPU time of the case. \
                  Parts to the upper left are worth paying for."
                .into(),
        x: Axis { label: "CPU time over that of the case".into(), unit: "1".into(), log: true },
        y: Axis { label: "part of the error".into(), unit: "%".into(), log: true },
        series,
        slopes: Vec::new(),
    }
}
