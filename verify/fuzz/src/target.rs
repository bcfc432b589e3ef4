//! What is fuzzed: a kind of file and who reads it.

/// A kind of input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Target {
    /// Case files: read, checked and discretised as by `mtled case check`.
    Case,
    /// Label maps (NRRD, NIfTI) as the body of a case.
    LabelMap,
    /// Surfaces (STL, OBJ, PLY, VTK) as the body of a case.
    Surface,
    /// Node files (CSV, NPY, VTU, VTK) of a case.
    Points,
    /// Case files: `mtled inspect`.
    Inspect,
    /// Case files: `mtled solve`.
    Solve,
    /// Records of runs: `mtled runs …`, `mtled merge`.
    Store,
    /// results.json: `mtled report`.
    Report,
    /// Baselines: `mtled report --baseline`.
    Baseline,
    /// Plans of studies: `mtled study … --plan`.
    Plan,
    /// Stored references: `mtled reference …`, `--reference`.
    Reference,
    /// Jobs of the solver protocol: `mtled protocol …`.
    Job,
    /// Answers of the solver protocol: `mtled protocol check`.
    Answer,
    /// Random scenes: relations that must hold of any of them.
    Scene,
    /// Inputs that misbehave on purpose, to test the harness.
    #[value(hide = true)]
    Trap,
}

/// One call of the program in the folder of the input.
#[derive(Debug)]
pub(crate) struct Step {
    /// Arguments.
    pub arguments: &'static [&'static str],
    /// The only folder or file, relative to the input's folder, that may change.
    pub writes: &'static str,
    /// Larger cases than this many pairs of points and nodes are left out \[pairs\].
    pub largest: Option<f64>,
}

const fn step(arguments: &'static [&'static str], writes: &'static str) -> Step {
    Step { arguments, writes, largest: None }
}

/// Key of the record that is mutated.
const RECORD: &str = "store/ab/ab5e1f000000000000000000000000aa.json";

const INSPECT: &[Step] = &[Step {
    arguments: &["inspect", "input.toml", "--format", "json"],
    writes: "out",
    largest: Some(2e5),
}];
const SOLVE: &[Step] = &[Step {
    arguments: &["solve", "input.toml", "--out", "out", "--format", "json"],
    writes: "out",
    largest: Some(3e4),
}];
const STORE: &[Step] = &[
    step(&["runs", "list", "--store", "store"], "out"),
    step(&["runs", "list", "--store", "store", "--format", "json"], "out"),
    step(&["merge", "store", "--into", "out"], "out"),
    step(&["runs", "prune", "--store", "store"], "store"),
];
const REPORT: &[Step] = &[
    step(&["report", "input.json", "--out", "out"], "out"),
    step(&["report", "input.json", "results.json", "--out", "out"], "out"),
    step(&["report", "results.json", "input.json", "--out", "out", "--format", "json"], "out"),
];
const BASELINE: &[Step] =
    &[step(&["report", "results.json", "--baseline", "input.json", "--out", "out"], "out")];
const PLAN: &[Step] = &[step(
    &["study", "consistency", "--plan", "input.toml", "--store", "out/runs", "--out", "out/report"],
    "out",
)];
const REFERENCE: &[Step] = &[
    step(&["reference", "check", "cook_membrane", "--data", "data"], "out"),
    step(&["reference", "show", "cook_membrane", "--data", "data", "--format", "json"], "out"),
];
const JOB: &[Step] = &[step(&["protocol", "check", "input.json", "answer.json"], "out")];
const ANSWER: &[Step] = &[step(&["protocol", "check", "job.json", "input.json"], "out")];

impl Target {
    /// CPU time of an input over that of one call: relations solve a scene some forty times.
    pub(crate) fn calls(self) -> f64 {
        if self == Target::Scene { 6.0 } else { 1.0 }
    }

    /// All but the traps.
    pub const ALL: [Target; 14] = [
        Target::Case,
        Target::LabelMap,
        Target::Surface,
        Target::Points,
        Target::Inspect,
        Target::Solve,
        Target::Store,
        Target::Report,
        Target::Baseline,
        Target::Plan,
        Target::Reference,
        Target::Job,
        Target::Answer,
        Target::Scene,
    ];

    /// Its name on the command line and in the corpus.
    pub fn name(self) -> &'static str {
        match self {
            Target::Case => "case",
            Target::LabelMap => "label_map",
            Target::Surface => "surface",
            Target::Points => "points",
            Target::Inspect => "inspect",
            Target::Solve => "solve",
            Target::Store => "store",
            Target::Report => "report",
            Target::Baseline => "baseline",
            Target::Plan => "plan",
            Target::Reference => "reference",
            Target::Job => "job",
            Target::Answer => "answer",
            Target::Scene => "scene",
            Target::Trap => "trap",
        }
    }

    /// The folder of its valid inputs.
    pub(crate) fn seeds(self) -> &'static str {
        match self {
            Target::Inspect | Target::Solve => "case",
            target => target.name(),
        }
    }

    /// The calls of the program; None where the library is called instead, which is much
    /// faster.
    pub(crate) fn steps(self) -> Option<&'static [Step]> {
        match self {
            Target::Case
            | Target::LabelMap
            | Target::Surface
            | Target::Points
            | Target::Scene
            | Target::Trap => None,
            Target::Inspect => Some(INSPECT),
            Target::Solve => Some(SOLVE),
            Target::Store => Some(STORE),
            Target::Report => Some(REPORT),
            Target::Baseline => Some(BASELINE),
            Target::Plan => Some(PLAN),
            Target::Reference => Some(REFERENCE),
            Target::Job => Some(JOB),
            Target::Answer => Some(ANSWER),
        }
    }

    /// Extensions of the names that its files may have.
    pub(crate) fn extensions(self) -> &'static [&'static str] {
        match self {
            Target::LabelMap => &["nrrd", "nhdr", "nii", "nii.gz"],
            Target::Surface => &["stl", "obj", "ply", "vtp", "vtk"],
            Target::Points => &["csv", "npy", "vtu", "vtk"],
            Target::Store
            | Target::Report
            | Target::Baseline
            | Target::Reference
            | Target::Job
            | Target::Answer => &["json"],
            Target::Trap => &["txt"],
            _ => &["toml"],
        }
    }

    /// Where the input lies in its folder.
    pub(crate) fn place(self, extension: &str) -> String {
        match self {
            Target::Store => RECORD.into(),
            Target::Reference => "data/cook_membrane.json".into(),
            _ => format!("input.{extension}"),
        }
    }

    /// The input as it is written: a record with the checksum of what it has become, without
    /// which every other one would be refused at its first line.
    pub(crate) fn sealed(self, bytes: Vec<u8>) -> Vec<u8> {
        match std::str::from_utf8(&bytes) {
            Ok(text) if self == Target::Store && text.starts_with('{') => {
                mtled_lab::lab::store::sealed(text).into_bytes()
            }
            _ => bytes,
        }
    }
}
