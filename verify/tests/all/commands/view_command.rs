//! `mtled view` and the page of a run from the outside.

use crate::common::program::mtled;
use tempfile::TempDir;

const BLOCK: &str = concat!("\n", include_str!("../common/pulled_block.toml"));
const STATIC: &str = "[time]\nmethod = \"static\"\nload_end = 1.0\n";

/// A folder with a solved case in `out`.
fn solved(output: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    let case = [BLOCK, STATIC, output].concat();
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    let (code, _, err) = mtled(&folder, &["solve", "case.toml", "--out", "out", "-q"]);
    assert_eq!(code, 0, "{err}");
    folder
}

#[test]
fn the_body_of_a_run_is_drawn_with_the_chosen_field_direction_and_panels() {
    let folder = solved("");
    let (code, out, err) = mtled(&folder, &["view", "out"]);
    assert_eq!((code, out.as_str(), err.as_str()), (0, "out/picture.svg\n", ""));
    let picture = std::fs::read_to_string(folder.path().join("out/picture.svg")).unwrap();
    assert_eq!(picture.matches("<image ").count(), 3);
    assert!(picture.contains("displacement [mm]"));
    let other = ["view", "out", "-o", "p.svg", "--field", "von_mises_stress"];
    let turned = ["--from", "-1,0.5,2", "--show", "after", "--frame", "0", "--format", "json"];
    let (code, out, err) = mtled(&folder, &[&other[..], &turned].concat());
    assert_eq!(code, 0, "{err}");
    let printed: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(printed["frame"], "out/body_0000.vtu");
    let picture = std::fs::read_to_string(folder.path().join("p.svg")).unwrap();
    assert_eq!(picture.matches("<image ").count(), 1);
    assert!(picture.contains("von Mises stress ["));
}

#[test]
fn what_cannot_be_drawn_is_refused_with_its_reason_and_nothing_is_written() {
    let folder = solved("");
    let refusals: [(&[&str], &str); 5] = [
        (&["view", "out", "-o", "p.png"], "p.png: pictures are SVG"),
        (&["view", "out", "-o", "p.svg", "--field", "colour"], "it has displacement, J"),
        (
            &["view", "out", "-o", "p.svg", "--frame", "77"],
            "no frame of the body with the number 77",
        ),
        (&["view", "nowhere", "-o", "p.svg"], "cannot read the folder nowhere"),
        (&["view", "out", "-o", "p.svg", "--from", "0,0,0"], "three numbers that are not all zero"),
    ];
    for (arguments, reason) in refusals {
        let (code, out, err) = mtled(&folder, arguments);
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}");
        assert!(err.contains(reason), "{arguments:?}: {err}");
    }
    let frame = folder.path().join("out/body_0001.vtu");
    let bytes = std::fs::read(&frame).unwrap();
    std::fs::write(&frame, &bytes[..bytes.len() / 2]).unwrap();
    let last = ["view", "out", "-o", "p.svg", "--frame", "1"];
    let (code, _, err) = mtled(&folder, &last);
    assert!(code == 2 && err.contains("body_0001.vtu"), "{err}");
    assert!(!folder.path().join("p.svg").exists() && !folder.path().join("p.png").exists());
}

#[test]
fn the_page_of_a_run_has_verdict_pictures_answers_and_cost_and_needs_nothing_else() {
    let folder = solved("");
    let page = std::fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    for part in ["Converged to its tolerance", "Before", "After", "± ", "What it cost", "case.pvd"]
    {
        assert!(page.contains(part), "{part}");
    }
    assert!(page.len() < 1_000_000, "{}", page.len());
    let outside = page.replace("http://www.w3.org/2000/svg", "");
    assert!(!outside.contains("://") && !page.contains("<script"));
}

#[test]
fn a_run_without_frames_has_a_page_without_pictures() {
    let folder = solved("[output]\nframes = 0\n");
    let page = std::fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    assert!(page.contains("There is no picture") && !page.contains("<image "));
    let (code, _, err) = mtled(&folder, &["view", "out"]);
    assert!(code == 2 && err.contains("whose case has frames"), "{err}");
}
