//! Runs that are planned as files and performed by other processes.

use crate::common::program::printed;
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;

const STUDY: [&str; 7] =
    ["study", "convergence", "mine.toml", "--spacing", "x1.6,x1.4,x1.2", "--clouds", "2"];

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let (code, text) = printed(&folder, &["case", "show", "uniaxial_bar"]);
    assert_eq!(code, 0);
    // Another problem than the bundled one, so that its reference is to be run too.
    let text = text.replace("poisson_ratio = 0.3", "poisson_ratio = 0.4");
    std::fs::write(folder.path().join("mine.toml"), text).unwrap();
    folder
}

/// The records of a store without their times.
fn records(store: &Path) -> BTreeMap<String, serde_json::Value> {
    let mut found = BTreeMap::new();
    for part in std::fs::read_dir(store).unwrap().map(|entry| entry.unwrap().path()) {
        for file in std::fs::read_dir(part).into_iter().flatten().map(|entry| entry.unwrap().path())
        {
            let text = std::fs::read_to_string(&file).unwrap();
            let mut record: serde_json::Value = serde_json::from_str(&text).unwrap();
            // The checksum is also of the timings.
            for own in ["timings", "checksum"] {
                record.as_object_mut().unwrap().remove(own).unwrap();
            }
            found.insert(file.file_name().unwrap().to_string_lossy().into_owned(), record);
        }
    }
    found
}

#[test]
fn planned_parts_make_the_records_of_one_process_and_the_command_goes_on_from_them() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let plan = ["--plan-jobs", "jobs", "--parts", "3", "--store", "planned"];
    let (code, said) = printed(&folder, &[&STUDY[..], &plan].concat());
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("8 runs are planned in 3 parts"), "{said}");
    for file in ["jobs/Snakefile", "jobs/slurm/config.yaml", "jobs/array.sbatch"] {
        assert!(at(file).is_file(), "{file}");
    }
    assert!(!at("reports/convergence/index.html").exists());
    for part in ["jobs/part-0001.json", "jobs/part-0002.json", "jobs/part-0003.json"] {
        let (code, said) = printed(&folder, &["runs", "perform", part, "--store", "planned"]);
        assert!(code == 0 && said.contains("runs are stored"), "{said}");
    }
    let (code, said) = printed(&folder, &[&STUDY[..], &plan].concat());
    assert!([0, 3].contains(&code) && at("reports/convergence/index.html").exists(), "{said}");
    assert!(!at("jobs/part-0001.json").exists(), "parts that are done are removed");
    printed(&folder, &[&STUDY[..], &["--store", "single"]].concat());
    assert_eq!(records(&at("planned")), records(&at("single")));
}

#[test]
fn a_part_whose_case_has_changed_since_is_refused() {
    let folder = folder();
    printed(&folder, &[&STUDY[..], &["--plan-jobs", "jobs"]].concat());
    let file = folder.path().join("mine.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("poisson_ratio = 0.4", "poisson_ratio = 0.41")).unwrap();
    let (code, said) = printed(&folder, &["runs", "perform", "jobs/part-0001.json"]);
    assert!(code == 2 && said.contains("is not what was planned"), "{said}");
    std::fs::write(folder.path().join("jobs/part-0001.json"), "{}").unwrap();
    let (code, said) = printed(&folder, &["runs", "perform", "jobs/part-0001.json"]);
    assert!(code == 2 && said.contains("part-0001.json is not a part"), "{said}");
}
