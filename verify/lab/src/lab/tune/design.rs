//! The recipes that are tried.

use crate::lab::label::{AS_IN_CASE, settings_label};
use crate::lab::sweep::{Axis, combinations};
use mtled::problem::Motion;
use mtled_case::scene::{Case, Knob, Level, Setting};

/// A recipe without its spacing.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Changes to the recipe of the case.
    pub settings: Vec<Setting>,
    /// Whether it belongs to the full factorial from which main effects are computed.
    pub factorial: bool,
}

impl Candidate {
    /// A recipe outside the factorial.
    pub(crate) fn single(settings: Vec<Setting>) -> Candidate {
        Candidate { settings, factorial: false }
    }

    /// Its settings, or "as in the case" where there are none.
    pub(crate) fn label(&self) -> String {
        if self.settings.is_empty() {
            AS_IN_CASE.into()
        } else {
            settings_label(self.settings.iter())
        }
    }

    /// The level of a knob, if it is a number.
    pub(crate) fn number(&self, knob: Knob) -> Option<f64> {
        match self.settings.iter().find(|setting| setting.knob == knob)?.level {
            Level::Number(number) => Some(number),
            Level::Word(_) => None,
        }
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

/// Bases with their dilation: quadratic ones need larger supports.
const BASES: &[(&str, f64)] =
    &[("quadratic", 2.6), ("modified_quadratic", 2.0), ("modified_quadratic", 2.4)];

/// Solvers of static cases with their tolerances, the most accurate first.
const SOLVERS: &[(&str, f64)] = &[
    ("newton", 1e-8),
    ("newton", 1e-3),
    ("newton", 1e-2),
    ("relaxation", 1e-4),
    ("relaxation", 1e-3),
    ("relaxation", 1e-2),
];

/// Safety factors of dynamic cases, the most accurate first.
const SAFETY_FACTORS: &[f64] = &[0.4, 0.8, 0.9, 0.95];

/// The recipe of the case; a full factorial of dilation and cells per spacing; quadratic
/// bases; and single changes of everything else. `axes`, if there are any, replace all but
/// the recipe of the case.
pub(crate) fn candidates(case: &Case, axes: &[Axis]) -> Vec<Candidate> {
    let (number, word) = (Setting::number, Setting::word);
    let mut all = vec![Candidate::single(Vec::new())];
    let factorial = |settings| Candidate { settings, factorial: true };
    if !axes.is_empty() {
        all.extend(combinations(axes).into_iter().map(factorial));
        return all;
    }
    for &dilation in DILATIONS {
        all.extend(CELLS.iter().map(|&cells| {
            factorial(vec![
                number(Knob::Dilation, dilation),
                number(Knob::CellsPerSpacing, cells),
                word(Knob::Basis, "linear"),
            ])
        }));
    }
    for &(basis, dilation) in BASES {
        all.extend([1.26, 2.0].map(|cells| {
            Candidate::single(vec![
                number(Knob::Dilation, dilation),
                number(Knob::CellsPerSpacing, cells),
                word(Knob::Basis, basis),
                word(Knob::Mass, "even_split"),
            ])
        }));
    }
    let single = SINGLE.iter().filter(|(knob, _)| matters(*knob, case));
    all.extend(single.map(|(knob, level)| Candidate::single(vec![word(*knob, level)])));
    all.push(Candidate::single(vec![
        number(Knob::GaussPoints, 2.0),
        number(Knob::CellsPerSpacing, 1.0),
    ]));
    all
}

/// Whether a knob can change the solution: static ones do not depend on the distribution of
/// the mass.
pub(crate) fn matters(knob: Knob, case: &Case) -> bool {
    knob != Knob::Mass || matches!(case.problem.motion, Motion::Dynamic { .. })
}

/// Solvers of one discretisation, the most accurate first and the case's own last: Newton's
/// method and relaxation to several tolerances in statics, several safety factors in
/// dynamics.
pub(crate) fn solvers(case: &Case) -> Vec<Candidate> {
    let mut all: Vec<Candidate> = match case.problem.motion {
        Motion::Dynamic { .. } => SAFETY_FACTORS
            .iter()
            .map(|&factor| Candidate::single(vec![Setting::number(Knob::SafetyFactor, factor)]))
            .collect(),
        Motion::Static(_) | Motion::Relaxed(_) | Motion::Newton(_) => SOLVERS
            .iter()
            .map(|&(solver, tolerance)| {
                Candidate::single(vec![
                    Setting::word(Knob::Solver, solver),
                    Setting::number(Knob::Tolerance, tolerance),
                ])
            })
            .collect(),
    };
    all.push(Candidate::single(Vec::new()));
    all
}
