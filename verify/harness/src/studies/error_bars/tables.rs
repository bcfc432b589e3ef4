//! Tables and the figure of the study.

use super::answers::{Answered, USEFUL, Verdict};
use super::subjects::Set;
use mtled_case::reference::Family;
use mtled_checks::study::{
    Cell, Column, Plot, SeriesStyle, Table, axis, line, number, styled, text,
};

/// How many answers of a kind have which verdict.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    pub judged: usize,
    pub within: usize,
    pub useful: usize,
    pub in_words: usize,
    pub unknown: usize,
    pub negligible: usize,
}

impl Counts {
    /// Of the answers that `chosen` accepts by set and family.
    pub(crate) fn of(all: &[Answered], chosen: &dyn Fn(Set, Family) -> bool) -> Counts {
        let mut counts = Counts::default();
        for subject in all {
            for answer in subject.answers.iter().filter(|a| chosen(subject.set, a.family)) {
                match answer.verdict() {
                    Verdict::Judged { within, useful } => {
                        counts.judged += 1;
                        counts.within += usize::from(within);
                        counts.useful += usize::from(useful);
                    }
                    Verdict::InWords => counts.in_words += 1,
                    Verdict::Unknown => counts.unknown += 1,
                    Verdict::Negligible => counts.negligible += 1,
                }
            }
        }
        counts
    }

    /// Fraction of the judged answers with an error within the bar \[–\].
    pub(crate) fn within(&self) -> f64 {
        self.within as f64 / self.judged as f64
    }

    /// Fraction of the judged answers with a bar within a factor of 3 of the error \[–\].
    pub(crate) fn useful(&self) -> f64 {
        self.useful as f64 / self.judged as f64
    }
}

/// A set in reports and checks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    pub set: Set,
    /// In ids of checks.
    pub id: &'static str,
    pub label: &'static str,
    /// Least fractions of errors within their bars and of bars within a factor of 3, in
    /// the quick suite \[–\].
    pub quick: [f64; 2],
    /// The same in the full suite \[–\].
    pub full: [f64; 2],
}

/// The sets and what they must reach.
pub(crate) const SETS: [Row; 4] = [
    Row {
        set: Set::Bundled,
        id: "bundled",
        label: "bundled cases (the factors were set on them)",
        quick: [0.92, 0.33],
        full: [0.92, 0.42],
    },
    Row {
        set: Set::KnownBodies,
        id: "known_bodies",
        label: "made-up bodies (the factors were set on them)",
        quick: [0.9, 0.25],
        full: [0.88, 0.46],
    },
    Row {
        set: Set::Manufactured,
        id: "manufactured",
        label: "manufactured fields (the factors of bodies held all around were set on them)",
        quick: [0.8, 0.5],
        full: [0.88, 0.7],
    },
    Row {
        set: Set::NewBodies,
        id: "new_bodies",
        label: "other made-up bodies",
        quick: [0.8, 0.1],
        full: [0.9, 0.4],
    },
];

/// Those that no factor was set on.
pub(crate) const CHECKED_ON: [Set; 1] = [Set::NewBodies];

/// Families that share a row.
const FAMILIES: [(&str, &[Family]); 4] = [
    ("displacements", &[Family::Displacement]),
    ("forces", &[Family::Force]),
    ("moments", &[Family::Moment]),
    ("energies", &[Family::StrainEnergy, Family::KineticEnergy]),
];

/// Counts by set and family.
pub(crate) fn counts_table(all: &[Answered]) -> Table {
    let mut rows = Vec::new();
    let mut row = |set: &str, family: &str, counts: Counts| {
        let mut cells = vec![Cell::Text(set.into()), Cell::Text(family.into())];
        cells.push(Cell::Number(counts.judged as f64));
        cells.push(Cell::Number(100.0 * counts.within()));
        cells.push(Cell::Number(100.0 * counts.useful()));
        let rest = [counts.in_words, counts.unknown, counts.negligible];
        cells.extend(rest.map(|count| Cell::Number(count as f64)));
        rows.push(cells);
    };
    for Row { set, label, .. } in SETS {
        let counts = Counts::of(all, &|s, _| s == set);
        if counts.judged > 0 {
            row(label, "all", counts);
        }
        for (name, families) in FAMILIES {
            let counts = Counts::of(all, &|s, f| s == set && families.contains(&f));
            if counts.judged > 0 {
                row(label, name, counts);
            }
        }
    }
    Table {
        title: "How often the bars hold".into(),
        columns: vec![
            text("set"),
            text("answers"),
            number("judged", "1"),
            number("error within the bar", "%"),
            number("bar within a factor of 3 of the error", "%"),
            number("no bar but words", "1"),
            number("value not known well enough", "1"),
            number("next to nothing", "1"),
        ],
        rows,
    }
}

