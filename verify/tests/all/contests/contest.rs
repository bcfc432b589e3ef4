//! `mtled contest` and `mtled protocol` with made-up solvers: every way to break the
//! protocol is reported by its name.

use super::fake::Arena;
use crate::common::program::{interrupt, mtled, program};
use mtled_case::bundled::CASES;
use mtled_case::protocol::{Job, Resolution, parse_job};
use mtled_case::scene::parse_case;
use mtled_lab::contests::absolute;
use mtled_lab::lab::store::Source;
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A script ends with exit code 1 of the study and this text in the table of its runs.
fn faulty(body: &str, text: &str) {
    let arena = Arena::new();
    let said = arena.about(body);
    assert!(said.tables.contains(text), "{text} in\n{}{}", said.tables, said.err);
    assert!(said.tables.contains("FAULT") && said.code == 1, "{}", said.tables);
}

/// A script answers, and this text is in the column of the doubts.
fn doubtful(body: &str, text: &str) {
    let arena = Arena::new();
    let said = arena.about(body);
    assert!(said.tables.contains(text), "{text} in\n{}{}", said.tables, said.err);
    assert!(!said.tables.contains("FAULT") && said.code == 1, "{}", said.tables);
}

/// Whether the process whose number is in a file has ended, reaped or not.
fn is_dead(pid: &Path) -> bool {
    let pid = std::fs::read_to_string(pid).unwrap();
    let end = Instant::now() + Duration::from_secs(10);
    let dead = || {
        let state = std::fs::read_to_string(format!("/proc/{}/stat", pid.trim()));
        state.map_or(true, |state| state.contains(") Z "))
    };
    while !dead() && Instant::now() < end {
        std::thread::sleep(Duration::from_millis(10));
    }
    dead()
}

#[test]
fn an_honest_solver_gets_its_errors_its_order_and_its_measured_time() {
    let arena = Arena::new();
    let said = arena.about("reply");
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.tables.contains("| fake | fake 1.2 | 3 | 3 | 0 | 0 | 0 | 0 |"), "{}", said.tables);
    let runs = said.tables.lines().skip_while(|line| *line != "## fake: all runs");
    let rows: Vec<&str> = runs.filter(|line| line.starts_with("| block |")).collect();
    let cell = |row: usize, column: usize| -> f64 {
        rows[row].split('|').nth(column + 1).unwrap().trim().parse().unwrap()
    };
    let errors = [cell(0, 5), cell(2, 5)];
    assert!(errors[0] > 0.09 && errors[0] < 0.11 && errors[1] < 0.02, "{errors:?}");
    assert!(cell(0, 10) >= 0.0, "{rows:?}");
    assert!(
        said.tables.contains("none: scatter") || said.tables.contains(" ± "),
        "{}",
        said.tables
    );
}

#[test]
fn a_program_that_does_not_start_is_a_fault() {
    let arena = Arena::new();
    let said = arena.study(&["absent=./no-such-program {job} {answer}".to_string()], &[]);
    assert!(said.tables.contains("FAULT: does not start") && said.code == 1, "{}", said.tables);
}

#[test]
fn an_exit_code_is_reported_with_the_last_words_of_the_program() {
    faulty(
        "echo first >&2; echo 'boom: no mesh' >&2; exit 3",
        "ended with exit code 3: first; boom",
    );
}

#[test]
fn a_signal_is_reported() {
    faulty("kill -9 $$", "ended by signal 9");
}

#[test]
fn last_words_cannot_move_the_cursor_and_are_no_markup() {
    let arena = Arena::new();
    let said = arena.about("printf '\\033[2J<script>alert(1)</script>' >&2; exit 1");
    assert!(!said.tables.contains('\u{1b}') && said.tables.contains("\\u{1b}"), "{}", said.tables);
    assert!(!said.page.contains("<script>alert") && said.page.contains("&lt;script&gt;"));
}

#[test]
fn a_missing_answer_is_a_fault() {
    faulty("true", "there is no answer file");
}

#[test]
fn an_answer_that_is_not_json_is_a_fault() {
    faulty("echo hello >\"$answer\"", "not JSON: expected value at line 1 column 1");
}

#[test]
fn a_value_of_the_wrong_type_is_reported_with_its_key() {
    faulty("u='[0.1, \"wide\", 0]'; reply", "displacements_m.middle[0][0][1]: invalid type");
}

#[test]
fn an_unknown_key_is_reported() {
    faulty("more=', \"colour\": 3'; reply", "FAULT: colour: unknown field");
}

#[test]
fn a_missing_probe_is_reported_with_its_key() {
    faulty(
        "echo \"{$who, \\\"unknowns\\\": 1, \\\"displacements_m\\\": {}}\" >\"$answer\"",
        "displacements_m.top is missing",
    );
}

