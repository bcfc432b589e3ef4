//! The gate: what is the same, what got worse, and what a baseline remembers.

use mtled_checks::gate::{
    Baseline, Clouds, Reason, compare, compare_runs, difference, settle, update,
};
use mtled_checks::study::{
    BandSource, Better, Bound, Check, Comparison, Kind, Outcome, Provenance, Report, Scale, Study,
    Verdict,
};

/// An error that scatters over clouds, an order, a count, a sum that vanishes
/// but for round-off, and a difference from a reference.
fn figures() -> Vec<Check> {
    let check =
        |id: &str, kind, value, bound| Check::new(id, id, kind, value, bound, "1", "theory");
    let mut difference = check("study/difference", Kind::Reference, 0.008, Bound::AtMost(0.03));
    difference.reference_error = Some(0.01);
    vec![
        check("study/error", Kind::Regression, 0.010, Bound::AtMost(0.05)),
        check("study/order", Kind::Exact, 2.0, Bound::Between(1.5, 2.5)),
        check("study/count", Kind::Regression, 650.0, Bound::AtMost(665.0)),
        check("study/sum", Kind::Exact, 3e-16, Bound::AtMost(1e-12)),
        check("study/smallest", Kind::Regression, 0.8, Bound::AtLeast(0.1)),
        difference,
    ]
}

fn run(checks: Vec<Check>) -> Report {
    let provenance = Provenance {
        version: "0.1.0".into(),
        commit: "abc".into(),
        compiler: "rustc".into(),
        processor: "one".into(),
        processor_features: String::new(),
        threads: 1,
        date: "2026-11-21".into(),
    };
    let study = Study { id: "study".into(), checks, ..Study::default() };
    Report {
        schema_version: 1,
        suite: "quick".into(),
        provenance,
        studies: vec![study],
        wall_seconds: 1.0,
        comparison: None,
    }
}

/// The figures with one of them changed.
fn with(id: &str, value: f64) -> Report {
    let mut checks = figures();
    let place = checks.iter().position(|check| check.id == id).unwrap();
    let Check { quantity, kind, bound, source, .. } = checks[place].clone();
    let error = checks[place].reference_error;
    checks[place] = Check::new(id, &quantity, kind, value, bound, "1", &source);
    checks[place].reference_error = error;
    run(checks)
}

/// Twenty clouds: errors scatter by a tenth, orders by 0.02.
fn clouds() -> Vec<Report> {
    let cloud = |index: usize| {
        let shift = (index as f64 * 2.399_963).sin();
        let mut report = with("study/error", 0.010 * (0.1 * shift).exp());
        report.studies[0].checks[1].value = 2.0 + 0.02 * shift;
        report
    };
    (1..=20).map(cloud).collect()
}

fn reason() -> Reason {
    Reason::new("because").unwrap()
}

fn baseline() -> Baseline {
    update(&run(figures()), None, &Clouds::default(), &reason(), true).unwrap()
}

fn scattered() -> Baseline {
    let clouds = clouds();
    let scatter = Clouds::new(&clouds).unwrap();
    update(&run(figures()), None, &scatter, &reason(), true).unwrap()
}

fn verdict(comparison: &Comparison, id: &str) -> Verdict {
    comparison.changes.iter().find(|change| change.id == id).unwrap().verdict
}

fn judged(baseline: &Baseline, id: &str, value: f64) -> Verdict {
    verdict(&compare(&with(id, value), baseline, true).unwrap(), id)
}

#[test]
fn a_run_is_the_same_as_the_baseline_that_was_made_of_it() {
    for baseline in [baseline(), scattered()] {
        let comparison = compare(&run(figures()), &baseline, true).unwrap();
        assert_eq!(comparison.count(Verdict::Same), 6);
        assert!(comparison.holds());
    }
}

#[test]
fn beyond_the_scatter_over_clouds_is_worse_or_improved_and_within_it_is_the_same() {
    let baseline = scattered();
    let band = baseline.check("study/error").unwrap().band;
    assert_eq!(band.source, BandSource::Scatter);
    assert_eq!(band.scatter.unwrap().samples, 21);
    assert_eq!(band.scatter.unwrap().scale, Scale::Logarithmic);
    assert_eq!(judged(&baseline, "study/error", 0.99 * band.high), Verdict::Same);
    assert_eq!(judged(&baseline, "study/error", 1.01 * band.high), Verdict::Worse);
    assert_eq!(judged(&baseline, "study/error", 0.99 * band.low), Verdict::Improved);
    // A factor of 1.5 is 5.8 of its deviations away, and far below its bound.
    assert!(band.high < 0.0150 && band.high > 0.0110, "{band:?}");
}

