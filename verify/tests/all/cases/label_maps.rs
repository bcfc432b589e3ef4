//! Label maps made for the occasion: bodies that rest in a mould of themselves.
#![allow(non_snake_case)]

use mtled::Simulation;
use mtled_case::scene::read_case;
use mtled_run::run::solve_case;
use std::path::Path;

/// Writes a label map of `SIZE`³ voxels of 2 mm and a case in which the body of all its labels
/// sinks in a frictionless mould 1 mm around it.
fn write_case(dir: &Path, label: impl Fn([f64; 3]) -> u8) -> std::path::PathBuf {
    let mut bytes = format!(
        "NRRD0005\ntype: unsigned char\ndimension: 3\nspace: right-anterior-superior\n\
         sizes: {SIZE} {SIZE} {SIZE}\nspace directions: (2,0,0) (0,2,0) (0,0,2)\n\
         space origin: (-7,3,11)\nencoding: raw\n\n"
    )
    .into_bytes();
    let mut labels: Vec<u8> = Vec::new();
    for at in 0..SIZE.pow(3) {
        labels.push(label([at % SIZE, at / SIZE % SIZE, at / SIZE.pow(2)].map(|i| i as f64)));
    }
    let mut found: Vec<u8> = labels.iter().copied().filter(|&label| label > 0).collect();
    found.sort_unstable();
    found.dedup();
    bytes.extend(labels);
    std::fs::write(dir.join("map.nrrd"), bytes).unwrap();
    let shape =
        format!("{{ label_map = {{ file = \"map.nrrd\", labels = {found:?}, smoothing = 1.4 }} }}");
    let case = format!(
        "title = \"A body in its mould\"\n[geometry]\nshape = {shape}\n[material.tissue]\n\
         law = \"neo_hookean_isochoric\"\ndensity = 1000.0\nyoung_modulus = 3000.0\n\
         poisson_ratio = 0.49\n[discretisation]\ncloud = \"graded\"\nspacing = 0.004\n\
         [[body_force]]\nacceleration = [0.0, 0.0, -3.0]\n[[obstacle]]\nname = \"mould\"\n\
         shape = {shape}\noffset = 0.001\nside = \"inside\"\nfriction = \"frictionless\"\n\
         [time]\nmethod = \"static\"\nsolver = \"newton\"\ntolerance = 1e-5\n"
    );
    std::fs::write(dir.join("case.toml"), case).unwrap();
    dir.join("case.toml")
}

const SIZE: usize = 30;

/// The weight of the body and what its mould exerts \[N\].
fn weight_and_force(label: impl Fn([f64; 3]) -> u8) -> (f64, f64) {
    let folder = tempfile::tempdir().unwrap();
    let case = read_case(&write_case(folder.path(), label)).unwrap();
    let (solved, _) = solve_case(&case).unwrap();
    let results = solved.simulation.contact_results().unwrap();
    assert!(results[0].nodes > 20 && results[0].area > 0.0 && results[0].largest_pressure > 0.0);
    assert!(results[0].force.xy().norm() < 1e-3 * results[0].force.z);
    // The mould is a millimetre away, and nodes are 4 mm apart.
    assert!((0.0..0.6e-3).contains(&results[0].depth), "{}", results[0].depth);
    (3.0 * solved.simulation.model.lumped_mass.iter().sum::<f64>(), results[0].force.z)
}

fn carries_its_weight(label: impl Fn([f64; 3]) -> u8) {
    let (weight, force) = weight_and_force(label);
    assert!((force / weight - 1.0).abs() < 1e-3, "{force} N of {weight} N");
}