#[test]
fn a_wrong_number_of_positions_is_a_fault() {
    faulty(
        "u=\"$u, $u\"; reply",
        "displacements_m.top[0] has 2 entries instead of 1, one per position",
    );
}

#[test]
fn a_wrong_number_of_instants_is_a_fault() {
    faulty(
        "more=', \"strain_energy_j\": [1, 2]'; reply",
        "strain_energy_j has 2 entries instead of 1, one per instant",
    );
}

#[test]
fn nan_is_a_fault() {
    faulty("u='[0.1, NaN, 0]'; reply", "there is a number that is not finite, line 1");
}

#[test]
fn zero_unknowns_are_a_fault() {
    faulty("n=0; reply", "unknowns: is 0");
}

#[test]
fn another_version_of_the_protocol_is_a_fault() {
    faulty("who='\"protocol\": 2'; reply", "protocol is 2; this program speaks version 1");
}

#[test]
fn millimetres_are_suspected_on_every_level() {
    let body = "case $level in 0) u='[11, 22, 33]';; 1) u='[10.4, 20.8, 31.2]';; \
                *) u='[10.1, 20.2, 30.3]';; esac; reply";
    doubtful(body, "wrong units? the displacement is");
}

#[test]
fn an_answer_that_does_not_depend_on_the_resolution_is_doubted() {
    doubtful("u='[0.01, 0.02, 0.031]'; reply", "the answer does not depend on the resolution");
}

#[test]
fn unknowns_that_do_not_grow_are_doubted() {
    doubtful(
        "n=7; reply",
        "the unknowns do not grow with the resolution: 7 on level 0, 7 on level 2",
    );
}

#[test]
fn a_claim_of_time_is_named_where_it_differs_from_what_was_measured() {
    let said = Arena::new().about("more=', \"cpu_s\": 123'; reply");
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.tables.contains("claims 123 s of CPU time where"), "{}", said.tables);
}

#[test]
fn processor_time_is_measured_with_that_of_the_children() {
    let arena = Arena::new();
    let body = "sh -c 'i=0; while [ $i -lt 300000 ]; do i=$((i+1)); done'; reply";
    let said = arena.study(&[arena.fake("busy", body), arena.fake("idle", "reply")], &[]);
    let total = |name: &str| -> f64 {
        let start = format!("| {name} | fake 1.2 |");
        let row = said.tables.lines().find(|line| line.starts_with(&start)).unwrap();
        row.split('|').nth(9).unwrap().trim().parse().unwrap()
    };
    assert!(total("busy") > 2.0 * total("idle"), "{}", said.tables);
}

#[test]
fn a_refusal_is_a_result_and_no_fault() {
    let refusal =
        "\\\"refused\\\": {\\\"reason\\\": \\\"unsupported\\\", \\\"what\\\": \\\"contact\\\"}";
    let said = Arena::new().about(&format!("echo \"{{$who, {refusal}}}\" >\"$answer\""));
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.tables.contains("refused, not supported: contact"), "{}", said.tables);
}

#[test]
fn a_program_that_takes_too_long_is_killed_with_its_children() {
    let arena = Arena::new();
    let pid = arena.path("pid");
    let body = format!("sleep 300 & echo $! >'{}'; wait", pid.display());
    let start = Instant::now();
    let solver = [arena.fake("slow", &body)];
    let said = arena.study(&solver, &["--time-limit", "0.5", "--spacing", "x2,x1"]);
    assert!(start.elapsed() < Duration::from_secs(60));
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.tables.contains("timed out"), "{}", said.tables);
    assert!(is_dead(&pid));
}

#[test]
fn children_that_are_left_behind_are_killed() {
    let arena = Arena::new();
    let pid = arena.path("pid");
    arena.about(&format!("sleep 300 & echo $! >'{}'; reply", pid.display()));
    assert!(is_dead(&pid));
}

#[test]
fn ctrl_c_ends_the_study_and_the_solver_that_runs() {
    let arena = Arena::new();
    let pid = arena.path("pid");
    let fake = arena.fake("slow", &format!("echo $$ >'{}'; sleep 300", pid.display()));
    let mut arguments = vec!["contest", "run", "block.toml", "--quiet", "--without-mtled"];
    arguments.extend(["--reference", "reference.json", "--solver", &fake]);
    let mut study = program(&arena.dir, &arguments).spawn().unwrap();
    let written = || std::fs::read_to_string(&pid).is_ok_and(|text| text.ends_with('\n'));
    let start = Instant::now();
    while !written() {
        assert!(start.elapsed() < Duration::from_secs(60), "the solver was not started");
        std::thread::sleep(Duration::from_millis(10));
    }
    interrupt(&study);
    assert_eq!(study.wait().unwrap().code(), Some(130));
    assert!(is_dead(&pid));
}