#[test]
fn a_target_between_two_bounds_is_left_for_the_worse_in_either_direction() {
    let baseline = scattered();
    for order in [1.8, 2.2] {
        assert_eq!(judged(&baseline, "study/order", order), Verdict::Worse);
    }
    assert_eq!(judged(&baseline, "study/order", 2.02), Verdict::Same);
}

#[test]
fn figures_that_no_cloud_moves_may_move_by_round_off_only() {
    let baseline = scattered();
    assert_eq!(judged(&baseline, "study/count", 651.0), Verdict::Worse);
    assert_eq!(judged(&baseline, "study/count", 649.0), Verdict::Improved);
    assert_eq!(judged(&baseline, "study/smallest", 0.8 - 1e-9), Verdict::Same);
    assert_eq!(judged(&baseline, "study/smallest", 0.79), Verdict::Worse);
    assert_eq!(judged(&baseline, "study/smallest", 0.81), Verdict::Improved);
    assert_eq!(judged(&baseline, "study/sum", 9e-13), Verdict::Same);
    assert_eq!(judged(&baseline, "study/sum", 2e-12), Verdict::Worse);
}

#[test]
fn a_difference_is_worse_only_beyond_the_error_bar_of_its_reference() {
    let baseline = baseline();
    assert_eq!(judged(&baseline, "study/difference", 0.0179), Verdict::Same);
    assert_eq!(judged(&baseline, "study/difference", 0.0181), Verdict::Worse);
}

#[test]
fn nan_is_worse() {
    assert_eq!(judged(&baseline(), "study/error", f64::NAN), Verdict::Worse);
}

#[test]
fn checks_come_and_go() {
    let mut checks = figures();
    checks.remove(0);
    checks.push(Check::new("study/x", "", Kind::Exact, 0.0, Bound::AtMost(0.0), "1", ""));
    let comparison = compare(&run(checks), &baseline(), true).unwrap();
    assert_eq!(verdict(&comparison, "study/x"), Verdict::New);
    assert_eq!(verdict(&comparison, "study/error"), Verdict::Missing);
    assert_eq!(comparison.changes[0].verdict, Verdict::Missing, "the worst comes first");
    assert!(!comparison.holds());
}

#[test]
fn only_a_whole_run_misses_the_checks_of_other_studies() {
    let mut other = run(figures());
    other.studies[0].id = "other".into();
    for check in &mut other.studies[0].checks {
        check.id = check.id.replace("study/", "other/");
    }
    let part = compare(&other, &baseline(), false).unwrap();
    assert_eq!((part.count(Verdict::Missing), part.count(Verdict::New)), (0, 6));
    assert_eq!(compare(&other, &baseline(), true).unwrap().count(Verdict::Missing), 6);
}

#[test]
fn a_bound_that_was_loosened_is_worse_and_one_that_was_tightened_is_not() {
    for (bound, expected) in [
        (Bound::AtMost(0.06), Verdict::Worse),
        (Bound::AtLeast(0.0), Verdict::Worse),
        (Bound::AtMost(0.04), Verdict::Same),
    ] {
        let mut checks = figures();
        checks[0].bound = bound;
        let comparison = compare(&run(checks), &baseline(), true).unwrap();
        assert_eq!(verdict(&comparison, "study/error"), expected, "{bound:?}");
    }
}

#[test]
fn a_baseline_of_another_suite_is_refused() {
    let mut full = run(figures());
    full.suite = "full".into();
    let error = compare(&full, &baseline(), true).unwrap_err().to_string();
    assert!(error.contains("of the suite quick, the run of the suite full"), "{error}");
}

#[test]
fn a_baseline_needs_a_reason_a_run_that_passes_and_two_clouds() {
    assert!(Reason::new(" \n ").is_err());
    let failing = with("study/error", 0.06);
    let error = update(&failing, None, &Clouds::default(), &reason(), true).unwrap_err();
    assert!(error.to_string().contains("1 checks failed"), "{error}");
    assert!(Clouds::new(&clouds()[..1]).is_err());
}

#[test]
fn small_steps_for_the_worse_add_up_because_the_same_keeps_its_line() {
    let first = scattered();
    let a_bit = with("study/error", 0.0115);
    let second = update(&a_bit, Some(&first), &Clouds::default(), &reason(), true).unwrap();
    assert_eq!(second.checks, first.checks);
    assert!(difference(Some(&first), &second).is_empty());
    assert_eq!(second.history.len(), 2);
    assert_eq!(judged(&second, "study/error", 0.0160), Verdict::Worse);
}

