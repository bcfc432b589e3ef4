//! How runs end, in words, exit codes and `result.json`, on bodies made for the occasion.

use crate::common::program::{interrupt, printed, program};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;
use tempfile::TempDir;

/// A label map of a head: brain 1, ventricles 2, a tumour 3, voxels of 4 mm.
fn head(path: &Path) {
    let (size, voxel) = ([39, 49, 34], 0.004);
    let corner = [0, 1, 2].map(|k| -0.5 * (size[k] - 1) as f64 * voxel);
    let mut header = String::from("NRRD0005\ntype: uint8\ndimension: 3\n");
    writeln!(header, "space: right-anterior-superior\nsizes: {} {} {}", size[0], size[1], size[2])
        .unwrap();
    writeln!(header, "space directions: ({voxel},0,0) (0,{voxel},0) (0,0,{voxel})").unwrap();
    writeln!(header, "space units: \"m\" \"m\" \"m\"\nencoding: raw").unwrap();
    writeln!(header, "space origin: ({},{},{})\n", corner[0], corner[1], corner[2]).unwrap();
    let mut bytes = header.into_bytes();
    for at in 0..size[0] * size[1] * size[2] {
        let index = [at % size[0], at / size[0] % size[1], at / (size[0] * size[1])];
        bytes.push(label([0, 1, 2].map(|k| corner[k] + voxel * index[k] as f64)));
    }
    std::fs::write(path, bytes).unwrap();
}

fn label(x: [f64; 3]) -> u8 {
    let within = |centre: [f64; 3], radii: [f64; 3]| {
        (0..3).map(|k| ((x[k] - centre[k]) / radii[k]).powi(2)).sum::<f64>() < 1.0
    };
    let brain = within([0.0; 3], [0.065, 0.085, 0.055]) && x[2] > -0.045;
    match brain {
        false => 0,
        true if within([0.03, 0.03, 0.015], [0.012; 3]) => 3,
        true if within([0.0, 0.0, 0.005], [0.012, 0.03, 0.01]) => 2,
        true => 1,
    }
}

/// The head pushed at a craniotomy, in a skull without friction; nodes refined in the
/// tumour, cells by default.
const HEAD: &str = r#"
title = "Head"

[geometry]
shape = { label_map = { file = "head.nrrd", labels = [1, 2, 3] } }

[[region]]
name = "ventricles"
where = { label = { value = 2 } }
material = "ventricle"

[[region]]
name = "brain"
where = "all"
material = "brain"

[material.brain]
law = "neo_hookean_isochoric"
density = 1000.0
young_modulus = 3000.0
poisson_ratio = 0.49

[material.ventricle]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 10.0
poisson_ratio = 0.1

[discretisation]
cloud = "graded"
spacing = 0.014
refine = [{ where = { label = { value = 3 } }, spacing = 0.007 }]

[[prescribe]]
name = "craniotomy"
of = "surface"
where = { sphere = { centre = [0.04, 0.045, 0.035], radius = 0.025 } }
displacement = { x = -0.004, y = -0.004, z = -0.004 }
amplitude = { smooth = { duration = 1.0 } }

[[obstacle]]
name = "skull"
shape = { label_map = { file = "head.nrrd", labels = [1, 2, 3] } }
offset = 0.003
side = "inside"
friction = "frictionless"

[[probe]]
name = "far"
point = [-0.03, -0.03, 0.0]

[time]
method = "static"
load_end = 1.0
"#;

/// A ball on its cap, so heavy that it topples.
const HEAVY_BALL: &str = r#"
title = "Heavy ball"

[geometry]
shape = { sphere = { centre = [0.0, 0.0, 0.0], radius = 0.04 } }

[material.tissue]
law = "neo_hookean_isochoric"
density = 1000.0
young_modulus = 2500.0
poisson_ratio = 0.45

[discretisation]
cloud = "regular"
spacing = 0.0075

[[prescribe]]
name = "cap"
of = "surface"
where = { half_space = { point = [0.0, 0.0, -0.03], normal = [0.0, 0.0, 1.0] } }
displacement = { x = 0.0, y = 0.0, z = 0.0 }

[[body_force]]
acceleration = [0.0, 0.0, -9.81]
amplitude = { smooth = { duration = 1.0 } }

[time]
method = "static"
load_end = 1.0
"#;

const SOLVE: [&str; 4] = ["solve", "case.toml", "--out", "out"];

struct Run {
    folder: TempDir,
    code: i32,
    said: String,
}

impl Run {
    fn of(case: &str) -> Run {
        let folder = prepared(case);
        let (code, said) = printed(&folder, &SOLVE);
        Run { folder, code, said }
    }

    /// result.json of a run that ended like this.
    fn ended(&self, code: i32, outcome: &str) -> Value {
        assert_eq!(self.code, code, "{}", self.said);
        let result = self.result();
        assert_eq!(result["motion"]["outcome"], outcome);
        result
    }

