//! A gate on cases that nobody here wrote: an egg from an STL file and a bean from a label map,
//! both made on the spot, from `mtled init` to a red gate.

use crate::common::program::mtled;
use std::fmt::Write;
use std::path::Path;
use tempfile::TempDir;

fn replace(file: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{from} in {text}");
    std::fs::write(file, text.replace(from, to)).unwrap();
}

/// An egg 70 mm high on its blunt end, in millimetres.
fn egg() -> String {
    const RINGS: usize = 12;
    const SECTORS: usize = 20;
    let at = |ring: usize, sector: usize| {
        let polar = std::f64::consts::PI * ring as f64 / RINGS as f64;
        let turn = 2.0 * std::f64::consts::PI * (sector % SECTORS) as f64 / SECTORS as f64;
        // The poles are one point each, without round-off.
        let inner = f64::from(u8::from(ring > 0 && ring < RINGS));
        let wide = inner * (25.0 - 4.0 * polar.cos()) * polar.sin();
        [wide * turn.cos(), wide * turn.sin(), 35.0 + 35.0 * polar.cos()]
    };
    let mut stl = "solid egg\n".to_string();
    let mut facet = |corners: [[f64; 3]; 3]| {
        if corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] {
            stl += "facet normal 0 0 0\nouter loop\n";
            for [x, y, z] in corners {
                let _ = writeln!(stl, "vertex {x} {y} {z}");
            }
            stl += "endloop\nendfacet\n";
        }
    };
    for ring in 0..RINGS {
        for sector in 0..SECTORS {
            let (a, b) = (at(ring, sector), at(ring, sector + 1));
            let (c, d) = (at(ring + 1, sector), at(ring + 1, sector + 1));
            if ring > 0 {
                facet([a, c, b]);
            }
            if ring + 1 < RINGS {
                facet([b, c, d]);
            }
        }
    }
    stl + "endsolid egg\n"
}

/// A bean in 24³ voxels of 2 mm.
fn bean() -> Vec<u8> {
    let mut bytes =
        b"NRRD0005\ntype: unsigned char\ndimension: 3\nspace: right-anterior-superior\n\
        sizes: 24 24 24\nspace directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (0,0,0)\n\
        encoding: raw\n\n"
            .to_vec();
    for at in 0..24usize.pow(3) {
        let [x, y, z] = [at % 24, at / 24 % 24, at / 576].map(|i| i as f64 - 11.5);
        let bend = 0.03 * x * x;
        bytes.push(u8::from(
            (x / 10.0).powi(2) + ((y - bend) / 6.0).powi(2) + (z / 6.0).powi(2) < 1.0,
        ));
    }
    bytes
}

const EGG: &str = r#"title = "An egg on its end"
[geometry]
shape = { stl = { file = "egg.stl", unit = "mm" } }
[material.yolk]
law = "neo_hookean_isochoric"
density = 1000.0
young_modulus = 2000.0
poisson_ratio = 0.45
[discretisation]
cloud = "graded"
spacing = 0.012
[[prescribe]]
name = "floor"
of = "surface"
where = { box = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 0.006] } }
displacement = { x = 0.0, y = 0.0, z = 0.0 }
[[body_force]]
acceleration = [0.0, 0.0, -2.0]
[time]
method = "static"
[[probe]]
name = "top"
point = [0.0, 0.0, 0.069]
"#;

const BEAN: &str = r#"title = "A bean that is bent"
[geometry]
shape = { label_map = { file = "bean.nrrd", labels = [1] } }
[material.flesh]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 5000.0
poisson_ratio = 0.4
[discretisation]
cloud = "graded"
spacing = 0.006
[[prescribe]]
name = "end"
of = "surface"
where = { box = { min = [-1.0, -1.0, -1.0], max = [0.008, 1.0, 1.0] } }
displacement = { x = 0.0, y = 0.0, z = 0.0 }
[[body_force]]
acceleration = [0.0, 0.0, -1.0]
[time]
method = "static"
[[probe]]
name = "middle"
point = [0.023, 0.023, 0.023]
"#;

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("egg.stl"), egg()).unwrap();
    std::fs::write(folder.path().join("bean.nrrd"), bean()).unwrap();
    std::fs::write(folder.path().join("egg.toml"), EGG).unwrap();
    std::fs::write(folder.path().join("bean.toml"), BEAN).unwrap();
    folder
}

