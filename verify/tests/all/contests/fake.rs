//! Solvers made of a few lines of shell, and a case with a made-up reference.

use crate::common::program::mtled;
use crate::common::{BLOCK, block, json, synthetic};
use std::path::PathBuf;
use tempfile::TempDir;

/// What every script starts with: values close to the reference, closer on finer levels, and a
/// function that writes them.
const PRELUDE: &str = r#"job=$1; answer=$2
level=$(sed -n 's/.*"level": *\([0-9]*\).*/\1/p' "$job")
case $level in
    0) u='[0.011, 0.022, 0.033]'; n=100 ;;
    1) u='[0.0104, 0.0208, 0.0312]'; n=400 ;;
    *) u='[0.0101, 0.0202, 0.0303]'; n=1600 ;;
esac
who='"protocol": 1, "solver": {"name": "fake", "version": "1.2"}'
more=
reply() {
    printf '{%s, "unknowns": %s, "displacements_m": {"top": [[%s]], "middle": [[%s]]}%s}' \
        "$who" "$n" "$u" "$u" "$more" >"$answer"
}
"#;

/// A folder with the case, its reference and scripts.
pub struct Arena {
    pub dir: TempDir,
}

/// What a study said.
pub struct Said {
    pub code: i32,
    pub tables: String,
    pub page: String,
    pub err: String,
}

impl Arena {
    pub fn new() -> Arena {
        let dir = TempDir::new().unwrap();
        std::fs::write(dir.path().join("block.toml"), BLOCK).unwrap();
        let reference = json(&synthetic(&block())).to_string();
        std::fs::write(dir.path().join("reference.json"), reference).unwrap();
        Arena { dir }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// The option for a script.
    pub fn fake(&self, name: &str, body: &str) -> String {
        let file = self.path(&format!("{name}.sh"));
        std::fs::write(&file, format!("{PRELUDE}{body}\n")).unwrap();
        format!("{name}=sh '{}' {{job}} {{answer}}", file.display())
    }

    /// `mtled contest run` on the block with these solvers, without mtled.
    pub fn study(&self, solvers: &[String], more: &[&str]) -> Said {
        let mut arguments = vec!["contest", "run", "block.toml", "--without-mtled"];
        arguments.extend(["--reference", "reference.json", "--out", "out", "--quiet"]);
        arguments.extend(solvers.iter().flat_map(|solver| ["--solver", solver]));
        arguments.extend(more);
        let (code, _, err) = mtled(self.dir.path(), &arguments);
        let read =
            |name: &str| std::fs::read_to_string(self.path("out").join(name)).unwrap_or_default();
        Said {
            code,
            tables: read("tables.md"),
            page: read("index.html") + &read("solver-fake.html"),
            err,
        }
    }

    /// What is said about a solver of one script.
    pub fn about(&self, body: &str) -> Said {
        self.study(&[self.fake("fake", body)], &[])
    }

    /// `mtled contest check` on a file of results of the block: its code and messages.
    pub fn check(&self, file: &str) -> (u8, String) {
        let arguments = ["contest", "check", file, "--case", "block.toml"];
        let own = ["--reference", "reference.json"];
        let (code, out, err) = mtled(self.dir.path(), &[&arguments[..], &own].concat());
        (u8::try_from(code).unwrap(), out + &err)
    }
}
