//! Questions that cannot be decided end with exit code 3 and what would decide them.

use crate::common::program::printed;
use std::path::Path;
use tempfile::TempDir;

fn outcome(folder: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(folder.join("out/results.json")).unwrap();
    serde_json::from_str::<serde_json::Value>(&text).unwrap()["outcome"].clone()
}

#[test]
fn a_goal_below_the_error_of_the_reference_is_refused_before_anything_is_tried() {
    let folder = TempDir::new().unwrap();
    let search = ["tune", "uniaxial_bar", "--reference", "own", "--truth-budget", "1ms"];
    let goal = ["--target-error", "0.0001%", "--out", "out"];
    let (code, said) = printed(&folder, &[&search[..], &goal].concat());
    assert_eq!(code, 3, "{said}");
    assert!(said.contains("inconclusive: the error of the reference itself"), "{said}");
    assert!(said.contains("0 trials"), "{said}");
    assert_eq!(outcome(folder.path()), "inconclusive");
}

#[test]
fn a_study_whose_errors_are_below_that_of_the_reference_shows_no_order() {
    let folder = TempDir::new().unwrap();
    let study = ["study", "convergence", "uniaxial_bar", "--reference", "own", "--clouds", "1"];
    let range = ["--spacing", "x1.2,x1", "--out", "out"];
    let (code, said) = printed(&folder, &[&study[..], &range].concat());
    assert_eq!(code, 3, "{said}");
    assert!(said.contains("**Inconclusive:** uniaxial_bar"), "{said}");
    assert_eq!(outcome(folder.path()), "inconclusive");
    let page = std::fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    assert!(page.contains("What is inconclusive") && !page.contains("class=\"verdict pass\""));
}

#[test]
fn a_reference_that_disagrees_with_itself_decides_nothing() {
    let folder = TempDir::new().unwrap();
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reference/data/uniaxial_bar.json");
    let mut file: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(stored).unwrap()).unwrap();
    // One code is a hundredth of the length aside, on all of its meshes.
    for mesh in file["solutions"][0]["meshes"].as_array_mut().unwrap() {
        for (name, values) in mesh["values"].as_object_mut().unwrap() {
            if name.starts_with("displacement/") {
                shift(values);
            }
        }
    }
    std::fs::write(folder.path().join("mine.json"), file.to_string()).unwrap();
    let study = ["study", "convergence", "uniaxial_bar", "--reference", "mine.json"];
    let range = ["--spacing", "x1.4,x1.2,x1", "--clouds", "2", "--out", "out"];
    let (code, said) = printed(&folder, &[&study[..], &range].concat());
    assert_eq!(code, 3, "{said}");
    assert!(said.contains("times their error bars") && said.contains("decide nothing"), "{said}");
}

fn shift(values: &mut serde_json::Value) {
    match values {
        serde_json::Value::Array(list) => list.iter_mut().for_each(shift),
        number => *number = (number.as_f64().unwrap() + 1e-3).into(),
    }
}