/// What the bars of every subject cost.
pub(crate) fn cost_table(all: &[Answered]) -> Table {
    let row = |subject: &Answered| {
        vec![
            Cell::Text(subject.name.clone()),
            Cell::Number(subject.run_seconds),
            Cell::Number(subject.cpu),
            Cell::Number(subject.work),
        ]
    };
    Table {
        title: "Cost of the bars".into(),
        columns: vec![
            text("case"),
            number("CPU time of the run", "s"),
            number("CPU time of the bars over that of the run", "1"),
            number("neighbours visited for the bars over those of the run", "1"),
        ],
        rows: all.iter().map(row).collect(),
    }
}

/// Every answer.
pub(crate) fn answers_table(all: &[Answered]) -> Table {
    let rows = all.iter().flat_map(|subject| {
        subject.answers.iter().map(|answer| {
            let (bar, verdict) = match (&answer.bar, answer.verdict()) {
                (Err(reason), _) => (f64::NAN, reason.to_string()),
                (Ok(bar), Verdict::Judged { within, useful }) => {
                    let verdict = match (within, useful) {
                        (true, true) => "holds",
                        (true, false) => "holds, too long",
                        (false, true) => "too short",
                        (false, false) => "much too short",
                    };
                    (*bar, verdict.to_string())
                }
                (Ok(bar), Verdict::Negligible) => (*bar, "next to nothing".to_string()),
                (Ok(bar), _) => (*bar, "value not known well enough".to_string()),
            };
            vec![
                Cell::Text(subject.name.clone()),
                Cell::Text(answer.quantity.clone()),
                Cell::Text(answer.family.unit().into()),
                Cell::Number(answer.error),
                Cell::Number(bar),
                Cell::Number(answer.known),
                Cell::Text(verdict),
            ]
        })
    });
    Table { title: "Every answer".into(), columns: columns(), rows: rows.collect() }
}

fn columns() -> Vec<Column> {
    vec![
        text("case"),
        text("answer"),
        text("unit"),
        number("error", ""),
        number("bar", ""),
        number("error of the known value", ""),
        text("verdict"),
    ]
}

/// Bar over error, over the error, where the factors were not set.
pub(crate) fn figure(all: &[Answered]) -> Plot {
    let points = |set: Set, families: &[Family]| -> Vec<(f64, f64)> {
        let subjects = all.iter().filter(|subject| subject.set == set);
        let answers = subjects.flat_map(|subject| &subject.answers);
        let judged = answers.filter(|answer| {
            families.contains(&answer.family)
                && answer.error > 0.0
                && matches!(answer.verdict(), Verdict::Judged { .. })
        });
        let point = |answer: &super::answers::Answer| {
            let bar = answer.bar.as_ref().ok()?;
            Some((answer.error / answer.largest, bar / answer.error))
        };
        judged.filter_map(point).collect()
    };
    let mut series = Vec::new();
    for Row { set, label, .. } in SETS.into_iter().filter(|row| CHECKED_ON.contains(&row.set)) {
        for (name, families) in FAMILIES {
            let points = points(set, families);
            if !points.is_empty() {
                series.push(styled(&format!("{label}: {name}"), points, SeriesStyle::Points));
            }
        }
    }
    let all_points = || series.iter().flat_map(|series| &series.points);
    let low = all_points().map(|point| point.0).fold(f64::INFINITY, f64::min);
    let high = all_points().map(|point| point.0).fold(0.0, f64::max);
    if low < high {
        series.push(line("bar = error", vec![(low, 1.0), (high, 1.0)]));
        series.push(line("bar = 3 errors", vec![(low, USEFUL), (high, USEFUL)]));
    }
    Plot {
        title: "Error bars over errors, on cases that no factor was set on".into(),
        caption:
            "Points above the lower line are errors within their bars; those between the lines \
                  have bars of use."
                .into(),
        x: axis("error over the largest value of its kind", "1", true),
        y: axis("error bar over the error", "1", true),
        series,
        slopes: Vec::new(),
    }
}
