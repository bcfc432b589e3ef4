//! One page for people that works offline, in print and on small screens.

use super::change::{breakable, change_values, verdict_counts};
use super::labels::{counts, duration, plural, result_line, study_counts, unit_text};
use super::number::{bound_text, four_digits};
use super::svg;
use crate::escape::printable_lines;
use crate::study::{
    Bound, Cell, Change, Check, Comparison, Figure, Kind, Provenance, Report, Study, Table, Verdict,
};
use minijinja::{Environment, Value, context};

/// Texts with more bytes get a wide column.
const LONG: usize = 24;

/// The study whose drawings are at the top of the page.
const DRAWN: &str = "brain";
/// Studies whose first plot is, of error against cost.
const PARETO: [&str; 2] = ["race", "tune"];

/// Style and script of every page.
pub(super) const STYLE: &str = include_str!("page/page.css");
pub(super) const SCRIPT: &str = include_str!("page/page.js");

/// The templates of all pages.
pub(super) fn pages() -> anyhow::Result<Environment<'static>> {
    let mut pages = Environment::new();
    pages.add_template("shared.html", include_str!("page/shared.html"))?;
    pages.add_template("index.html", include_str!("page/index.html"))?;
    pages.add_template("compare.html", include_str!("page/compare.html"))?;
    Ok(pages)
}

/// The page as one file without links to other files.
pub fn to_html(report: &Report) -> anyhow::Result<String> {
    let studies: Vec<Value> = report.studies.iter().map(study_value).collect();
    let failures: Vec<Value> =
        report.checks().filter(|check| !check.pass).map(check_value).collect();
    let page = context! {
        style => Value::from_safe_string(format!("{STYLE}{}", svg::STYLE)),
        script => Value::from_safe_string(SCRIPT.to_string()),
        suite => report.suite.as_str(),
        passed => report.passed(),
        failed => !report.bounds_hold(),
        compared => report.comparison.as_ref().map(comparison_value),
        verdict => result_line(report),
        judged => report.checks().next().is_some(),
        kinds => kind_values(report),
        failures => failures,
        hero => hero_values(report),
        studies => studies,
        provenance => provenance_values(report),
        date => report.provenance.date.as_str(),
        version => report.provenance.version.as_str(),
        commit => report.provenance.commit.as_str(),
        wall => duration(report.wall_seconds),
        machine => machine(&report.provenance),
    };
    Ok(printable_lines(&pages()?.get_template("index.html")?.render(page)?))
}

fn study_value(study: &Study) -> Value {
    let (passed, all) = study_counts(study);
    let below = study.figures.iter().filter(|figure| !is_hero(study, figure));
    let figures: Vec<Value> = below.map(figure_value).collect();
    context! {
        id => study.id.as_str(),
        title => study.title.as_str(),
        claim => study.claim.as_str(),
        command => study.command.as_str(),
        failure => study.failure.as_deref(),
        pass => study.passed(),
        counts => if all == 0 { "figures only".into() } else { format!("{passed} of {all}") },
        checks => study.checks.iter().map(check_value).collect::<Vec<_>>(),
        tables => study.tables.iter().map(table_value).collect::<Vec<_>>(),
        figures => figures,
        notes => study.notes.iter().map(Value::from).collect::<Vec<_>>(),
        above => study.figures.iter().any(|figure| is_hero(study, figure)),
        wall => duration(study.wall_seconds),
    }
}

fn check_value(check: &Check) -> Value {
    let limit = match check.bound {
        Bound::AtMost(limit) | Bound::AtLeast(limit) => limit,
        Bound::Between(low, high) => 0.5 * (low + high),
    };
    context! {
        id => check.id.as_str(),
        breakable_id => breakable(&check.id),
        study => check.study.as_str(),
        quantity => check.quantity.as_str(),
        kind => check.kind.name(),
        value => four_digits(check.value),
        value_key => check.value.to_string(),
        bound => bound_text(&check.bound),
        bound_key => limit.to_string(),
        unit => unit_text(&check.unit),
        pass => check.pass,
        source => check.source.as_str(),
        file => check.failure_file().map(|file| Value::from_safe_string(svg::escape(&file))),
    }
}

