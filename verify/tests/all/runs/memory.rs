//! Memory as users meet it: estimated before a run, and refused where there is
//! too little.

use crate::common::program::mtled;
use serde_json::Value;
use std::f64::consts::PI;
use tempfile::TempDir;

/// A block with a fixed and a free face; its spacing is a placeholder.
const CASE: &str = concat!(
    "\n",
    include_str!("../common/pulled_block.toml"),
    "[time]\nmethod = \"dynamic\"\nend = 1e-4\n"
);
const SPACING: &str = "spacing = 0.02";

fn solve(discretisation: &str) -> (i32, String, String) {
    assert!(CASE.contains(SPACING), "the spacing of the block has changed");
    solve_in(&TempDir::new().unwrap(), &CASE.replace(SPACING, discretisation))
}

fn solve_in(dir: &TempDir, text: &str) -> (i32, String, String) {
    std::fs::write(dir.path().join("case.toml"), text).unwrap();
    // The estimate does not count the coarser clouds of error bars.
    let more = ["--out", "out", "--no-error-bar", "--format", "json", "--quiet"];
    mtled(dir, &[&["solve", "case.toml"], &more[..]].concat())
}

#[test]
fn a_body_larger_than_the_memory_is_refused_at_its_discretisation() {
    let (code, _, err) = solve("spacing = 4e-4\ndilation = 2.6");
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("\"key\":\"discretisation\"") && err.contains("are available"), "{err}");
    assert!(err.contains("use a larger spacing"), "{err}");
}

/// A cubic image of a ball, `n` voxels and 100 mm along each edge.
fn ball_image(n: usize) -> Vec<u8> {
    let step = 100.0 / n as f64;
    let header = format!(
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: {n} {n} {n}\nencoding: raw\n\
         space: right-anterior-superior\nspace origin: (0,0,0)\nspace units: \"mm\" \"mm\" \"mm\"\n\
         space directions: ({step},0,0) (0,{step},0) (0,0,{step})\n\n"
    );
    let from_middle = |i: usize| (i as f64 + 0.5 - 0.5 * n as f64).powi(2);
    let inside = |at: usize| {
        let square = [at % n, at / n % n, at / (n * n)].map(from_middle).iter().sum::<f64>();
        (square < (0.4 * n as f64).powi(2)) as u8
    };
    header.into_bytes().into_iter().chain((0..n.pow(3)).map(inside)).collect()
}

