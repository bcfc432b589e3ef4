//! A motion that goes on from a state that was written.

use crate::common::program::printed;
use std::path::Path;

/// A block with a stiff half falls on an obstacle, viscous, its muscle pulling, held for a while.
const CASE: &str = r#"
title = "Block"

[geometry]
shape = { box = { min = [0.0, 0.0, 0.0], max = [0.04, 0.02, 0.02] } }

[material.muscle]
law = "neo_hookean_isochoric"
density = 1000.0
young_modulus = 3000.0
poisson_ratio = 0.45
fibres = { direction = [1.0, 0.3, 0.0] }
active_stress = { tension = 600.0, amplitude = { smooth = { duration = 0.02 } } }
prony = [{ g = 0.3, tau = 0.01 }]

[material.soft]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 3000.0
poisson_ratio = 0.3

[[region]]
name = "muscle"
material = "muscle"
where = { shape = { box = { min = [0.0, 0.0, 0.0], max = [0.02, 0.02, 0.02] } } }

[[region]]
name = "soft"
material = "soft"
where = "all"

[discretisation]
cloud = "jittered"
jitter = 0.2
spacing = 0.005

[[prescribe]]
name = "end"
of = "surface"
where = { plane = { point = [0.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] } }
displacement = { x = 0.0, y = 0.0, z = 0.0 }
release = 0.03

[[body_force]]
acceleration = [0.0, 0.0, -9.81]

[[initial_velocity]]
where = "all"
velocity = [0.0, 0.0, -0.3]

[[obstacle]]
name = "floor"
shape = { half_space = { point = [0.0, 0.0, -0.002], normal = [0.0, 0.0, 1.0] } }
friction = "no_slip"

[time]
method = "dynamic"
end = 0.06

[[probe]]
name = "corner"
point = [0.04, 0.02, 0.02]

[output]
frames = 2
history = 7
states = [0.02, 0.045]
"#;

/// Exit code and all that was printed.
fn solve(folder: &Path, arguments: &[&str]) -> (i32, String) {
    printed(folder, &[&["solve", "case.toml", "--no-error-bar"], arguments].concat())
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("case.toml"), CASE).unwrap();
    folder
}

/// The rows of a history by their times.
fn history(folder: &Path, run: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join(run).join("history.csv")).unwrap();
    text.lines().map(String::from).collect()
}

#[test]
fn a_motion_that_goes_on_from_a_state_ends_with_the_same_bits() {
    let folder = folder();
    let path = folder.path();
    let (code, text) = solve(path, &["--out", "whole"]);
    assert_eq!(code, 0, "{text}");
    let file = |run: &str, name: &str| std::fs::read(path.join(run).join(name)).unwrap();
    for number in [1, 2] {
        let state = format!("whole/state_{number}.json");
        let run = format!("from_{number}");
        assert_eq!(solve(path, &["--from", &state, "--out", &run]).0, 0);
        let (whole, part) = (history(path, "whole"), history(path, &run));
        assert_eq!(whole.last(), part.last());
        // It begins with the state that it goes on from, not with a body at rest.
        let at = |rows: &[String], row: usize| {
            rows[row].split(',').map(String::from).collect::<Vec<_>>()
        };
        let jacobian = at(&part, 0).iter().position(|name| name == "smallest_jacobian").unwrap();
        assert_ne!(at(&part, 1)[jacobian], "1", "{}", part[1]);
        assert!(file("whole", "displacement_field.json") == file(&run, "displacement_field.json"));
    }
    // The second state of the run from the first one is that of the whole run.
    assert!(file("whole", "state_2.json") == file("from_1", "state_1.json"));
}

#[test]
fn a_state_that_does_not_belong_to_the_case_is_refused() {
    let folder = folder();
    let path = folder.path();
    let (code, text) = solve(path, &["--out", "whole"]);
    assert_eq!(code, 0, "{text}");
    let refused = |arguments: &[&str], message: &str| {
        let (code, text) = solve(path, &[arguments, &["--out", "other"]].concat());
        assert_eq!(code, 2, "{text}");
        assert!(text.contains(message), "{text}");
        assert!(!path.join("other/result.json").exists());
    };
    let state = ["--from", "whole/state_1.json"];
    let with = |set: &'static str| [&state[..], &["--set", set]].concat();
    refused(&with("material.soft.young_modulus=3001.0"), "it is of another body");
    refused(&with("discretisation.spacing=0.006"), "it is of another body");
    refused(&with("material.muscle.prony=[{ g = 0.3, tau = 0.02 }]"), "it is of another body");
    refused(&with("material.muscle.fibres.direction=[1.0, 0.2, 0.0]"), "it is of another body");
    refused(&with("prescribe.end.displacement={ x = 0.0, y = 0.0 }"), "it is of another body");
    refused(&with("discretisation.enforcement=direct"), "it is of another body");
    refused(&with("obstacle=[]"), "it is of another body");
    refused(&with("initial_velocity[0].velocity=[0.0, 0.0, 0.3]"), "initial velocities");
    refused(&with("obstacle.floor.name=ground"), "the names of obstacles");
    let ended = [&with("time.end=0.02")[..], &["--set", "output.states=[0.02]"]].concat();
    refused(&ended, "leaves nothing of the motion");
    refused(&["--from", "whole/result.json"], "this is not a state");
    let text = std::fs::read_to_string(path.join("whole/state_1.json")).unwrap();
    let mut edited: serde_json::Value = serde_json::from_str(&text).unwrap();
    edited["state"]["velocity"][5] = 1.25.into();
    std::fs::write(path.join("edited.json"), edited.to_string()).unwrap();
    refused(&["--from", "edited.json"], "its numbers are not those that mtled has written");
    refused(&["--from", "whole/nothing.json"], "nothing.json");
    let (code, text) = solve(path, &[&state[..], &["--out", "whole"]].concat());
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("would replace the folder of its own state"), "{text}");
    // Other loads are allowed.
    let longer = with("time.end=0.07");
    assert_eq!(solve(path, &[&longer[..], &["--out", "longer"]].concat()).0, 0);
}