    fn result(&self) -> Value {
        let text = std::fs::read_to_string(self.folder.path().join("out/result.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    }
}

fn prepared(case: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    head(&folder.path().join("head.nrrd"));
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    folder
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Dynamic relaxation in place of the default, with more settings of `time`.
fn relaxed(settings: &str) -> String {
    HEAD.replace("load_end = 1.0", &format!("solver = \"relaxation\"\nload_end = 1.0\n{settings}"))
}

#[test]
fn a_graded_head_in_a_frictionless_skull_is_solved_by_newton_where_no_solver_is_named() {
    let run = Run::of(HEAD);
    let result = run.ended(0, "converged");
    assert!(result["motion"]["newton_failed"].is_null(), "{}", result["motion"]);
    let residual = number(&result["motion"]["newton"]["relative_residual"]);
    assert!(residual <= 1e-6, "{residual:e}");
    let far = |result: &Value| number(&result["probes"][0]["displacement_m"][0][1]);
    let relaxed = far(&Run::of(&relaxed("")).result());
    // Newton's method meets the skull with the values of nodes, relaxation with their parameters.
    assert!((far(&result) - relaxed).abs() < 0.08 * relaxed.abs(), "{} {relaxed}", far(&result));
    assert!(result["error_bars"]["probes"][0]["displacement_m"].is_number(), "{}", run.said);
}

#[test]
fn a_graded_head_in_a_frictionless_skull_converges_to_its_tolerance() {
    let run = Run::of(&relaxed(""));
    let result = run.ended(0, "converged");
    assert!(result["motion"]["steps"].as_u64().unwrap() < 5000, "{}", result["motion"]);
    let error = number(&result["motion"]["relaxation"]["estimated_error_m"]);
    assert!(error < 1e-6, "{error:e} m");
    // As it slides along its skull, the far side follows the push.
    let far = number(&result["probes"][0]["displacement_m"][0][1]);
    assert!((-0.006..-0.002).contains(&far), "{far} m");
}

#[test]
fn refined_nodes_whose_cells_are_refined_elsewhere_are_refused_with_their_place() {
    let elsewhere = "[discretisation.grid]\nrefine = [{ where = { box = { min = [-0.05, -0.05, 0.0], \
                     max = [0.0, 0.0, 0.04] } }, cell = 0.004 }]\n\n[[prescribe]]";
    let finer = HEAD.replace("spacing = 0.007", "spacing = 0.0055");
    let run = Run::of(&finer.replacen("[[prescribe]]", elsewhere, 1));
    assert_eq!(run.code, 2, "{}", run.said);
    let said = &run.said;
    assert!(said.contains("case.toml:34:1: discretisation.grid: "), "{said}");
    assert!(said.contains("points per spacing squared or cubed"), "{said}");
}

#[test]
fn a_run_that_does_not_converge_keeps_its_last_state_and_never_says_converged() {
    let run = Run::of(&relaxed("max_steps = 600"));
    let result = run.ended(2, "not_converged");
    assert_eq!(result["motion"]["complete"], false);
    assert_eq!(result["motion"]["steps"], 600);
    assert!(number(&result["probes"][0]["displacement_m"][0][1]) < -0.001);
    let said = &run.said;
    assert!(said.contains("has not converged after 600 steps"), "{said}");
    assert!(said.contains("still moves most"), "{said}");
    assert!(!said.contains("converged:"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_run_that_the_user_stops_says_so_everywhere() {
    // The handler is installed before the set-up, which takes longer than this.
    stop(&relaxed("load_steps = 100000"), 1500);
    // By Newton's method, in the middle of a correction if the machine is not too slow.
    stop(&HEAD.replace("= 0.014", "= 0.006").replace("= 0.007", "= 0.003"), 6000);
}

#[cfg(unix)]
fn stop(case: &str, after_ms: u64) {
    let folder = prepared(case);
    let mut solve = program(&folder, &SOLVE);
    let child = solve.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(after_ms));
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    let run = Run { folder, code: output.status.code().unwrap(), said };
    assert_eq!(run.code, 130, "{}", run.said);
    assert_eq!(run.result()["motion"]["outcome"], "stopped");
    assert_eq!(run.result()["motion"]["complete"], false);
    assert!(!run.said.contains("converged:"), "{}", run.said);
}

#[test]
fn a_ball_that_topples_is_called_unstable_and_its_mode_is_drawn() {
    let run = Run::of(HEAVY_BALL);
    assert!(run.said.contains("unstable: "), "{}", run.said);
    let out = run.folder.path().join("out");
    let drawn = |path: &Path| {
        String::from_utf8_lossy(&std::fs::read(path).unwrap()).contains("unstable_mode")
    };
    for kind in ["body_", "nodes_"] {
        let mut frames: Vec<_> = std::fs::read_dir(&out)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.file_name().unwrap().to_string_lossy().starts_with(kind))
            .collect();
        frames.sort();
        let (last, others) = frames.split_last().unwrap();
        assert!(drawn(last) && !others.iter().any(|frame| drawn(frame)));
    }
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.contains("unstable"), "{page}");
}