fn comparison_value(comparison: &Comparison) -> Value {
    let (same, changes): (Vec<&Change>, Vec<&Change>) =
        comparison.changes.iter().partition(|change| change.verdict == Verdict::Same);
    context! {
        with => comparison.with.as_str(),
        summary => verdict_counts(comparison),
        holds => comparison.holds(),
        changes => change_values(&changes),
        same => change_values(&same),
    }
}

fn table_value(table: &Table) -> Value {
    let is_number =
        |index: usize| table.rows.iter().any(|row| matches!(row.get(index), Some(Cell::Number(_))));
    let columns: Vec<Value> = table
        .columns
        .iter()
        .enumerate()
        .map(|(index, column)| {
            let unit = if column.unit == "1" { "" } else { column.unit.as_str() };
            context! { name => column.name.as_str(), unit => unit, number => is_number(index) }
        })
        .collect();
    let rows: Vec<Value> = table
        .rows
        .iter()
        .map(|row| Value::from(row.iter().map(cell_value).collect::<Vec<_>>()))
        .collect();
    context! { title => table.title.as_str(), columns => columns, rows => rows }
}

fn cell_value(cell: &Cell) -> Value {
    match cell {
        // NaN in a table stands for a figure that does not exist.
        Cell::Number(number) if number.is_nan() => {
            context! { text => "–", key => "NaN", number => true }
        }
        Cell::Number(number) => {
            context! { text => four_digits(*number), key => number.to_string(), number => true }
        }
        Cell::Text(text) => {
            context! { text => text, key => text, number => false, long => text.len() > LONG }
        }
    }
}

fn figure_value(figure: &Figure) -> Value {
    let (title, caption) = match figure {
        Figure::Plot(plot) => (&plot.title, &plot.caption),
        Figure::Drawing(drawing) => (&drawing.title, &drawing.caption),
    };
    context! {
        title => title,
        caption => caption,
        svg => Value::from_safe_string(svg::to_svg(figure)),
    }
}

fn hero_values<'a>(report: &'a Report) -> Vec<Value> {
    let of_study =
        |study: &'a Study| study.figures.iter().filter(move |figure| is_hero(study, figure));
    let mut heroes: Vec<&Figure> = report.studies.iter().flat_map(of_study).collect();
    heroes.sort_by_key(|figure| matches!(figure, Figure::Drawing(_)));
    heroes.into_iter().map(figure_value).collect()
}

/// Whether a figure is shown at the top of the page only.
fn is_hero(study: &Study, figure: &Figure) -> bool {
    match figure {
        Figure::Drawing(_) => study.id == DRAWN,
        Figure::Plot(_) => {
            let first = study.figures.iter().find(|f| matches!(f, Figure::Plot(_)));
            PARETO.contains(&study.id.as_str()) && first.is_some_and(|f| std::ptr::eq(f, figure))
        }
    }
}

/// Passed and all checks of each kind, with what the kind means.
fn kind_values(report: &Report) -> Vec<Value> {
    let kinds = [
        (Kind::Exact, "closed forms and theorems"),
        (Kind::Reference, "published or finite-element values"),
        (Kind::Regression, "our own earlier figures"),
    ];
    kinds
        .into_iter()
        .filter(|(kind, _)| report.checks().any(|check| check.kind == *kind))
        .map(|(kind, meaning)| {
            let of_kind = report.checks().filter(|check| check.kind == kind);
            let (passed, all) = counts(of_kind.map(|check| check.pass));
            context! { name => kind.name(), meaning, passed, all, pass => passed == all }
        })
        .collect()
}

/// `AMD EPYC, 2 threads`.
pub(super) fn machine(p: &Provenance) -> String {
    format!("{}, {} {}", p.processor, p.threads, plural(p.threads, "thread", "threads"))
}