fn distance(at: [f64; 3], centre: [f64; 3]) -> f64 {
    (0..3).map(|k| (at[k] - centre[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn a_bean_rests_in_its_mould() {
    let spine = |t: f64| [15.0 + 8.0 * t.sin(), 8.0 + 9.0 * t.cos(), 15.0];
    let near = |at: [f64; 3]| (-20..=20).any(|n| distance(at, spine(0.055 * n as f64)) < 5.2);
    carries_its_weight(|at| u8::from(near(at)));
}

#[test]
fn a_shell_little_thicker_than_a_voxel_rests_in_its_mould() {
    carries_its_weight(|at| u8::from((9.2..10.6).contains(&distance(at, [15.0, 14.0, 15.5]))));
}

#[test]
fn holes_of_single_voxels_are_no_obstacle() {
    let hole = |at: [f64; 3]| (at[0] * 7.0 + at[1] * 13.0 + at[2] * 29.0) % 97.0 == 0.0;
    carries_its_weight(|at| u8::from(distance(at, [15.0, 14.0, 15.5]) < 9.5 && !hole(at)));
}

#[test]
fn a_voxel_apart_from_the_body_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let body = |at: [f64; 3]| match at {
        [2.0, 2.0, 2.0] => 3,
        _ => u8::from(distance(at, [17.0, 16.0, 15.0]) < 8.0),
    };
    let case = read_case(&write_case(folder.path(), body)).unwrap();
    let message = Simulation::with_any_recipe(&case.problem).unwrap_err().to_string();
    assert!(message.contains("support") && message.contains("m)"), "{message}");
}

/// The force \[N\] that stretches a bar of 20 × 8 × 8 voxels of 1 mm by 0.1 mm, four layers of them a
/// thousand times as soft; one of the two materials is that of a label, the other of all that is left.
fn force_on_layered_bar(label: u32, own: &str, rest: &str) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let header = "NRRD0005\ntype: unsigned char\ndimension: 3\nspace: right-anterior-superior\n\
                  sizes: 20 8 8\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n\
                  space origin: (0.5,0.5,0.5)\nencoding: raw\n\n";
    let mut bytes = header.as_bytes().to_vec();
    bytes.extend((0..20 * 64).map(|at| if (8..12).contains(&(at % 20)) { 2 } else { 1 }));
    std::fs::write(folder.path().join("map.nrrd"), bytes).unwrap();
    let material = |name: &str, young_modulus: f64| {
        format!(
            "[material.{name}]\nlaw = \"neo_hookean_log_j\"\ndensity = 1000.0\n\
             young_modulus = {young_modulus}\npoisson_ratio = 0.0\n"
        )
    };
    let hold = |name: &str, from: f64, side: f64, by: f64| {
        format!(
            "[[prescribe]]\nname = \"{name}\"\nof = \"surface\"\nwhere = {{ half_space = {{ point = [{from}, 0.0, 0.0], \
             normal = [{side}, 0.0, 0.0] }} }}\ndisplacement = {{ x = {by}, y = 0.0, z = 0.0 }}\n"
        )
    };
    let case = format!(
        "title = \"A bar with a soft layer\"\n[geometry]\nshape = {{ label_map = {{ file = \"map.nrrd\", labels = [1, 2] }} }}\n\
         [[region]]\nname = \"own\"\nwhere = {{ label = {{ value = {label} }} }}\nmaterial = \"{own}\"\n\
         [[region]]\nname = \"rest\"\nwhere = \"all\"\nmaterial = \"{rest}\"\n{}{}\
         [discretisation]\ncloud = \"regular\"\nspacing = 0.002\n{}{}[time]\nmethod = \"static\"\n",
        material("hard", 3000.0),
        material("soft", 3.0),
        hold("left", 0.0005, 1.0, 0.0),
        hold("right", 0.0195, -1.0, 1e-4)
    );
    let path = folder.path().join("case.toml");
    std::fs::write(&path, case).unwrap();
    let (_, record) = solve_case(&read_case(&path).unwrap()).unwrap();
    let last = record.samples.last().unwrap();
    last.reactions[1].force.x
}

#[test]
fn the_material_that_is_left_over_makes_no_skin_around_a_soft_layer() {
    // Without a change of width two of hard and one of soft are springs in a row.
    let exact = 3000.0 * 64e-6 * 1e-4 / (0.016 + 4.0);
    for (label, own, rest) in [(2, "soft", "hard"), (1, "hard", "soft")] {
        let force = force_on_layered_bar(label, own, rest);
        assert!((force / exact - 1.0).abs() < 0.05, "{own} by its label: {force} N, not {exact}");
    }
}
