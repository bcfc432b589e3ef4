//! Stored results of a contest are judged again, and believed only where they are about the
//! problem that they name, sound and complete.

use super::fake::Arena;
use crate::common::program::mtled;
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
    refused(|results| results["runs"][0]["usage"]["cpu_s"] = json!(0.0), "no process starts");
    let forget = |results: &mut Value| {
        results["runs"][0].as_object_mut().unwrap().remove("usage");
    };
    refused(forget, "a run that started has taken time");
}

#[test]
fn an_answer_beyond_the_time_limit_is_refused() {
    refused(
        |results| results["runs"][2]["usage"]["wall_s"] = json!(500.0),
        "5 s beyond the time limit",
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
fn pages_do_not_hang_on_the_order_of_the_files() {
    let arena = Arena::new();
    let solvers = ["one", "two"].map(|name| arena.fake(name, "reply"));
    assert_eq!(arena.study(&solvers, &[]).code, 0);
    let pages = |files: [&str; 2], out: &str| {
        let own = ["--case", "block.toml", "--reference", "reference.json", "--out", out];
        let arguments = [&["contest", "pages", "--quiet"][..], &files, &own].concat();
        assert_eq!(mtled(arena.dir.path(), &arguments).0, 0);
        let read = |page: &str| std::fs::read_to_string(arena.path(out).join(page)).unwrap();
        ["index.html", "tables.md"].map(read)
    };
    let files = ["out/results/one/block.json", "out/results/two/block.json"];
    assert_eq!(pages(files, "forth"), pages([files[1], files[0]], "back"));
}

#[test]
fn every_problem_of_the_benchmark_is_listed_with_its_fingerprints() {
    let (code, out, _) = mtled(Arena::new().dir.path(), &["contest", "list"]);
    assert!(code == 0 && out.contains("cube_shear-v1") && out.contains("references "), "{out}");
}

#[test]
fn names_that_are_no_names_and_days_that_are_no_days_are_refused() {
    for name in ["", "..", "a/b", "a\u{1b}[31m", " x", &"x".repeat(41)] {
        refused(|results| results["solver"] = json!(name), "a name has 1 to 40 letters");
    }
    for day in ["", "yesterday", "2026-13-01", "2026-1-1"] {
        refused(|results| results["machine"]["date"] = json!(day), "is not a day");
    }
    refused(|results| results["command"] = json!(" "), "command is empty");
    refused(|results| results["time_limit_s"] = json!(-1.0), "time_limit_s must be more than 0");
    refused(|results| results["runs"][0]["spacing_m"] = json!(1e300), "lengths from 1e-9");
}

#[test]
fn a_run_that_timed_out_before_its_limit_is_refused() {
    refused(|results| results["runs"][0]["ended"] = json!("timed_out"), "within the time limit");
}

#[test]
fn nobody_answers_in_the_name_of_this_program() {
    refused(|results| results["solver"] = json!("mtled"), "but fake 1.2 answers");
}

#[test]
fn lists_in_place_of_objects_are_refused() {
    let list = |results: &mut Value| {
        let run = results["runs"][0].as_object().unwrap().values().cloned().collect();
        results["runs"][0] = Value::Array(run);
    };
    refused(list, "must be JSON objects");
}

#[test]
fn answers_that_nearly_are_the_same_are_doubted_and_so_is_nothing_at_all() {
    let everywhere = |value: fn(usize) -> f64| {
        move |results: &mut Value| {
            for (n, run) in results["runs"].as_array_mut().unwrap().iter_mut().enumerate() {
                let probes = &mut run["ended"]["reply"]["displacements_m"];
                for probe in probes.as_object_mut().unwrap().values_mut() {
                    probe[0][0] = json!([value(n), value(n), value(n)]);
                }
            }
        }
    };
    checked(everywhere(|n| 0.02 + 1e-12 * n as f64), 3, "does not depend on the resolution");
    checked(everywhere(|_| 0.0), 3, "the displacement is 0 everywhere");
}

#[test]
fn more_than_one_thread_is_doubted() {
    let busy = |results: &mut Value| {
        results["runs"][0]["usage"]["wall_s"] = json!(1.0);
        results["runs"][0]["usage"]["cpu_s"] = json!(4.0);
    };
    checked(busy, 3, "4 threads at once");
}

#[test]
fn two_files_of_one_solver_on_one_problem_are_refused() {
    let (arena, results) = honest();
    std::fs::write(arena.path("out/results/copy.json"), results.to_string()).unwrap();
    let (code, said) = arena.check("out/results");
    assert!(code == 1 && said.contains("in another file too"), "{said}");
    let (code, said) = arena.check("nowhere");
    assert!(code == 2 && said.contains("cannot read nowhere"), "{said}");
}

#[test]
fn times_of_another_machine_are_not_compared() {
    let (arena, mut results) = honest();
    let shown = |more: &str| {
        let own = ["--case", "block.toml", "--reference", "reference.json", "--out", "pages"];
        let files = ["contest", "pages", "out/results", more];
        let (code, _, err) = mtled(arena.dir.path(), &[&files[..], &own].concat());
        assert_eq!(code, 0, "{err}");
        std::fs::read_to_string(arena.path("pages/tables.md")).unwrap()
    };
    let second = |tables: &str| {
        let mut costs = tables.lines().skip_while(|line| *line != "## CPU time at equal error");
        let row = costs.find(|line| line.starts_with("| block |")).unwrap().to_string();
        row.split('|').map(str::trim).rfind(|cell| !cell.is_empty()).unwrap().to_string()
    };
    results["solver"] = json!("second");
    std::fs::write(arena.path("second.json"), results.to_string()).unwrap();
    assert_ne!(second(&shown("second.json")), "–");
    results["machine"]["processor"] = json!("Z80");
    std::fs::write(arena.path("second.json"), results.to_string()).unwrap();
    assert_eq!(second(&shown("second.json")), "–");
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