fn provenance_values(report: &Report) -> Vec<Value> {
    let p = &report.provenance;
    let rows = [
        ("Version", p.version.clone()),
        ("Commit", p.commit.clone()),
        ("Compiler", p.compiler.clone()),
        ("Processor", machine(p)),
        ("Features", p.processor_features.clone()),
        ("Date", p.date.clone()),
        ("Wall time", duration(report.wall_seconds)),
    ];
    let known = rows.into_iter().filter(|(_, value)| !value.is_empty());
    known.map(|(name, value)| context! { name, value }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn the_page_needs_nothing_from_outside() {
        let page = to_html(&sample::report()).unwrap();
        for link in ["href=\"http", "src=", "url(", "@import", "<link"] {
            assert!(!page.contains(link), "{link}");
        }
        assert!(page.contains("<html lang=\"en\">") && page.contains("<title>"));
    }

    #[test]
    fn control_characters_of_a_title_are_shown_as_escapes() {
        let mut report = sample::report();
        report.studies[0].title = "a\u{1b}[31mb".into();
        let page = to_html(&report).unwrap();
        assert!(page.contains("a\\u{1b}[31mb") && !page.contains('\u{1b}'));
    }

    #[test]
    fn the_verdict_and_the_failures_come_before_the_studies() {
        let page = to_html(&sample::report()).unwrap();
        let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is missing"));
        assert!(at("9 of 11 checks passed") < at("id=\"failures\""));
        assert!(at("id=\"failures\"") < at("id=\"contents\""));
        assert!(at("id=\"contents\"") < at("id=\"study-patch\""));
    }

    #[test]
    fn what_got_worse_comes_first_and_a_failure_links_its_case_file() {
        let page = to_html(&sample::compared()).unwrap();
        let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is missing"));
        assert!(at("failures/brain-tumour-shift.toml") < at("id=\"compared\""));
        assert!(at("1 worse, 1 missing, 1 new, 1 improved, 1 the same") < at("id=\"failures\""));
        let verdicts = ["worse", "missing", "new", "improved", "same"];
        let places = verdicts.map(|verdict| at(&format!("<span class=\"chip {verdict}\">")));
        assert!(places.is_sorted(), "{places:?}");
        assert!(at("id=\"compared\"") < at("id=\"pictures\""));
    }

    #[test]
    fn without_scripts_there_is_no_button_that_does_nothing() {
        let page = to_html(&sample::compared()).unwrap();
        assert!(!page.split("<script>").next().unwrap().contains("<button"));
        let tables = page.matches("<table").count();
        assert_eq!(page.matches("<table data-file=").count(), tables);
        assert_eq!(page.matches("<caption>").count(), tables);
    }

    #[test]
    fn texts_are_escaped() {
        let page = to_html(&sample::report()).unwrap();
        assert!(page.contains("h &lt; 1 &amp; more"));
        assert!(!page.contains("h < 1 & more"));
    }

    #[test]
    fn no_text_of_a_report_becomes_an_element() {
        let mut report = sample::compared();
        let evil = "\"'><script>evil</script>";
        for study in &mut report.studies {
            (study.id, study.title, study.claim) = (evil.into(), evil.into(), evil.into());
            (study.command, study.notes) = (evil.into(), vec![evil.into()]);
            for check in &mut study.checks {
                (check.id, check.quantity, check.unit) = (evil.into(), evil.into(), evil.into());
            }
            for table in &mut study.tables {
                (table.title, table.columns[0].name) = (evil.into(), evil.into());
                table.rows.iter_mut().for_each(|row| row[0] = Cell::Text(evil.into()));
            }
        }
        report.suite = evil.into();
        report.provenance.commit = evil.into();
        report.comparison.as_mut().unwrap().with = evil.into();
        let page = to_html(&report).unwrap();
        assert!(page.contains("evil") && !page.contains("<script>evil"));
    }

    #[test]
    fn a_report_without_studies_is_a_page() {
        assert!(to_html(&sample::empty()).unwrap().contains("Figures only"));
    }
}
