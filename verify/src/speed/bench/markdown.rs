//! The measurements as Markdown tables.

use super::figures::Figures;
use std::fmt::Write;

struct Table {
    text: String,
}

impl Table {
    /// The first column is text, the others are numbers.
    fn new(columns: &[&str]) -> Table {
        let mut text = format!("| {} |\n|---", columns.join(" | "));
        text += &"|--:".repeat(columns.len() - 1);
        Table { text: text + "|\n" }
    }

    fn row(&mut self, cells: &[String]) {
        let _ = writeln!(self.text, "| {} |", cells.join(" | "));
    }
}

/// All tables below a description of the machine.
pub fn to_markdown(figures: &Figures) -> String {
    [
        header(figures),
        limits(figures),
        force(figures),
        ratios(figures),
        set_up(figures),
        steps(figures),
        large(figures),
        cases(figures),
    ]
    .join("\n")
}

fn header(figures: &Figures) -> String {
    let p = &figures.provenance;
    let load = figures.load_average.map_or("unknown".into(), |load| format!("{load:.2}"));
    let (second, last) = figures.caches;
    format!(
        "### mtled bench{}\n\n{}, {} threads, features: {}, L2 {} KiB, L3 {} MiB; load average at the start \
         {load}; mtled {} ({}), {}, {}. Medians of {} rounds that alternate with what they are compared with: \
         CPU time on one thread, wall time on several.\n",
        if figures.quick { " --quick" } else { "" },
        p.processor,
        p.threads,
        p.processor_features,
        second >> 10,
        last >> 20,
        p.version,
        p.commit,
        p.compiler,
        p.date,
        figures.rounds
    )
}

fn limits(figures: &Figures) -> String {
    let l = &figures.limits;
    let mut table = Table::new(&["limit of the machine", "value"]);
    table.row(&["triad, one thread".into(), gigabytes(l.triad[0])]);
    table.row(&[format!("triad, {} threads", figures.provenance.threads), gigabytes(l.triad[1])]);
    let name = format!("multiply-adds, one thread, {} lanes", l.lanes);
    table.row(&[name, format!("{:.1} Gflop/s", l.multiply_adds / 1e9)]);
    table.text
}

fn force(figures: &Figures) -> String {
    let mut table = Table::new(&[
        "internal force, one thread",
        "points",
        "neighbours",
        "MB streamed",
        "ns per point and neighbour",
        "plain loop, ns",
        "plain over solver",
        "GB/s",
        "of the triad",
        "of the multiply-adds",
    ]);
    for row in &figures.force {
        let projection = if row.projected { "" } else { ", no projection" };
        table.row(&[
            format!("{}{projection}", row.memory),
            row.points.to_string(),
            format!("{:.1}", row.neighbours),
            format!("{:.1}", row.bytes as f64 / 1e6),
            format!("{:.2}", row.nanoseconds_per_neighbour),
            format!("{:.2}", row.plain_nanoseconds_per_neighbour),
            format!("{:.2}", row.plain_over_solver),
            format!("{:.1}", row.bytes_per_second / 1e9),
            row.fraction_of_triad.map_or("–".into(), |fraction| format!("{fraction:.2}")),
            format!("{:.2}", row.fraction_of(figures.limits.multiply_adds)),
        ]);
    }
    table.text
}

fn ratios(figures: &Figures) -> String {
    let columns = ["internal force", "points", "neighbours", "ms", "ms", "ratio"];
    let mut table = Table::new(&columns);
    for row in &figures.ratios {
        let [first, second] = row.seconds.map(milliseconds);
        let neighbours = format!("{:.1}", row.neighbours);
        let ratio = format!("{:.2}", row.ratio);
        table.row(&[row.label.into(), row.points.to_string(), neighbours, first, second, ratio]);
    }
    table.text
}

fn set_up(figures: &Figures) -> String {
    let s = &figures.set_up;
    let mut text = Table::new(&[
        &format!(
            "set-up, one thread, {} nodes, {} points, {:.1} neighbours",
            s.nodes, s.points, s.neighbours
        ) as &str,
        "ms",
        "µs per point",
        "force evaluations",
    ]);
    let mut row = |name: &str, seconds: f64| {
        text.row(&[
            name.to_string(),
            milliseconds(seconds),
            format!("{:.2}", 1e6 * seconds / s.points as f64),
            format!("{:.1}", seconds / s.force_evaluation),
        ]);
    };
    row("nodes", s.node_cloud);
    row("quadrature", s.quadrature);
    row("neighbours and moving least squares", s.shape_functions);
    row(
        &format!("gradients of second order, {} iterations", s.correction_iterations),
        s.correction,
    );
    row("masses, conditions, loads, blocks", s.model);
    row(&format!("critical step, {} evaluations", s.critical_step_evaluations), s.critical_step);
    row("total", s.total());
    row("one evaluation of the internal force", s.force_evaluation);
    text.text
}

fn steps(figures: &Figures) -> String {
    let all = format!("ms, {} threads", figures.provenance.threads);
    let columns = ["time step", "nodes", "points", "neighbours", "ms, one thread", &all];
    let mut table = Table::new(&columns);
    for row in &figures.steps {
        let [one, all] = row.seconds.map(milliseconds);
        let neighbours = format!("{:.1}", row.neighbours);
        let (nodes, points) = (row.nodes.to_string(), row.points.to_string());
        table.row(&[row.label.clone(), nodes, points, neighbours, one, all]);
    }
    table.text
}

fn large(figures: &Figures) -> String {
    let l = &figures.large;
    let all = format!("step, ms, {} threads", figures.provenance.threads);
    let mut table = Table::new(&[
        "a large body",
        "neighbours",
        "set-up, s",
        &all,
        "peak memory, MB",
        "bytes per point at the peak",
        "bytes per node at the peak",
        "bytes streamed per point",
    ]);
    let each = |count: usize| {
        l.peak_bytes.map_or("–".into(), |bytes| format!("{:.0}", bytes as f64 / count as f64))
    };
    table.row(&[
        format!("{} nodes, {} points", l.nodes, l.points),
        format!("{:.1}", l.neighbours),
        format!("{:.1}", l.set_up_seconds),
        milliseconds(l.step_seconds),
        l.peak_bytes.map_or("–".into(), |bytes| format!("{:.0}", bytes as f64 / 1e6)),
        each(l.points),
        each(l.nodes),
        format!("{:.0}", l.bytes_streamed_per_point),
    ]);
    table.text
}

fn cases(figures: &Figures) -> String {
    let mut table = Table::new(&[
        "case, one thread",
        "nodes",
        "points",
        "force evaluations",
        "set-up, s",
        "solution, s",
        "CPU, s",
    ]);
    for row in &figures.cases {
        table.row(&[
            row.name.clone(),
            row.nodes.to_string(),
            row.points.to_string(),
            row.force_evaluations.to_string(),
            format!("{:.2}", row.set_up_seconds),
            format!("{:.2}", row.solve_seconds),
            format!("{:.2}", row.cpu_seconds),
        ]);
    }
    table.text
}

fn milliseconds(seconds: f64) -> String {
    format!("{:.3}", 1e3 * seconds)
}

fn gigabytes(rate: f64) -> String {
    format!("{:.1} GB/s", rate / 1e9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_a_table_has_the_cells_of_its_heading() {
        let mut table = Table::new(&["what", "one", "two"]);
        table.row(&["a".into(), "1".into(), "2".into()]);
        let bars: Vec<usize> = table.text.lines().map(|line| line.matches('|').count()).collect();
        assert_eq!(bars, [4, 4, 4]);
    }
}
