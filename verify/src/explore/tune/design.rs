//! The recipes that are tried.

use crate::explore::sweep::Axis;
use crate::scene::{Case, Knob, Level, Setting};
use mtled::problem::Motion;

/// A recipe without its spacing.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    pub settings: Vec<Setting>,
    /// Whether it belongs to the full factorial from which main effects are told.
    pub factorial: bool,
}

impl Candidate {
    /// The settings in words; "as in the case" where there are none.
    pub fn words(&self) -> String {
        if self.settings.is_empty() {
            return "as in the case".into();
        }
        let words: Vec<String> = self
            .settings
            .iter()
            .map(|s| format!("{} {}", s.knob.name().replace('_', " "), s.level))
            .collect();
        words.join(", ")
    }
}

const DILATIONS: &[f64] = &[1.5, 1.8, 2.1, 2.5];
const CELLS: &[f64] = &[1.0, 1.26, 1.6, 2.0];

/// One change each, from the recipe of the case.
const SINGLE: &[(Knob, &str)] = &[
    (Knob::WeightFunction, "cubic_spline"),
    (Knob::WeightFunction, "exponential"),
    (Knob::Mass, "even_split"),
    (Knob::Enforcement, "direct"),
];

/// Quadratic bases need wider supports.
const BASES: &[(&str, f64)] =
    &[("quadratic", 2.6), ("modified_quadratic", 2.0), ("modified_quadratic", 2.4)];

/// A full factorial of dilation and cells per spacing; quadratic bases; and single
/// changes of everything else. The recipe of the case as it is comes first. Axes that
/// are given replace the factorial.
pub fn candidates(case: &Case, axes: &[Axis]) -> Vec<Candidate> {
    let number = Setting::number;
    let mut all = vec![Candidate { settings: Vec::new(), factorial: false }];
    if !axes.is_empty() {
        let given = crate::explore::sweep::combinations(axes).into_iter();
        all.extend(given.map(|settings| Candidate { settings, factorial: true }));
        return all;
    }
    for &dilation in DILATIONS {
        for &cells in CELLS {
            let settings = vec![
                number(Knob::Dilation, dilation),
                number(Knob::CellsPerSpacing, cells),
                Setting::word(Knob::Basis, "linear"),
            ];
            all.push(Candidate { settings, factorial: true });
        }
    }
    for &(basis, dilation) in BASES {
        for cells in [1.26, 2.0] {
            let settings = vec![
                number(Knob::Dilation, dilation),
                number(Knob::CellsPerSpacing, cells),
                Setting::word(Knob::Basis, basis),
                Setting::word(Knob::Mass, "even_split"),
            ];
            all.push(Candidate { settings, factorial: false });
        }
    }
    let mut single = |settings| all.push(Candidate { settings, factorial: false });
    for (knob, level) in SINGLE {
        // Static solutions do not depend on how mass is spread.
        if *knob != Knob::Mass || matches!(case.problem.motion, Motion::Dynamic { .. }) {
            single(vec![Setting::word(*knob, level)]);
        }
    }
    single(vec![number(Knob::GaussPoints, 2.0), number(Knob::CellsPerSpacing, 1.0)]);
    all
}

/// Ways of finding the answer of one discretisation, the most exact first; the case's
/// own comes last. Static cases: Newton's method and relaxation to several
/// tolerances; dynamic ones: steps.
pub fn solvers(case: &Case) -> Vec<Candidate> {
    let candidate = |settings| Candidate { settings, factorial: false };
    let mut all = Vec::new();
    match case.problem.motion {
        Motion::Dynamic { .. } => {
            for factor in [0.4, 0.8, 0.9, 0.95] {
                all.push(candidate(vec![Setting::number(Knob::SafetyFactor, factor)]));
            }
        }
        Motion::Static(_) | Motion::Equilibrium(_) => {
            for (solver, tolerance) in [
                ("newton", 1e-8),
                ("newton", 1e-3),
                ("newton", 1e-2),
                ("relaxation", 1e-4),
                ("relaxation", 1e-3),
                ("relaxation", 1e-2),
            ] {
                all.push(candidate(vec![
                    Setting::word(Knob::Solver, solver),
                    Setting::number(Knob::Tolerance, tolerance),
                ]));
            }
        }
    }
    all.push(candidate(Vec::new()));
    all
}

/// A number of a setting, for figures.
pub fn level_of(candidate: &Candidate, knob: Knob) -> Option<f64> {
    let setting = candidate.settings.iter().find(|setting| setting.knob == knob)?;
    match &setting.level {
        Level::Number(number) => Some(*number),
        Level::Word(_) => None,
    }
}
