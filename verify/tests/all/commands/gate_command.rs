//! `mtled verify --baseline` and `mtled report` from the outside, with the one study that
//! takes no time.

use crate::common::program::{ended, mtled, program};
use std::path::PathBuf;
use tempfile::TempDir;

struct Folder {
    folder: TempDir,
}

impl Folder {
    fn new() -> Folder {
        Folder { folder: TempDir::new().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Exit code, standard output and standard error.
    fn mtled(&self, arguments: &[&str]) -> (i32, String, String) {
        mtled(&self.folder, arguments)
    }

    fn verify(&self, more: &[&str]) -> (i32, String, String) {
        self.mtled(&[&["verify", "--only", "references", "--out", "out"], more].concat())
    }

    /// Writes `base.json`, with a text in it replaced.
    fn baseline(&self, edit: impl Fn(&mut serde_json::Value)) {
        let update = ["--baseline", "base.json", "--update-baseline", "--reason", "a beginning"];
        let (code, _, err) = self.verify(&update);
        assert_eq!(code, 0, "{err}");
        assert!(err.contains("+ references/") && err.contains("baseline: base.json"), "{err}");
        let text = std::fs::read_to_string(self.path("base.json")).unwrap();
        let mut value = serde_json::from_str(&text).unwrap();
        edit(&mut value);
        std::fs::write(self.path("base.json"), value.to_string()).unwrap();
    }

    fn read(&self, file: &str) -> String {
        std::fs::read_to_string(self.path(file)).unwrap()
    }
}

const ORDER: &str = "references/self_test/order";

/// Moves the stored value and band of a check.
fn moved(baseline: &mut serde_json::Value, id: &str, value: f64, low: f64, high: f64) {
    let checks = baseline["checks"].as_array_mut().unwrap();
    let check = checks.iter_mut().find(|check| check["id"] == id).unwrap();
    check["value"] = value.into();
    check["band"]["low"] = low.into();
    check["band"]["high"] = high.into();
}

#[test]
fn a_run_after_an_update_of_the_baseline_has_no_changes() {
    let folder = Folder::new();
    folder.baseline(|_| {});
    let (code, out, err) = folder.verify(&["--baseline", "base.json"]);
    assert_eq!(code, 0, "{err}");
    let line = out.lines().find(|line| line.starts_with("beside the baseline of")).unwrap();
    assert!(line.ends_with(" the same") && !line.contains(','), "{line}");
}

#[test]
fn a_value_beyond_its_band_fails_the_run_and_is_named_in_every_report() {
    let folder = Folder::new();
    folder.baseline(|baseline| moved(baseline, ORDER, 1.9, 1.8999, 1.9001));
    let summary = folder.path("step.md");
    std::fs::write(&summary, "earlier step\n").unwrap();
    let arguments = ["verify", "--only", "references", "--out", "out", "--baseline", "base.json"];
    let mut command = program(&folder.folder, &arguments);
    command.env("GITHUB_ACTIONS", "true").env("GITHUB_STEP_SUMMARY", &summary);
    let (code, out, err) = ended(command);
    assert_eq!(code, 1, "{err}");
    assert!(out.contains(&format!("worse    {ORDER}: 1.900 → 1.786")), "{out}");
    assert!(err.contains(&format!("::error title={ORDER} got worse::1.900 → 1.786")), "{err}");
    for file in ["out/index.html", "out/summary.md", "out/junit.xml", "out/results.json"] {
        let text = folder.read(file);
        assert!(text.contains("worse") && text.contains("self_test"), "{file}");
    }
    let step = folder.read("step.md");
    assert!(step.starts_with("earlier step\n## ❌") && step.contains(ORDER), "{step}");
}

#[test]
fn improved_new_and_missing_checks_are_distinguished() {
    let folder = Folder::new();
    let agree = "references/cook_membrane/codes_agree";
    folder.baseline(|baseline| {
        moved(baseline, agree, 0.9, 0.89, 0.91);
        let checks = baseline["checks"].as_array_mut().unwrap();
        checks.retain(|check| check["id"] != ORDER);
    });
    let (code, out, _) = folder.verify(&["--baseline", "base.json"]);
    assert_eq!(code, 0, "{out}");
    assert!(out.contains(&format!("improved {agree}: 0.9000 → 0.5927")), "{out}");
    assert!(out.contains(&format!("new      {ORDER}: nothing → 1.786")), "{out}");
    folder.baseline(|baseline| {
        let checks = baseline["checks"].as_array_mut().unwrap();
        let mut gone = checks[0].clone();
        gone["id"] = "references/a_case/codes_agree".into();
        checks.insert(0, gone);
        // A study that is not run now is not missed.
        let mut other = checks[0].clone();
        other["id"] = "patch/a_case/force".into();
        checks.insert(0, other);
    });
    let (code, out, _) = folder.verify(&["--baseline", "base.json"]);
    assert_eq!(code, 1, "{out}");
    assert!(out.contains("missing  references/a_case/codes_agree"), "{out}");
    assert!(!out.contains("patch/a_case"), "{out}");
}

#[test]
fn a_baseline_is_not_written_without_a_reason() {
    let folder = Folder::new();
    for arguments in [&["--update-baseline"][..], &["--update-baseline", "--reason", "  "]] {
        let (code, out, err) = folder.verify(arguments);
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(err.contains("reason"), "{err}");
    }
    assert!(!folder.path("reports/baseline.json").exists());
}

#[test]
fn a_file_that_is_not_a_baseline_is_refused_before_the_run() {
    let folder = Folder::new();
    std::fs::write(folder.path("bad.json"), "{\"schema_version\": 9}").unwrap();
    std::fs::write(folder.path("text.json"), "hello").unwrap();
    for (file, words) in [
        ("nowhere.json", "there is no baseline nowhere.json"),
        ("bad.json", "has schema version 9"),
        ("text.json", "text.json is not a baseline"),
    ] {
        let (code, out, err) = folder.verify(&["--baseline", file]);
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(err.contains(words), "{err}");
    }
    assert!(!folder.path("out").exists());
}

#[test]
fn a_report_that_is_written_again_has_the_same_bytes() {
    let folder = Folder::new();
    folder.baseline(|baseline| moved(baseline, ORDER, 1.9, 1.8999, 1.9001));
    folder.verify(&["--baseline", "base.json"]);
    let (code, _, err) = folder.mtled(&["report", "out", "--out", "again"]);
    assert_eq!(code, 0, "{err}");
    for file in ["index.html", "summary.md", "junit.xml", "results.json"] {
        let of = |report: &str| folder.read(&format!("{report}/{file}"));
        assert!(of("out") == of("again"), "{file}");
    }
}

#[test]
fn two_runs_are_compared_in_a_page_and_in_markdown() {
    let folder = Folder::new();
    folder.verify(&[]);
    let text = folder.read("out/results.json");
    let earlier = text.replace("\"value\":0.592", "\"value\":0.492");
    let agree = "references/cook_membrane/codes_agree";
    std::fs::write(folder.path("earlier.json"), earlier).unwrap();
    let (code, out, err) = folder.mtled(&["report", "earlier.json", "out"]);
    assert_eq!(code, 0, "{err}");
    assert!(
        out.contains(&format!("worse    {agree}"))
            && out.contains("report: reports/compare/index.html"),
        "{out}"
    );
    for file in ["reports/compare/index.html", "reports/compare/summary.md"] {
        let text = folder.read(file);
        assert!(text.contains("cook_membrane") && text.contains("[s]"), "{text}");
    }
    let json = folder.mtled(&["report", "earlier.json", "out", "--format", "json"]).1;
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(value["changes"][0]["id"], agree);
}

#[test]
fn a_file_that_is_not_a_report_is_refused() {
    let folder = Folder::new();
    std::fs::write(folder.path("other.json"), "{\"schema_version\": 1}").unwrap();
    for (path, words) in
        [("nowhere", "there is no nowhere"), ("other.json", "is not the results.json")]
    {
        let (code, out, err) = folder.mtled(&["report", path]);
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(err.contains(words), "{err}");
    }
}

#[test]
fn a_stored_run_is_compared_with_a_baseline_without_being_repeated() {
    let folder = Folder::new();
    folder.baseline(|_| {});
    let judge = ["report", "out", "--baseline", "base.json"];
    let (code, out, err) = folder.mtled(&judge);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("beside the baseline of"), "{out}");
    let text = folder.read("base.json");
    let mut baseline = serde_json::from_str(&text).unwrap();
    moved(&mut baseline, ORDER, 1.9, 1.8999, 1.9001);
    std::fs::write(folder.path("base.json"), baseline.to_string()).unwrap();
    let (code, out, _) = folder.mtled(&judge);
    assert_eq!(code, 1);
    assert!(out.contains(&format!("worse    {ORDER}: 1.900 → 1.786")), "{out}");
    assert!(folder.read("out/summary.md").contains("worse"), "{}", folder.read("out/summary.md"));
}

#[test]
fn single_checks_are_printed_on_request_only_and_lines_have_at_most_100_characters() {
    let folder = Folder::new();
    for (more, checks) in [(&[][..], false), (&["--verbose"][..], true)] {
        let (code, out, err) = folder.verify(more);
        assert_eq!(code, 0, "{err}");
        assert!(out.contains("Finite-element references"), "{out}");
        assert_eq!(out.contains("codes_agree"), checks, "{out}");
        let longest = out.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(longest <= 100, "{out}");
    }
}
