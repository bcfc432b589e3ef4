use super::to_html;
use crate::report::sample;
use crate::study::Cell;

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

#[test]
fn checks_that_pass_are_folded_away_and_those_that_fail_are_not() {
    let page = to_html(&sample::report()).unwrap();
    let mut folded = String::new();
    for part in page.split("<details>").skip(1) {
        folded += part.split("</details>").next().unwrap();
    }
    let row = |id: &str| format!("<code class=\"id\">{id}</code>");
    let (failing, passing) = (row("brain/<wbr>tumour/<wbr>shift"), row("brain/<wbr>step"));
    assert!(page.contains(&failing) && !folded.contains(&failing));
    assert!(folded.contains(&passing));
    assert!(!page.contains("<details open"));
}

#[test]
fn the_first_leading_figure_is_beside_the_result_and_the_others_before_the_studies() {
    let page = to_html(&sample::report()).unwrap();
    let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is missing"));
    assert!(at("Time of another code over ours") < at("</header>"));
    assert!(at("</header>") < at("id=\"failures\""));
    let titles = ["Error over time", "Brain slice under a 10 mm indentation", "Ventricles"];
    let mut places = vec![at("id=\"pictures\"")];
    places.extend(titles.map(|title| at(&format!("<span class=\"title\">{title}"))));
    places.push(at("id=\"contents\""));
    assert!(places.is_sorted(), "{places:?}");
    assert!(at("<span class=\"title\">Displacement") > at("id=\"study-brain\""));
}

#[test]
fn there_is_a_row_per_study() {
    let page = to_html(&sample::report()).unwrap();
    let table = page.split("data-file=\"studies\"").nth(1).unwrap().split("</table>").next();
    assert_eq!(table.unwrap().matches("<tr").count(), 1 + sample::report().studies.len());
}

#[test]
fn where_nothing_changed_the_pictures_come_first() {
    let mut report = sample::compared();
    let same = |change: &crate::study::Change| change.verdict == crate::study::Verdict::Same;
    report.comparison.as_mut().unwrap().changes.retain(same);
    let page = to_html(&report).unwrap();
    assert!(page.find("id=\"pictures\"") < page.find("id=\"compared\""));
}
