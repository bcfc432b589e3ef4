//! A small case and a made-up reference to it, for the tests of references.

use mtled_case::reference::{Mesh, ReferenceFile, Solution, Values, quantities};
use mtled_case::scene::{Case, parse_case};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

pub mod program;

pub const BLOCK: &str = concat!(
    "\n",
    include_str!("pulled_block.toml"),
    r#"[time]
method = "static"
load_end = 1.0

[[probe]]
name = "top"
point = [0.05, 0.05, 0.1]

[[probe]]
name = "middle"
centre_of_mass = "body"
"#
);

pub fn block() -> Case {
    parse_case(BLOCK, "block.toml", Path::new(".")).unwrap()
}

/// f₀ + a hᵖ for every number, with a slope of its own per code.
pub fn synthetic(case: &Case) -> ReferenceFile {
    let values = |slope: f64, h: f64| -> BTreeMap<String, Values> {
        let value = |n: usize| 0.01 * (1 + n) as f64 * (1.0 + slope * h.powi(2));
        let named = quantities(case).into_iter().map(|quantity| {
            let list: Vec<f64> = (0..quantity.width).map(value).collect();
            let values =
                if quantity.changes { Values::History(vec![list]) } else { Values::Once(list) };
            (quantity.name, values)
        });
        named.collect()
    };
    let solution = |code: &str, slope: f64| Solution {
        code: code.into(),
        version: "1.0".into(),
        date: "2026-11-21".into(),
        formulation: "displacement".into(),
        element: "Q2".into(),
        mesh_family: "hexahedra".into(),
        solver: "Newton".into(),
        time_scheme: None,
        packages: BTreeMap::from([("python".into(), "3.11".into())]),
        meshes: [0.04, 0.02, 0.01]
            .map(|h: f64| Mesh {
                size_m: h,
                elements: (0.1 / h).powi(3) as u64,
                unknowns: 100,
                cpu_s: 1.0,
                peak_memory_bytes: 1_000_000,
                time_step_s: None,
                load_steps: Some(1),
                newton_iterations: Some(4),
                values: values(slope, h),
            })
            .into(),
    };
    ReferenceFile {
        schema_version: 1,
        case: case.name.clone(),
        problem_hash: case.problem_hash.clone(),
        times_s: vec![1.0],
        solutions: vec![solution("fenicsx", 50.0), solution("scikit-fem", -80.0)],
    }
}

pub fn json(file: &ReferenceFile) -> Value {
    serde_json::to_value(file).unwrap()
}
