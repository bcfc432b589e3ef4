//! Springs, cavities and bodies without loads by the program.

use crate::common::program::{json, mtled};

const CASE: &str = r#"
title = "A bladder"
[geometry]
shape = { difference = [
  { sphere = { centre = [0.0, 0.0, 0.0], radius = 0.05 } },
  { sphere = { centre = [0.0, 0.0, 0.0], radius = 0.035 } },
] }
[material.wall]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 30e3
poisson_ratio = 0.4
[discretisation]
cloud = "graded"
spacing = 0.009
[[spring]]
name = "tissue"
where = { half_space = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] } }
normal = 1e5
tangential = 1e4
[[cavity]]
name = "inside"
where = { sphere = { centre = [0.0, 0.0, 0.0], radius = 0.04 } }
fluid = { inflow = 40e-6 }
[time]
method = "static"
[output]
volumes = true
"#;

fn written(text: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap().to_string();
    (folder, path)
}

fn run(arguments: &[&str]) -> (i32, String, String) {
    mtled(".", arguments)
}

#[test]
fn an_inflow_is_the_volume_that_a_cavity_gains_and_its_pressure_is_printed_and_stored() {
    let (folder, case) = written(CASE);
    let out = folder.path().join("out");
    let (code, printed, err) =
        run(&["solve", &case, "--no-error-bar", "--out", out.to_str().unwrap()]);
    assert_eq!(code, 0, "{err}");
    assert!(printed.contains("volume of cavity \"inside\""), "{printed}");
    let result = std::fs::read_to_string(out.join("result.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&result).unwrap();
    let cavity = &result["cavities"][0];
    let number = |key: &str| cavity[key].as_f64().unwrap();
    let gained = number("volume_m3") - number("volume_at_start_m3");
    assert!((gained - 40e-6).abs() < 1e-5 * 40e-6, "{gained}");
    assert!(number("pressure_pa") > 100.0);
    assert!(result["region_volumes_m3"]["body"].as_f64().unwrap() > 1e-4, "{result}");
    let force = result["springs"][0]["force_n"].as_array().unwrap();
    let size = force.iter().map(|f| f.as_f64().unwrap().abs()).fold(0.0, f64::max);
    assert!(size < 0.05, "springs on a body that nothing else holds balance: {size}");
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    let header = history.lines().next().unwrap();
    for column in ["tissue.fx_n", "inside.volume_m3", "inside.pressure_pa", "body.volume_m3"] {
        assert!(header.split(',').any(|own| own == column), "{header}");
    }
}

#[test]
fn a_cavity_that_is_open_or_none_and_a_spring_beside_the_body_are_located() {
    let half = CASE.replace(
        "where = { sphere = { centre = [0.0, 0.0, 0.0], radius = 0.04 } }",
        "where = { intersection = [ { sphere = { centre = [0.0, 0.0, 0.0], radius = 0.04 } }, \
         { half_space = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] } } ] }",
    );
    let outside = CASE.replace("radius = 0.04 } }\nfluid", "radius = 0.06 } }\nfluid");
    let beside = CASE
        .replace("[0.0, 0.0, 0.0], normal", "[0.0, 0.0, 9.0], normal")
        .replace("normal = [0.0, 0.0, 1.0]", "normal = [0.0, 0.0, -1.0]");
    let expected = [
        (half, "cavity.inside.where", "is open"),
        (outside, "cavity.inside.where", "has a volume of"),
        (beside, "spring.tissue.where", "selects no part"),
    ];
    for (text, key, what) in expected {
        let (_folder, case) = written(&text);
        let (code, _, err) = run(&["solve", &case, "--no-error-bar"]);
        assert_eq!(code, 2, "{err}");
        assert!(err.contains(key) && err.contains(what), "{err}");
    }
}

const SAGGED: &str = r#"
title = "A block that has sagged"
[geometry]
shape = { box = { min = [0.0, 0.0, 0.0], max = [0.1, 0.1, 0.1] } }
[material.gel]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 6000.0
poisson_ratio = 0.4
[discretisation]
cloud = "regular"
spacing = 0.02
[[prescribe]]
name = "wall"
of = "surface"
where = { plane = { point = [0.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] } }
displacement = { x = 0.0, y = 0.0, z = 0.0 }
[[body_force]]
acceleration = [0.0, 0.0, -9.81]
[time]
method = "static"
"#;

#[test]
fn the_unloaded_body_takes_its_known_shape_again_and_is_written() {
    let (folder, case) = written(SAGGED);
    let out = folder.path().join("out");
    let found = json(&["unload", &case, "--out", out.to_str().unwrap()]);
    assert_eq!(found["found"], true);
    let last = found["distances"].as_array().unwrap().last().unwrap();
    let number = |key: &str| last[key].as_f64().unwrap();
    assert!(number("largest_m") <= 1e-4 * number("largest_displacement_m"), "{found}");
    assert!(number("largest_displacement_m") > 0.01, "{found}");
    for name in ["unloaded.json", "body_unloaded.vtu", "nodes_unloaded.vtu", "unloaded.stl"] {
        assert!(out.join(name).exists(), "{name}");
    }
}

#[test]
fn what_cannot_be_unloaded_is_refused_with_its_name() {
    let (_folder, case) = written(CASE);
    let (code, _, err) = run(&["unload", &case]);
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("springs"), "{err}");
}

/// A cube of 40 mm on springs all around is as good as rigid: ω² = Σ k A/m.
#[test]
fn a_body_on_springs_swings_as_a_mass_on_their_sum() {
    let case = r#"
title = "A cube on springs"
[geometry]
shape = { box = { min = [0.0, 0.0, 0.0], max = [0.04, 0.04, 0.04] } }
[material.rubber]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 1e7
poisson_ratio = 0.3
[discretisation]
cloud = "regular"
spacing = 0.01
[[spring]]
name = "tissue"
where = "all"
normal = 1e4
tangential = 3e3
[time]
method = "static"
"#;
    let (_folder, case) = written(case);
    let found = json(&["frequencies", &case, "--modes", "3"]);
    let expected = ((2.0 * 1e4 + 4.0 * 3e3) / (1000.0 * 0.04f64)).sqrt() / std::f64::consts::TAU;
    let first = found["modes"][0]["frequency_hz"].as_f64().unwrap_or_else(|| panic!("{found}"));
    assert!((first - expected).abs() < 2e-3 * expected, "{first} {expected}");
}

#[test]
fn a_body_without_loads_is_its_own_and_one_that_nothing_holds_is_refused() {
    let still = SAGGED.replace("-9.81", "0.0");
    let (_folder, case) = written(&still);
    assert_eq!(json(&["unload", &case])["found"], true);
    let i = SAGGED.find("[[prescribe]]").unwrap();
    let j = SAGGED.find("[[body_force]]").unwrap();
    let free = format!("{}{}", &SAGGED[..i], &SAGGED[j..]);
    let (_folder, case) = written(&free);
    let (code, _, err) = run(&["unload", &case]);
    assert!(code == 2 && err.contains("move freely"), "{code} {err}");
}
