//! An error budget as text and as a report.

use super::measure::ErrorBudget;
use crate::lab::label::{optional, percent};
use comfy_table::{CellAlignment, ContentArrangement, presets};
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use mtled_checks::study::{
    Cell, Figure, Plot, SeriesStyle, Study, Table, axis, number, styled, text,
};

const BOUNDARY: &str = "deviation of the field from the prescribed values between the nodes, rms over the \
                        constrained surfaces";
const TOTAL: &str = "total, against the reference";

/// A part of the error with its size \[–\], the cost of its run \[–\] and how it is estimated.
type Row = (&'static str, Option<f64>, Option<f64>, String);

fn rows(budget: &ErrorBudget) -> Vec<Row> {
    let parts = budget.parts.iter().map(|measured| {
        let how = match &measured.failure {
            Some(reason) => format!("{}: that run fails: {reason}", measured.part.how),
            None => measured.part.how.clone(),
        };
        (measured.part.name, measured.size, Some(measured.cost), how)
    });
    let misfit = budget.base.figure("held_misfit");
    parts.chain(misfit.map(|misfit| ("boundary", Some(misfit), None, BOUNDARY.into()))).collect()
}

/// The budget on one screen.
pub fn budget_text(budget: &ErrorBudget) -> String {
    let mut screen = comfy_table::Table::new();
    screen.load_style(presets::NOTHING);
    screen.set_content_arrangement(ContentArrangement::Dynamic);
    screen.set_header(["part", "size", "CPU time of the run", "how it is estimated"]);
    for (name, size, cost, how) in rows(budget) {
        screen.add_row([
            name.to_string(),
            size.map_or("–".into(), percent),
            cost.map_or("–".into(), |cost| format!("x{cost:.2}")),
            how,
        ]);
    }
    for column in screen.column_iter_mut().skip(1).take(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    format!("{}\n\n{screen}\n\n{}\n", head(budget).join("\n"), cost(budget).join("\n"))
}

fn head(budget: &ErrorBudget) -> Vec<String> {
    let ErrorBudget { source, base, total, reference, other_clouds, group, .. } = budget;
    let figure = |name: &str| base.figure(name).map_or("–".into(), four_digits);
    let mut lines = vec![
        printable(&format!("{}: {}", source.name, source.case.title)),
        format!(
            "  {} nodes, {} quadrature points, {} nodes per support",
            figure("nodes"),
            figure("points"),
            figure("mean_support")
        ),
        format!(
            "  error of the {}: rms {}, largest {}; error of the reference itself: {}",
            group.label(),
            percent(total.rms),
            percent(total.max),
            percent(total.bar)
        ),
        format!("  reference: {}", reference.source),
    ];
    if !other_clouds.is_empty() {
        let all: Vec<String> = other_clouds.iter().map(|error| percent(*error)).collect();
        lines.push(format!("  on other clouds of the same recipe: {}", all.join(", ")));
    }
    lines
}

fn cost(budget: &ErrorBudget) -> Vec<String> {
    let base = &budget.base;
    let timings = &base.timings;
    let mut lines = vec![format!(
        "  cost: set-up {:.3} s, solution {:.3} s of CPU time on one thread ({})",
        timings.set_up_cpu_s, timings.solve_cpu_s, timings.processor
    )];
    if let (Some(work), Some(nanoseconds)) = (base.work(), base.nanoseconds_per_visit()) {
        let memory = base.figure("estimated_memory_bytes");
        lines.push(format!(
            "  {} evaluations of the internal force, {nanoseconds:.1} ns per point and neighbour; \
             estimated memory {} MB",
            work.force_evaluations,
            memory.map_or("–".into(), |bytes| format!("{:.0}", bytes / 1e6))
        ));
    }
    lines.push(
        "  The parts do not add up to the total: they have signs, and a part that is estimated by \
         a change of the solution includes only what this change affects."
            .into(),
    );
    lines
}

/// The report.
pub fn budget_study(budget: &ErrorBudget, command: &str) -> Study {
    let source = &budget.source;
    let mut study = Study {
        id: format!("budget-{}", source.name),
        title: format!("Error budget: {}", source.case.title),
        claim: "Where the error comes from, and what it costs to make each part smaller.".into(),
        command: command.to_string(),
        ..Study::default()
    };
    let mut rows = rows(budget);
    rows.push((TOTAL, Some(budget.total.rms), Some(1.0), budget.reference.source.clone()));
    let cells = |(name, size, cost, how): Row| {
        let size = optional(size.map(|size| 100.0 * size));
        vec![Cell::Text(name.into()), size, optional(cost), Cell::Text(how)]
    };
    study.tables.push(Table {
        title: "Parts of the error".into(),
        columns: vec![
            text("part"),
            number("size", "%"),
            number("CPU time of that run over that of the case", "1"),
            text("how it is estimated"),
        ],
        rows: rows.into_iter().map(cells).collect(),
    });
    study.figures.push(Figure::Plot(figure(budget)));
    study.notes.extend(head(budget).iter().chain(&cost(budget)).map(|l| l.trim().to_string()));
    study
}

/// Each part over the cost of the run that shows it.
fn figure(budget: &ErrorBudget) -> Plot {
    let point = |name: &str, cost: f64, size: f64| {
        styled(name, vec![(cost, 100.0 * size)], SeriesStyle::Points)
    };
    let parts = budget.parts.iter().filter_map(|measured| {
        let size = measured.size.filter(|size| *size > 0.0)?;
        Some(point(measured.part.name, measured.cost, size))
    });
    let mut series: Vec<_> = parts.collect();
    let mut total = point(TOTAL, 1.0, budget.total.rms);
    total.error_bars = vec![100.0 * budget.total.bar];
    series.push(total);
    Plot {
        title: "Size of each part over the cost of its run".into(),
        caption: "CPU time of the run in which a part is made smaller, over that of the case. \
                  Parts to the upper left are worth paying for."
            .into(),
        x: axis("CPU time over that of the case", "1", true),
        y: axis("part of the error", "%", true),
        series,
        slopes: Vec::new(),
    }
}