/// A ball of 100 mm as an STL surface of about 4 n² triangles.
fn ball_surface(n: usize) -> Vec<u8> {
    let corner = |i: usize, j: usize| {
        let (a, b) = (i as f64 / n as f64 * PI, (j % (2 * n)) as f64 / n as f64 * PI);
        let across = if i == 0 || i == n { 0.0 } else { a.sin() };
        [across * b.cos(), across * b.sin(), a.cos()].map(|c| (50.0 + 50.0 * c) as f32)
    };
    let mut triangles = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j))) {
        let [a, b, c, d] =
            [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| corner(i, j));
        triangles.extend((i + 1 < n).then_some([a, b, c]));
        triangles.extend((i > 0).then_some([a, c, d]));
    }
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        triangle.iter().flatten().for_each(|c| bytes.extend(c.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// What replaces parts of the case of this file.
struct Changed {
    name: &'static str,
    parts: &'static [(&'static str, &'static str)],
}

const BOX: &str = "{ box = { min = [0.0, 0.0, 0.0], max = [0.1, 0.1, 0.1] } }";
const BOTTOM: &str = "{ plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] } }";
const BALL: &str = "{ sphere = { centre = [0.05, 0.05, 0.05], radius = 0.05 } }";
const CAP: &str = "{ sphere = { centre = [0.05, 0.05, 0.0], radius = 0.03 } }";
const GRADED: &str = "spacing = 0.02
refine = [{ where = { sphere = { centre = [0.05, 0.05, 0.02], radius = 0.02 } }, spacing = 0.004 }]";
const END: &str = "end = 1e-4";

const CHANGED: &[Changed] = &[
    Changed { name: "small", parts: &[] },
    Changed { name: "even", parts: &[(SPACING, "spacing = 0.006")] },
    Changed {
        name: "many cells",
        parts: &[(SPACING, "spacing = 0.01\ngrid = { cells_per_spacing = 1.8 }")],
    },
    Changed { name: "wide supports", parts: &[(SPACING, "spacing = 0.01\ndilation = 2.6")] },
    Changed {
        name: "single precision",
        parts: &[(SPACING, "spacing = 0.006\ngradient_storage = \"single\"")],
    },
    Changed { name: "whole boundary", parts: &[(SPACING, "spacing = 0.007"), (BOTTOM, "\"all\"")] },
    Changed {
        name: "newton",
        parts: &[
            (SPACING, "spacing = 0.01"),
            ("method = \"dynamic\"", "method = \"static\"\nsolver = \"newton\""),
            (END, "tolerance = 1e-6"),
        ],
    },
    Changed {
        name: "graded",
        parts: &[(BOX, BALL), (BOTTOM, CAP), ("\"regular\"", "\"graded\""), (SPACING, GRADED)],
    },
    Changed {
        name: "image",
        parts: &[
            (BOX, "{ label_map = { file = \"ball.nrrd\", labels = [1] } }"),
            (BOTTOM, "\"all\""),
            (SPACING, "spacing = 0.01"),
        ],
    },
    Changed {
        name: "surface",
        parts: &[
            (BOX, "{ stl = { file = \"ball.stl\", unit = \"mm\" } }"),
            (BOTTOM, CAP),
            (SPACING, "spacing = 0.01"),
        ],
    },
    Changed {
        name: "many frames and a lattice of probes",
        parts: &[(
            END,
            "end = 0.5\n[output]\nframes = 200\nhistory = 40\n[[probe]]\nname = \"lattice\"\n\
             lattice = { min = [0.0, 0.0, 0.0], max = [0.1, 0.1, 0.1], counts = [30, 30, 30] }",
        )],
    },
];

/// Pages of the program itself that a system may not have mapped, by how its file lies in the cache of files
/// \[bytes\]: the same program took 19.7 MB as the linker had left it, and 23.7 MB as a copy.
const MAPPED: f64 = 4e6;

/// The program and its threads \[bytes\]; a smaller run is not estimated closely.
const FLOOR: f64 = 20e6;

/// On a busy machine threads seldom need all that they may at one time, so that a run may do with less.
const RUNS: usize = 3;

/// The largest peak of so many runs, fewer where one comes close to the estimate, and the estimate
/// \[bytes\].
fn largest_of(runs: usize, dir: &TempDir, text: &str) -> Option<(f64, f64)> {
    let mut largest = (0.0f64, 0.0);
    for _ in 0..runs {
        let (code, result, err) = solve_in(dir, text);
        assert_eq!(code, 0, "{err}");
        let timings = &serde_json::from_str::<Value>(&result).unwrap()["timings"];
        largest.0 = largest.0.max(timings["peak_memory_bytes"].as_f64()?);
        largest.1 = timings["estimated_memory_bytes"].as_f64().unwrap();
        if largest.1 <= 1.25 * (largest.0 + MAPPED).max(FLOOR) {
            break;
        }
    }
    Some(largest)
}

/// Neither a refusal where there is enough memory nor a crash where there is not.
#[test]
fn the_memory_of_a_run_is_at_most_what_is_estimated_and_at_least_a_1_3th_of_it() {
    let dir = TempDir::new().unwrap();
    std::fs::write(dir.path().join("ball.nrrd"), ball_image(64)).unwrap();
    std::fs::write(dir.path().join("ball.stl"), ball_surface(100)).unwrap();
    let mut wrong = String::new();
    for Changed { name, parts } in CHANGED {
        let mut text = CASE.to_string();
        for (from, to) in *parts {
            assert!(text.contains(from), "{name}: {from} is not in the case");
            text = text.replace(from, to);
        }
        // The peak is not known on every system.
        let Some((peak, estimate)) = largest_of(RUNS, &dir, &text) else { return };
        let line = format!("{name}: {:.1} MB estimated, {:.1} MB used", estimate / 1e6, peak / 1e6);
        println!("{line}");
        if peak > estimate || estimate > 1.3 * (peak + MAPPED).max(FLOOR) {
            wrong += &format!("{line}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn gradients_asked_for_in_single_precision_are_read_as_such() {
    let streamed = |storage: &str| {
        let (code, result, err) =
            solve(&format!("spacing = 0.02\ngradient_storage = \"{storage}\""));
        assert_eq!(code, 0, "{err}");
        let work = &serde_json::from_str::<Value>(&result).unwrap()["work_counters"];
        let each = |name: &str| work[name].as_f64().unwrap();
        each("bytes_streamed") / each("force_evaluations")
    };
    assert_eq!(14.0 * streamed("double"), 26.0 * streamed("single"));
}