#[test]
fn costs_at_equal_error_are_between_the_runs_and_nothing_is_extrapolated() {
    let arena = Arena::new();
    let said = arena.study(&[arena.fake("one", "reply"), arena.fake("two", "exit 1")], &[]);
    let rows: Vec<&str> = said
        .tables
        .lines()
        .skip_while(|line| !line.contains("CPU time at equal error"))
        .filter(|line| line.starts_with("| block |"))
        .collect();
    let errors: Vec<&str> = rows.iter().map(|row| row.split('|').nth(3).unwrap().trim()).collect();
    assert!(errors.contains(&"5.00 %") && errors.contains(&"2.00 %"), "{}", said.tables);
    assert!(!errors.contains(&"0.500 %") && rows[0].ends_with("| – |"), "{}", said.tables);
}

#[test]
fn a_mistake_on_the_command_line_runs_and_writes_nothing() {
    let arena = Arena::new();
    let said = |more: &[&str]| {
        let (code, out, err) =
            mtled(&arena.dir, &[&["contest", "run", "--out", "out"], more].concat());
        assert!(code == 2 && out.is_empty() && !arena.path("out").exists(), "{code} {out}");
        err
    };
    let fake = arena.fake("fake", "reply");
    for (more, part) in [
        (vec!["block.toml", "--solver", &fake], "block.toml: there is no reference"),
        (vec!["--solver", "fake=sh x"], "lacks {job}"),
        (vec!["--solver", &fake, "--solver", &fake], "two solvers called fake"),
        (vec!["--without-mtled"], "no solver takes part"),
        (vec!["uniaxial_bar", "--spacing", "x1,x2"], "from coarse to fine"),
        (vec!["uniaxial_bar", "--spacing", "small"], "is not a length"),
        (vec!["--time-limit", "0"], "more than 0"),
        (vec!["blok"], "no bundled case"),
    ] {
        let err = said(&more);
        assert!(err.contains(part), "{part} in {err}");
    }
}

#[test]
fn mtled_takes_part_through_the_same_door() {
    let dir = TempDir::new().unwrap();
    let arguments = ["contest", "run", "uniaxial_bar", "--spacing", "x2,x1", "--out", "out"];
    let (code, out, err) = mtled(&dir, &arguments);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("| mtled | mtled 0.1.0 | 2 | 2 | 0 | 0 | 0 | 0 |"), "{out}");
}

#[test]
fn a_job_can_be_written_solved_and_checked_by_hand() {
    let dir = TempDir::new().unwrap();
    let run = |arguments: &[&str]| mtled(&dir, arguments);
    let (code, _, err) = run(&["protocol", "job", "brain_slice", "try", "--spacing", "x2"]);
    assert_eq!(code, 0, "{err}");
    let (code, _, err) = run(&["protocol", "job", "uniaxial_bar", "try"]);
    assert_eq!(code, 0, "{err}");
    let (code, _, err) = run(&["protocol", "solve", "try/job.json", "try/answer.json"]);
    assert_eq!(code, 0, "{err}");
    let (code, out, _) = run(&["protocol", "check", "try/job.json", "try/answer.json"]);
    assert!(code == 0 && out.contains("a sound answer of mtled"), "{out}");
    std::fs::write(dir.path().join("try/answer.json"), "{\"protocol\": 1}").unwrap();
    let (code, _, err) = run(&["protocol", "check", "try/job.json", "try/answer.json"]);
    assert!(code == 1 && err.contains("solver is missing"), "{err}");
}

#[test]
fn the_schemas_of_both_files_are_printed() {
    for (file, key) in [("job", "spacing_m"), ("answer", "displacements_m")] {
        let (code, out, _) = mtled(Path::new("."), &["protocol", "schema", file]);
        let schema: Value = serde_json::from_str(&out).unwrap();
        assert!(code == 0 && schema.to_string().contains(key), "{out}");
    }
}

#[test]
fn every_bundled_case_has_a_job_that_is_the_same_problem_and_names_files_that_exist() {
    let cases = TempDir::new().unwrap();
    for (name, _) in CASES {
        let source = Source::find(name, cases.path(), &[]).unwrap();
        let case = absolute(&source).unwrap();
        let at = Resolution { spacing_m: 0.01, level: 0, levels: 3, time_limit_s: 60.0 };
        let text = serde_json::to_string(&Job::new(&case, at, &[0.5, 1.0]).unwrap()).unwrap();
        let job = parse_job(&text).unwrap();
        assert_eq!(serde_json::to_string(&job).unwrap(), text, "{name}");
        let again = parse_case(&job.case_text().unwrap(), name, Path::new("/nowhere")).unwrap();
        assert_eq!(format!("{:?}", again.problem), format!("{:?}", source.case.problem), "{name}");
        assert!(job.problem.region.iter().all(|row| job.materials.contains_key(&row.material)));
        for part in text.split("\"file\":\"").skip(1) {
            let file = part.split('"').next().unwrap();
            assert!(file.starts_with('/') && Path::new(file).is_file(), "{file}");
        }
    }
}
