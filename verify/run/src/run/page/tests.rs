use super::run_page;
use crate::run::record::Recording;
use mtled_case::scene::parse_case;
use serde_json::json;
use std::path::Path;

const CASE: &str = concat!(
    "\n",
    include_str!("../../../../tests/all/common/pulled_block.toml"),
    "[time]\nmethod = \"static\"\nload_end = 1.0\n"
);

fn page(outcome: &str, warnings: &[&str]) -> String {
    let case = parse_case(CASE, "case.toml", Path::new(".")).unwrap();
    let result = json!({
        "warnings": warnings,
        "motion": { "method": "static", "outcome": outcome, "smallest_jacobian": 0.5 },
    });
    run_page(&case, &Recording::default(), None, &result).unwrap()
}

#[test]
fn the_verdict_promises_no_more_than_the_outcome() {
    assert!(page("converged", &[]).contains("verdict pass"));
    assert!(page("converged", &["the body has folded"]).contains("verdict doubt"));
    for outcome in ["stopped", "not_converged", "diverged", "failed"] {
        let page = page(outcome, &[]);
        assert!(page.contains("verdict fail") && !page.contains("Converged"), "{outcome}");
    }
}

#[test]
fn texts_are_escaped_and_nothing_is_loaded_from_outside() {
    let page = page("converged", &["<script>alert(1)</script>\u{1b}[2J"]);
    assert!(!page.contains("<script") && !page.contains('\u{1b}'));
    for part in ["http://", "https://", "src=", "@import"] {
        let outside = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!outside.contains(part), "{part}");
    }
}
