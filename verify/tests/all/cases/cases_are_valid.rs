//! Every case in reference/cases can be read, and the schema of the format is
//! complete.

use mtled::discretisation::nodes::node_cloud;
use mtled::geometry::Extent;
use mtled::problem::{Cloud, Dimension, Motion, Prescribed};
use mtled_case::bundled::LARGE;
use mtled_case::scene::{Case, parse_case, read_case, schema};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

fn cases() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../reference/cases"))
}

/// All cases, read once.
static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
    let paths = std::fs::read_dir(cases()).unwrap().map(|entry| entry.unwrap().path());
    paths
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .map(|path| {
            read_case(&path).unwrap_or_else(|mistakes| {
                panic!("{}", mistakes.iter().map(|m| format!("{m}\n")).collect::<String>())
            })
        })
        .collect()
});

fn case(name: &str) -> &'static Case {
    CASES.iter().find(|case| case.name == name).unwrap()
}

#[test]
fn every_case_is_valid_and_has_a_title_and_a_source() {
    assert!(CASES.len() >= 12, "only {} cases", CASES.len());
    for case in CASES.iter() {
        assert!(!case.title.is_empty() && !case.source.is_empty(), "{}", case.name);
        assert!(!case.probes.is_empty(), "{} records nothing", case.name);
        assert_eq!(case.hash.len(), 64);
    }
}

#[test]
fn every_case_makes_as_many_nodes_as_its_size_allows_and_every_condition_selects_some() {
    for case in CASES.iter() {
        let problem = &case.problem;
        let cloud = &problem.recipe.cloud;
        let nodes = node_cloud(&problem.body, cloud, &problem.dimension).unwrap();
        let count = nodes.positions.len();
        let most = if LARGE.contains(&case.name.as_str()) { 6000 } else { 3000 };
        assert!((200..most).contains(&count), "{}: {count} nodes", case.name);
        for condition in &problem.conditions {
            let selected = (nodes.positions.iter().zip(&nodes.on_boundary))
                .filter(|(_, on_boundary)| **on_boundary || condition.extent == Extent::Volume)
                .filter(|(position, _)| condition.part.contains(position))
                .count();
            println!("{}: {count} nodes, {selected} in {}", case.name, condition.name);
            assert!(selected >= 3, "{}: {selected} nodes in {}", case.name, condition.name);
        }
        for region in &problem.regions {
            let contains = |position| region.part.contains(position);
            assert!(nodes.positions.iter().any(contains), "{}: {}", case.name, region.name);
        }
    }
}

#[test]
fn the_schema_is_json_and_describes_every_table() {
    let schema: serde_json::Value = serde_json::from_str(&schema()).unwrap();
    let properties = schema["properties"].as_object().unwrap();
    for key in [
        "title",
        "description",
        "source",
        "dimension",
        "plane",
        "geometry",
        "region",
        "material",
        "discretisation",
        "prescribe",
        "body_force",
        "traction",
        "initial_velocity",
        "obstacle",
        "time",
        "probe",
        "output",
    ] {
        assert!(properties.contains_key(key), "{key}");
    }
    assert!(
        schema["$defs"]["MaterialFormat"]["properties"]["density"]["description"]
            .as_str()
            .unwrap()
            .contains("kg/m³")
    );
    assert_eq!(schema["additionalProperties"], serde_json::Value::Bool(false));
}

#[test]
fn the_brain_slice_is_that_of_horton_2007() {
    let case = case("brain_slice");
    let problem = &case.problem;
    assert_eq!(problem.dimension, Dimension::PlaneStrain { thickness: 0.005, z: 0.018 });
    let names: Vec<&str> = problem.regions.iter().map(|region| region.name.as_str()).collect();
    assert_eq!(names, ["ventricles", "tumour", "brain"]);
    assert!(matches!(problem.motion, Motion::Dynamic { end: 2.0, damping: 50.0, .. }));
    assert_eq!(problem.conditions[0].release, Some(1.0));
    let Prescribed::Displacement([Some(x), Some(y), None]) = problem.conditions[0].prescribed
    else {
        panic!("the craniotomy moves in the plane")
    };
    assert!((x.hypot(y) - 0.006).abs() < 1e-5);
    assert!(matches!(problem.recipe.cloud, Cloud::Graded { .. }));
}