#[test]
fn an_update_without_new_clouds_keeps_the_scatter_and_moves_the_band() {
    let first = scattered();
    let improved = with("study/error", 0.001);
    let second = update(&improved, Some(&first), &Clouds::default(), &reason(), true).unwrap();
    let (old, new) = (first.check("study/error").unwrap(), second.check("study/error").unwrap());
    assert_eq!(new.value, 0.001);
    assert_eq!(new.band.scatter, old.band.scatter);
    assert!(new.band.low < 0.001 && new.band.high > 0.001 && new.band.high < 0.002);
    // Two runs are further apart than a run and a mean: √2 and not √(1 + 1/21).
    let width = |band: mtled_checks::study::Band| (band.high / band.low).ln();
    let ratio = width(new.band) / width(old.band);
    assert!((ratio - (2.0f64 / (1.0 + 1.0 / 21.0)).sqrt()).abs() < 1e-9, "{ratio}");
    let lines = difference(Some(&first), &second);
    assert_eq!(lines.len(), 1);
    assert!(lines[0].starts_with("~ study/error 0.01 → 0.001 in "), "{lines:?}");
}

#[test]
fn a_baseline_is_the_same_text_whatever_the_order_of_the_checks() {
    let mut turned = figures();
    turned.reverse();
    let second = update(&run(turned), None, &Clouds::default(), &reason(), true).unwrap();
    let text = baseline().to_json();
    assert_eq!(second.to_json(), text);
    let lines: Vec<&str> = text.lines().filter(|line| line.contains("\"id\"")).collect();
    assert!(lines.len() == 6 && lines.is_sorted(), "{text}");
    let back: Baseline = serde_json::from_str(&text).unwrap();
    assert_eq!(back, baseline());
}

#[test]
fn a_cloud_far_from_the_others_is_found_by_leaving_it_out() {
    let mut runs = clouds();
    let healthy = Clouds::new(&runs).unwrap().left_out(&run(figures()));
    assert!(healthy.is_empty(), "{healthy:?}");
    assert!(Clouds::new(&runs).unwrap().failing().is_empty());
    runs[4] = with("study/error", 0.03);
    let found = Clouds::new(&runs).unwrap().left_out(&run(figures()));
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].run, found[0].checks.as_slice()), (4, &["study/error".to_string()][..]));
}

#[test]
fn a_cloud_on_which_a_bound_breaks_is_named() {
    let mut runs = clouds();
    runs[7] = with("study/error", 0.06);
    let failing = Clouds::new(&runs).unwrap().failing();
    assert_eq!((failing.len(), failing[0].run), (1, 7));
    assert_eq!(failing[0].checks, ["study/error"]);
}

#[test]
fn two_runs_are_compared_beyond_round_off() {
    let now = with("study/error", 0.0101);
    let comparison = compare_runs(&run(figures()), &now);
    assert_eq!((comparison.count(Verdict::Worse), comparison.count(Verdict::Same)), (1, 5));
    let moved = compare_runs(&run(figures()), &with("study/order", 2.1));
    assert!(moved.holds(), "inside its two bounds an order is neither better nor worse");
}

#[test]
fn a_figure_without_a_bound_passes_only_beside_a_baseline_that_holds_it() {
    let with_new = |value| {
        let mut checks = figures();
        let bound = Bound::Baseline(Better::Lower);
        checks.push(Check::new("study/new", "", Kind::Regression, value, bound, "1", ""));
        run(checks)
    };
    let mut report = with_new(0.5);
    settle(&mut report, &baseline());
    assert_eq!(report.outcome(), Outcome::Inconclusive, "no stored figure judges it");
    let taken_up = update(&report, Some(&baseline()), &Clouds::default(), &reason(), true).unwrap();
    settle(&mut report, &taken_up);
    assert_eq!(report.outcome(), Outcome::Passed);
    let verdict =
        |value| verdict(&compare(&with_new(value), &taken_up, true).unwrap(), "study/new");
    assert_eq!([0.5, 0.6, 0.4].map(verdict), [Verdict::Same, Verdict::Worse, Verdict::Improved]);
}

#[test]
fn a_theorem_does_not_become_an_earlier_figure_of_ours_without_a_word() {
    let mut checks = figures();
    checks[1].kind = Kind::Regression;
    let comparison = compare(&run(checks), &baseline(), true).unwrap();
    assert_eq!(verdict(&comparison, "study/order"), Verdict::Worse);
}