#[test]
fn from_two_cases_to_a_gate_that_names_the_figure_that_a_fault_breaks() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (code, out, err) = mtled(&folder, &["init"]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("egg.toml: errors at most displacement"), "{out}\n{err}");
    for file in
        ["suite.toml", "baseline.json", "references/bean.json", ".github/workflows/accuracy.yml"]
    {
        assert!(at(file).is_file(), "{file}: {out}");
    }
    // A run is stored under all that decides it: the gate is green at once.
    let gate = ["verify", "--suite", "suite.toml", "--out", "out"];
    let (code, out, err) = mtled(&folder, &gate);
    assert_eq!(code, 0, "{out}\n{err}");
    let (code, out, _) = mtled(&folder, &[&gate[..], &["--only", "egg"]].concat());
    assert!(code == 0 && !out.contains("A bean that is bent"), "{out}");
    // The stiffness of a faulty solver, in all but the number of the problem.
    replace(&at("egg.toml"), "poisson_ratio = 0.45", "poisson_ratio = 0.3");
    let (code, _, err) = mtled(&folder, &gate);
    assert_eq!(code, 2, "another problem has another reference: {err}");
    assert!(err.contains("suite.toml:") && err.contains("made for another problem"), "{err}");
    replace(&at("egg.toml"), "poisson_ratio = 0.3", "poisson_ratio = 0.45");
    replace(&at("egg.toml"), "spacing = 0.012", "spacing = 0.012\ngradients = \"plain\"");
    let (code, out, err) = mtled(&folder, &gate);
    assert_eq!(code, 1, "{out}\n{err}");
    assert!(out.contains("worse") && out.contains("egg/patch/displacement"), "{out}");
    assert!(at("out/junit.xml").is_file() && at("out/index.html").is_file());
    // A second start writes over nothing.
    let (code, _, err) = mtled(&folder, &["init"]);
    assert!(code == 2 && err.contains("suite.toml is there already"), "{err}");
    // What a start that was killed has left out is finished, and nothing else is touched.
    let (suite, baseline) = (at("suite.toml"), at("baseline.json"));
    let kept = std::fs::read(&suite).unwrap();
    let first = std::fs::read_to_string(&baseline).unwrap();
    std::fs::remove_file(&baseline).unwrap();
    std::fs::remove_file(at(".github/workflows/accuracy.yml")).unwrap();
    replace(&at("egg.toml"), "\ngradients = \"plain\"", "");
    let (code, out, err) = mtled(&folder, &["init"]);
    assert!(code == 0 && out.starts_with("written: baseline.json"), "{out}\n{err}");
    assert!(at(".github/workflows/accuracy.yml").is_file());
    assert_eq!(std::fs::read(&suite).unwrap(), kept);
    let checks = |text: &str| text[text.find("\"checks\"").unwrap()..].to_string();
    assert_eq!(checks(&std::fs::read_to_string(&baseline).unwrap()), checks(&first));
    replace(&at("egg.toml"), "spacing = 0.012", "spacing = 0.012\ngradients = \"plain\"");
    // On purpose: a baseline with the reason for it. Its bounds may be undecided now.
    let update = ["--update-baseline", "--reason", "plain gradients are enough"];
    let (code, out, err) = mtled(&folder, &[&gate[..], &update].concat());
    assert!([0, 3].contains(&code), "{out}\n{err}");
    let (again, out, _) = mtled(&folder, &gate);
    assert_eq!(again, code, "{out}");
    assert!(out.contains("37 the same") || out.contains("38 the same"), "{out}");
}

#[test]
fn a_bound_that_the_reference_cannot_decide_is_inconclusive() {
    let folder = folder();
    std::fs::remove_file(folder.path().join("bean.toml")).unwrap();
    let (code, _, err) = mtled(&folder, &["init", "--refine", "1.3"]);
    assert_eq!(code, 0, "{err}");
    let gate = ["verify", "--suite", "suite.toml", "--out", "out"];
    let results = |folder: &Path| -> serde_json::Value {
        let text = std::fs::read_to_string(folder.join("out/results.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    assert_eq!(mtled(&folder, &gate).0, 0);
    let checks = results(folder.path());
    let check = checks["checks"].as_array().unwrap().iter();
    let error = check.clone().find(|check| check["id"] == "egg/error/strain_energy").unwrap();
    let (value, bar) =
        (error["value"].as_f64().unwrap(), error["reference_error"].as_f64().unwrap());
    // A bound between what was measured and that with the error of the reference.
    let suite = folder.path().join("suite.toml");
    let text = std::fs::read_to_string(&suite).unwrap();
    let line = text.lines().find(|line| line.starts_with("strain_energy = ")).unwrap();
    replace(&suite, line, &format!("strain_energy = {}", value + 0.5 * bar));
    let (code, out, err) = mtled(&folder, &gate);
    assert_eq!(code, 3, "{out}\n{err}");
    assert!(out.contains("INCONCLUSIVE egg") && out.contains("mtled init --references"), "{out}");
    assert_eq!(results(folder.path())["outcome"], "inconclusive");
}

#[test]
fn mistakes_in_a_suite_are_located() {
    let folder = folder();
    let suite = folder.path().join("suite.toml");
    let cases = [
        (
            "[[case]]\nfile = \"egg.toml\"\nreferense = \"x\"\n",
            "suite.toml:3:1",
            "did you mean `reference`",
        ),
        ("[[case]]\nfile = \"liver.toml\"\n", "suite.toml:2:8", "there is no file"),
        (
            "[[case]]\nfile = \"egg.toml\"\n[case.error]\nforce = 0.1\n",
            "suite.toml:4:9",
            "needs a reference",
        ),
        (
            "[[case]]\nfile = \"egg.toml\"\n[[case]]\nfile = \"./egg.toml\"\n",
            "suite.toml:4:8",
            "another case egg",
        ),
        ("case = []\n", "suite.toml:1", "has no case"),
        ("[[case]]\nfile = \"egg.toml\"\nset = [\"spacing\"]\n", "suite.toml:3", "set"),
    ];
    for (text, place, reason) in cases {
        std::fs::write(&suite, text).unwrap();
        let (code, _, err) = mtled(&folder, &["verify", "--suite", "suite.toml"]);
        assert_eq!(code, 2, "{text}: {err}");
        assert!(err.contains(place) && err.contains(reason), "{text}: {err}");
    }
    let (code, _, err) = mtled(&folder, &["verify", "--suite", "quik"]);
    assert!(code == 2 && err.contains("quick, full"), "{err}");
}