#[test]
fn keys_of_a_case_are_found_by_index_and_by_name() {
    let case = case("cube_compression");
    let by_index = case.locate("prescribe[1].where").unwrap();
    assert_eq!(case.locate("prescribe.top.where").unwrap(), by_index);
    assert!(by_index.line > case.locate("prescribe.bottom").unwrap().line);
    assert_eq!(case.locate("prescribe.lid"), None);
    let diagnostic = case.diagnostic("prescribe.top.where", "selects no node".to_string());
    let printed = diagnostic.to_string();
    assert!(printed.contains(&format!("cube_compression.toml:{}:9: ", by_index.line)), "{printed}");
    assert!(printed.contains("^^^^"), "{printed}");
}

#[test]
fn positions_of_a_lattice_outside_the_body_are_left_out_and_counted_on_any_cloud() {
    let ball = |spacing: f64| {
        let text = format!(
            "title = \"Ball\"\n\
             geometry.shape = {{ sphere = {{ centre = [0.0, 0.0, 0.0], radius = 0.1 }} }}\n\
             material.tissue = {{ law = \"neo_hookean_log_j\", density = 1000.0, \
             young_modulus = 3000.0, poisson_ratio = 0.45 }}\n\
             discretisation = {{ cloud = \"regular\", spacing = {spacing} }}\n\
             time.method = \"static\"\n\
             prescribe = [{{ name = \"all\", of = \"surface\", where = \"all\", \
             displacement = {{ x = 0.0 }} }}]\n\
             probe = [{{ name = \"grid\", lattice = {{ min = [-0.1, -0.1, -0.1], \
             max = [0.1, 0.1, 0.1], counts = [3, 3, 3] }} }}]\n"
        );
        parse_case(&text, "ball.toml", Path::new(".")).unwrap().probes[0].kind.clone()
    };
    // The centre and the six poles remain.
    assert_eq!((ball(0.02).count(), ball(0.02).left_out()), (7, 20));
    assert_eq!(ball(0.02), ball(0.05));
}

#[test]
fn a_lattice_lists_its_positions_with_x_fastest() {
    let case = case("cube_compression");
    let lattice = &case.probes.iter().find(|probe| probe.name == "lattice").unwrap().kind;
    assert!(lattice.count() == 11 * 11 * 11 && lattice.left_out() == 0);
    let positions = lattice.positions();
    assert_eq!(positions.len(), 1331);
    assert!((positions[1].x - 0.01).abs() < 1e-15 && positions[1].y == 0.0);
    assert!((positions[1330] - nalgebra::Vector3::repeat(0.1)).norm() < 1e-15);
}

#[test]
fn the_hash_covers_the_file_and_the_files_it_refers_to() {
    let hash = |files: &[&str]| {
        let mut hash = Sha256::new();
        files.iter().for_each(|file| hash.update(std::fs::read(cases().join(file)).unwrap()));
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect::<String>()
    };
    assert_eq!(case("cube_shear").hash, hash(&["cube_shear.toml"]));
    assert_eq!(case("brain_slice").hash, hash(&["brain_slice.toml", "../brain/slice.nrrd"]));
}

#[test]
fn a_case_cut_short_anywhere_is_refused_or_read_but_never_panics() {
    let text = std::fs::read_to_string(cases().join("cook_membrane.toml")).unwrap();
    for (end, _) in text.char_indices() {
        if let Err(mistakes) = parse_case(&text[..end], "cut.toml", &cases()) {
            assert!(!mistakes.is_empty());
            mistakes.iter().for_each(|mistake| assert!(!mistake.to_string().is_empty()));
        }
    }
}
