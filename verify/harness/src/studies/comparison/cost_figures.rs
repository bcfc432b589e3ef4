//! Error over processor time as figures and as a table.

use crate::studies::comparison::costs::{Costs, Ratio};
use mtled_case::reference::{CODES, title_of};
use mtled_checks::report::four_digits;
use mtled_checks::study::{
    Cell, Figure, Panels, Plot, Series, SeriesStyle, Table, axis, curve, line, names_axis, number,
    styled, text,
};

/// Colours, the same in all figures.
const OWN: usize = 1;
const OF_CODES: [usize; 2] = [0, 2];
const INK: usize = 6;

/// A name in figures: underscores of file names read as spaces.
fn label(case: &str) -> String {
    case.replace('_', " ")
}

/// Where and when the finite-element runs were made.
fn provenance(costs: &[Costs]) -> String {
    let mut dates: Vec<&str> =
        costs.iter().flat_map(|c| &c.codes).map(|code| code.date.as_str()).collect();
    dates.sort_unstable();
    let when = match (dates.first(), dates.last()) {
        (Some(first), Some(last)) if first == last => format!(" ({first})"),
        (Some(first), Some(last)) => format!(" ({first} to {last})"),
        _ => String::new(),
    };
    format!(
        "mtled: CPU seconds of this run, one thread, set-up included, while other studies ran \
         beside it. Finite elements: stored CPU seconds of one thread, from another machine and \
         other days{when}, so that factors near 1 mean nothing."
    )
}

/// CPU time of each code over that of this solver at equal error, a row per case.
pub(crate) fn times_at_equal_error(costs: &[Costs]) -> Plot {
    let smallest = |costs: &Costs| {
        let ratios = costs.codes.iter().filter_map(|code| costs.ratio(code));
        ratios.map(Ratio::value).fold(f64::INFINITY, f64::min)
    };
    let mut rows: Vec<&Costs> = costs.iter().collect();
    rows.sort_by(|a, b| smallest(b).total_cmp(&smallest(a)));
    let last = rows.len() as f64 - 0.5;
    let mut series = vec![Series {
        colour: Some(INK),
        ..line("the same time as mtled", vec![(1.0, -0.5), (1.0, last)])
    }];
    for (code, colour) in CODES.into_iter().zip(OF_CODES) {
        let kinds = [
            (SeriesStyle::Points, ""),
            (SeriesStyle::AtMost, ", at most"),
            (SeriesStyle::AtLeast, ", at least"),
        ];
        for (style, remark) in kinds {
            let points = rows.iter().enumerate().flat_map(|(row, costs)| {
                let of_code = costs.codes.iter().filter(|known| known.code == code);
                let ratios = of_code.filter_map(|code| costs.ratio(code));
                ratios
                    .filter(|ratio| style_of(*ratio) == style)
                    .map(move |r| (r.value(), row as f64))
            });
            let points: Vec<(f64, f64)> = points.collect();
            if !points.is_empty() {
                let name = format!("{}{remark}", title_of(code));
                series.push(Series { colour: Some(colour), ..styled(&name, points, style) });
            }
        }
    }
    Plot {
        title: "CPU time of finite elements over that of mtled, at equal error".into(),
        caption: format!(
            "Marks right of the line: mtled takes less time for the same error, that of its run \
             or the reference's error bar where that is larger. Arrows are bounds: even the \
             coarsest stored mesh is more accurate than that (at most), or no stored mesh is as \
             accurate (at least). {}",
            provenance(costs)
        ),
        x: axis("CPU time of finite elements over that of mtled", "1", true),
        y: names_axis("case", rows.iter().map(|costs| label(&costs.case)).collect()),
        series,
        slopes: Vec::new(),
    }
}

fn style_of(ratio: Ratio) -> SeriesStyle {
    match ratio {
        Ratio::Equal(_) => SeriesStyle::Points,
        Ratio::AtMost(_) => SeriesStyle::AtMost,
        Ratio::AtLeast(_) => SeriesStyle::AtLeast,
    }
}

/// Error over CPU time, a panel per case.
pub(crate) fn error_over_cost(costs: &[Costs]) -> Panels {
    Panels {
        title: "Error over processor time".into(),
        caption: format!(
            "Across: CPU time [s]. Up: rms difference of displacements from the reference over \
             the largest displacement [–]. All panels have the same axes; lower left is better. \
             The reference is extrapolated from the finite-element meshes shown. Shaded: below \
             its error bar (on the lower edge where that is further down); of the faint points \
             there it is only known that they are below it. The settings of the finite elements \
             were chosen for a sure reference, not for speed. {}",
            provenance(costs)
        ),
        panels: costs.iter().map(|costs| Figure::Plot(panel(costs))).collect(),
    }
}

fn panel(costs: &Costs) -> Plot {
    let own = vec![(costs.own.cpu, costs.own.error)];
    let mut series =
        vec![Series { colour: Some(OWN), ..styled("mtled, this run", own, SeriesStyle::Points) }];
    for (code, colour) in costs.codes.iter().zip(OF_CODES) {
        let points = code.meshes.iter().map(|mesh| (mesh.cpu, mesh.error)).collect();
        series.push(Series { colour: Some(colour), ..curve(title_of(&code.code), points) });
    }
    let floor = vec![(costs.own.cpu, costs.floor)];
    series.push(styled("below the reference's error bar", floor, SeriesStyle::Floor));
    Plot {
        title: label(&costs.case),
        caption: String::new(),
        x: axis("CPU time", "s", true),
        y: axis("error of the displacement", "1", true),
        series,
        slopes: Vec::new(),
    }
}

/// The same in numbers, a row per case.
pub(crate) fn costs_table(costs: &[Costs]) -> Table {
    let ratio = |ratio: Option<Ratio>| match ratio {
        None => Cell::Text("–".into()),
        Some(Ratio::Equal(value)) => Cell::Number(value),
        Some(Ratio::AtMost(value)) => Cell::Text(format!("≤ {}", four_digits(value))),
        Some(Ratio::AtLeast(value)) => Cell::Text(format!("≥ {}", four_digits(value))),
    };
    let row = |costs: &Costs| {
        let mut row = vec![Cell::Text(costs.case.clone())];
        let numbers = [costs.own.cpu, 100.0 * costs.own.error, 100.0 * costs.floor];
        row.extend(numbers.map(Cell::Number));
        row.extend(CODES.map(|code| {
            let known = costs.codes.iter().find(|known| known.code == code);
            ratio(known.and_then(|code| costs.ratio(code)))
        }));
        row
    };
    let mut columns = vec![
        text("case"),
        number("CPU time", "s"),
        number("error of the displacement", "%"),
        number("error bar of the reference", "%"),
    ];
    columns.extend(CODES.map(|code| number(&format!("{} over mtled", title_of(code)), "1")));
    Table {
        title: "Processor time at equal error, finite elements over mtled".into(),
        columns,
        rows: costs.iter().map(row).collect(),
    }
}
