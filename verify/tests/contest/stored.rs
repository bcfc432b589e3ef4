//! Stored results of a contest are judged again, and believed only where they are about the
//! problem that they name, sound and complete.

use crate::fake::Arena;
use crate::program::mtled;
use serde_json::{Value, json};

/// Results of an honest solver, and the folder where they lie.
fn honest() -> (Arena, Value) {
    let arena = Arena::new();
    let said = arena.about("reply");
    assert_eq!(said.code, 0, "{}", said.err);
    let text = std::fs::read_to_string(arena.path("out/results/fake/block.json")).unwrap();
    (arena, serde_json::from_str(&text).unwrap())
}

/// Results with one thing changed are not believed, and this text says why.
fn refused(change: impl FnOnce(&mut Value), text: &str) {
    checked(change, 1, text);
}

fn checked(change: impl FnOnce(&mut Value), expected: u8, text: &str) {
    let (arena, mut results) = honest();
    change(&mut results);
    std::fs::write(arena.path("changed.json"), results.to_string()).unwrap();
    let (code, said) = arena.check("changed.json");
    assert!(code == expected && said.contains(text), "{text} in {code} {said}");
}

#[test]
fn results_are_judged_again_without_running_the_solver() {
    let (arena, results) = honest();
    std::fs::remove_file(arena.path("fake.sh")).unwrap();
    let (code, said) = arena.check("out/results");
    assert!(code == 0 && said.contains("fake on block, error of the displacement"), "{said}");
    assert_eq!(results["machine"]["system"], "linux x86_64");
    assert_eq!(results["runs"].as_array().unwrap().len(), 3);
}

#[test]
fn results_of_another_problem_are_refused() {
    refused(
        |results| results["inputs"] = json!("0".repeat(64)),
        "of another problem than block is",
    );
}

#[test]
fn results_of_a_problem_that_is_not_there_are_refused() {
    refused(|results| results["problem"] = json!("block-v2"), "there is no `block-v2`");
}

#[test]
fn an_answer_without_a_probe_is_refused() {
    let forget = |results: &mut Value| {
        let answer = &mut results["runs"][1]["ended"]["reply"]["displacements_m"];
        answer.as_object_mut().unwrap().remove("top");
    };
    refused(forget, "runs[1]: displacements_m.top is missing");
}

#[test]
fn a_run_that_took_no_time_is_refused() {
    refused(
        |results| results["runs"][0]["usage"]["cpu_s"] = json!(0.0),
        "times must be more than 0",
    );
    let forget = |results: &mut Value| {
        results["runs"][0].as_object_mut().unwrap().remove("usage");
    };
    refused(forget, "a run that replies has taken time");
}

#[test]
fn an_answer_beyond_the_time_limit_is_refused() {
    refused(
        |results| results["runs"][2]["usage"]["wall_s"] = json!(500.0),
        "beyond the time limit",
    );
}

#[test]
fn runs_that_do_not_go_from_coarse_to_fine_are_refused() {
    let swap = |results: &mut Value| results["runs"].as_array_mut().unwrap().swap(0, 2);
    refused(swap, "runs[1].spacing_m");
}

#[test]
fn answers_of_two_versions_in_one_file_are_refused() {
    let newer = |results: &mut Value| {
        results["runs"][2]["ended"]["reply"]["solver"]["version"] = json!("2");
    };
    refused(newer, "fake 2 answers, and fake 1.2 before it");
}

#[test]
fn an_unknown_key_and_another_version_of_the_layout_are_refused() {
    refused(|results| results["colour"] = json!(3), "unknown field `colour`");
    refused(|results| results["results"] = json!(2), "reads version 1");
}

#[test]
fn answers_in_millimetres_are_doubtful_in_stored_results_too() {
    let scale = |results: &mut Value| {
        for run in results["runs"].as_array_mut().unwrap() {
            for probe in
                run["ended"]["reply"]["displacements_m"].as_object_mut().unwrap().values_mut()
            {
                for part in probe[0][0].as_array_mut().unwrap() {
                    *part = json!(1000.0 * part.as_f64().unwrap());
                }
            }
        }
    };
    checked(scale, 3, "wrong units?");
}

#[test]
fn pages_of_stored_results_are_those_of_the_run() {
    let (arena, _) = honest();
    let own = ["--case", "block.toml", "--reference", "reference.json", "--out", "pages"];
    let arguments = [&["contest", "pages", "out/results", "--quiet"][..], &own].concat();
    let (code, _, err) = mtled(arena.dir.path(), &arguments);
    assert_eq!(code, 0, "{err}");
    for page in ["index.html", "solver-fake.html", "problem-block.html"] {
        let read = |folder: &str| std::fs::read_to_string(arena.path(folder).join(page)).unwrap();
        assert_eq!(read("out"), read("pages"), "{page}");
    }
}

#[test]
fn every_problem_of_the_benchmark_is_listed_with_its_fingerprints() {
    let (code, out, _) = mtled(Arena::new().dir.path(), &["contest", "list"]);
    assert!(code == 0 && out.contains("cube_shear-v1") && out.contains("references "), "{out}");
}

#[test]
fn a_crash_is_a_result_of_its_own() {
    let crash = |results: &mut Value| {
        results["runs"][0]["ended"] = json!({"fault": "ended by signal 11"});
    };
    checked(crash, 0, "FAULT: ended by signal 11");
}

#[test]
fn the_results_that_are_stored_beside_the_problems_are_believed() {
    let stored = concat!(env!("CARGO_MANIFEST_DIR"), "/../reference/results");
    let (code, out, err) = mtled(".", &["contest", "check", stored]);
    assert!([0, 3].contains(&code) && out.lines().count() >= 200, "{code} {err}");
}
