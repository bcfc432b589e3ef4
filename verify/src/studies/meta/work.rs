//! Work counters of carried cases against our own earlier ones.

use crate::run::{Work, solve_case};
use crate::studies::workbench::Workbench;
use mtled_checks::study::shorthand::{number, text};
use mtled_checks::study::{Bound, Cell, Check, Kind, Study, Table};
use rayon::prelude::*;

/// What a case took before.
struct Earlier {
    case: &'static str,
    points: usize,
    neighbours: usize,
    evaluations: usize,
    correction: usize,
}

/// Of 2026-11-21; statics, a plane, free flight under gravity, contact.
const EARLIER: &[Earlier] = &[
    Earlier {
        case: "brain_slice",
        points: 3058,
        neighbours: 32_586,
        evaluations: 4643,
        correction: 10,
    },
    Earlier {
        case: "cube_compression",
        points: 1331,
        neighbours: 27_791,
        evaluations: 651,
        correction: 8,
    },
    Earlier {
        case: "uniaxial_bar",
        points: 936,
        neighbours: 18_608,
        evaluations: 605,
        correction: 9,
    },
    Earlier {
        case: "falling_beam",
        points: 1488,
        neighbours: 30_996,
        evaluations: 193,
        correction: 8,
    },
    Earlier {
        case: "cook_membrane",
        points: 638,
        neighbours: 6076,
        evaluations: 877,
        correction: 9,
    },
];

/// Evaluations may grow by this share: round-off moves the looks at the
/// tangent and the steps until a tolerance is met.
const MARGIN: f64 = 0.02;
/// Iterations of the correction may grow by so many.
const ITERATIONS: usize = 1;
/// Bytes per neighbour: three gradient components and an index, and the share
/// by which padding may widen them.
const BYTES: [(usize, f64); 2] = [(2, 20.0), (3, 28.0)];
const PADDING: f64 = 0.2;

/// What a case takes now.
struct Now {
    components: usize,
    points: usize,
    neighbours: usize,
    work: Work,
}

pub fn work(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let measure = |earlier: &Earlier| -> anyhow::Result<Now> {
        let (solved, _) = solve_case(&bench.stated_case(earlier.case)?)?;
        let supports = &solved.prepared.discretisation.supports;
        Ok(Now {
            components: solved.prepared.model.components,
            points: supports.len(),
            neighbours: supports.nodes.len(),
            work: Work::of(&solved),
        })
    };
    let measured: Result<Vec<Now>, _> = EARLIER.par_iter().map(measure).collect();
    let measured = measured?;
    for (earlier, now) in EARLIER.iter().zip(&measured) {
        compare(study, earlier, now);
    }
    study.tables.push(table(&measured));
    Ok(())
}

fn compare(study: &mut Study, earlier: &Earlier, now: &Now) {
    let source = format!("{} of 2026-11-21", earlier.case);
    let mut check = |quantity: &str, words: &str, value: usize, bound: Bound| {
        let id = format!("work/{}/{quantity}", earlier.case);
        let words = format!("{}: {words}", earlier.case);
        let check = Check::new(&id, &words, Kind::Regression, value as f64, bound, "1", &source);
        study.checks.push(check);
    };
    let same = |count: usize| Bound::Between(count as f64, count as f64);
    let most = |count: usize| Bound::AtMost((count as f64 * (1.0 + MARGIN)).ceil());
    check("points", "quadrature points", now.points, same(earlier.points));
    check("neighbours", "support entries", now.neighbours, same(earlier.neighbours));
    check(
        "evaluations",
        "evaluations of the internal force",
        now.work.force_evaluations,
        most(earlier.evaluations),
    );
    check(
        "correction",
        "iterations for the gradients",
        now.work.correction_iterations,
        Bound::AtMost((earlier.correction + ITERATIONS) as f64),
    );
    let wanted = BYTES.iter().find(|(components, _)| *components == now.components);
    let bytes = wanted.map_or(0.0, |(_, bytes)| bytes * (1.0 + PADDING));
    study.checks.push(Check::new(
        &format!("work/{}/bytes", earlier.case),
        &format!("{}: bytes read per neighbour", earlier.case),
        Kind::Regression,
        now.work.bytes_streamed as f64 / now.work.neighbour_visits as f64,
        Bound::AtMost(bytes),
        "1",
        "8 bytes per component and 4 per index, a fifth more for padding",
    ));
}

fn table(measured: &[Now]) -> Table {
    let counts = [
        "points",
        "neighbours",
        "steps",
        "evaluations of the internal force",
        "for the critical step",
        "iterations for the gradients",
        "points visited",
        "neighbours visited",
        "bytes read",
    ];
    let row = |(earlier, now): (&Earlier, &Now)| {
        let work = &now.work;
        let numbers = [
            now.points,
            now.neighbours,
            work.steps,
            work.force_evaluations,
            work.lanczos_evaluations,
            work.correction_iterations,
            work.point_evaluations,
            work.neighbour_visits,
            work.bytes_streamed,
        ];
        let mut cells = vec![Cell::Text(earlier.case.into())];
        cells.extend(numbers.map(|count| Cell::Number(count as f64)));
        cells
    };
    let mut columns = vec![text("case")];
    columns.extend(counts.map(|name| number(name, "1")));
    Table {
        title: "Work of carried cases".into(),
        columns,
        rows: EARLIER.iter().zip(measured).map(row).collect(),
    }
}
