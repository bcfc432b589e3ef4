//! Numbers with which a problem cannot be solved, each found where it stands.

use crate::problem::amplitude::Amplitude;
use crate::problem::motion::{Motion, Relaxation, StepControl};
use crate::problem::recipe::{BackgroundGrid, Basis, Cloud, Recipe, Refinement};
use std::cmp::Ordering::Greater;

/// A number of a problem that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} {wrong}")]
pub struct Mistake {
    /// Where it stands, by the names of fields, such as `recipe.dilation`.
    pub field: String,
    /// What it is, and what it must be.
    pub wrong: Wrong,
}

/// What is wrong with a number.
#[allow(missing_docs, reason = "the messages name every value")]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Wrong {
    #[error("is {0}; it must be positive")]
    NotPositive(f64),
    #[error("is {0}; it must not be negative")]
    Negative(f64),
    #[error("is 0; it must be at least 1")]
    Zero,
    #[error("is {0}; it must lie in (0, 1)")]
    NotInside(f64),
    #[error("is {0}; it must lie in (0, 1]")]
    NotUpToOne(f64),
    #[error("is {0}; it must lie in 0 < regularisation ≤ 1")]
    Regularisation(f64),
    #[error("is {0}; it must be 1 or more")]
    BelowOne(f64),
    #[error("is {0}; it must be larger than 1, or nodes do not reach their neighbours")]
    Dilation(f64),
    #[error("is {0}; it must lie in 0 ≤ jitter < 0.5")]
    Jitter(f64),
    #[error("is {0}; it must be 1 to 5")]
    GaussPoints(usize),
    #[error("is {0}; it must be finite")]
    NotFinite(f64),
    #[error("is missing; the law, or the active stress, needs the direction of its fibres")]
    NoFibres,
    #[error("has no sheets; the law needs their direction")]
    NoSheets,
    #[error("belongs to laws with fibres, and to an active stress; remove it")]
    UnusedFibres,
    #[error(
        "relaxes the isochoric stress, which the law does not have: use neo_hookean_isochoric, ogden, or a law with constants"
    )]
    NotSplit,
    #[error(
        "is by relaxation, which has no time for a material with viscosity: use Newton's method, or a motion"
    )]
    NoTime,
    #[error(
        "is by Newton's method, which has no friction that slides: use relaxation, or a motion"
    )]
    NoFriction,
    #[error("is 0, and so is tangential; give one of them a stiffness")]
    NoStiffness,
    #[error("is empty; it needs rows of time and factor")]
    Empty,
    #[error("has time {after} after {before}; times must increase")]
    TimesFall { before: f64, after: f64 },
}

/// The first of mistakes as an error.
pub(crate) fn refuse(mistakes: Vec<Mistake>) -> Result<(), Mistake> {
    mistakes.into_iter().next().map_or(Ok(()), Err)
}

/// Mistakes so far.
#[derive(Default)]
pub(super) struct Mistakes(pub(super) Vec<Mistake>);

impl Mistakes {
    pub(super) fn add(&mut self, field: &str, wrong: Option<Wrong>) {
        self.0.extend(wrong.map(|wrong| Mistake { field: field.to_string(), wrong }));
    }

    fn add_if(&mut self, is_wrong: bool, field: &str, wrong: Wrong) {
        if is_wrong {
            self.0.push(Mistake { field: field.to_string(), wrong });
        }
    }

    // Comparisons are made so that what is not a number is wrong.
    pub(super) fn positive(&mut self, field: &str, value: f64) {
        self.add_if(value.is_nan() || value <= 0.0, field, Wrong::NotPositive(value));
    }

    pub(super) fn finite(&mut self, field: &str, value: f64) {
        self.add_if(!value.is_finite(), field, Wrong::NotFinite(value));
    }

    pub(super) fn not_negative(&mut self, field: &str, value: f64) {
        self.add_if(value.is_nan() || value < 0.0, field, Wrong::Negative(value));
    }

    fn at_least_one(&mut self, field: &str, count: usize) {
        self.add_if(count == 0, field, Wrong::Zero);
    }

    fn tolerance(&mut self, field: &str, value: f64) {
        self.add_if(!(value > 0.0 && value < 1.0), field, Wrong::NotInside(value));
    }

    fn sizes(&mut self, field: &str, refinements: &[Refinement]) {
        for (n, refinement) in refinements.iter().enumerate() {
            self.positive(&format!("{field}[{n}].size"), refinement.size);
        }
    }

    /// The mistakes of a part of the problem.
    pub(super) fn part(&mut self, field: &str, mistakes: Vec<Mistake>) {
        self.0.extend(mistakes.into_iter().map(|mistake| {
            let field = format!("{field}.{}", mistake.field);
            Mistake { field, ..mistake }
        }));
    }
}

impl Recipe {
    /// Every number that cannot be used.
    pub fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        found.part("cloud", self.cloud.check());
        found.add_if(
            self.dilation.partial_cmp(&1.0) != Some(Greater),
            "dilation",
            Wrong::Dilation(self.dilation),
        );
        if let Basis::ModifiedQuadratic { regularisation } = self.basis {
            let wrong = Wrong::Regularisation(regularisation);
            found.add_if(
                !(regularisation > 0.0 && regularisation <= 1.0),
                "basis.regularisation",
                wrong,
            );
        }
        found.part("grid", self.grid.check());
        if let Some(tolerance) = self.gradients.tolerance() {
            found.positive("gradients.tolerance", tolerance);
        }
        found.0
    }
}

impl Cloud {
    /// Every number that cannot be used.
    pub fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        match self {
            Cloud::Regular { spacing } => found.positive("spacing", *spacing),
            Cloud::Jittered { spacing, jitter, .. } => {
                found.positive("spacing", *spacing);
                found.add_if(!(0.0..0.5).contains(jitter), "jitter", Wrong::Jitter(*jitter));
            }
            Cloud::Graded { spacing, refinements, growth, .. } => {
                found.positive("spacing", *spacing);
                found.positive("growth", *growth);
                found.sizes("refinements", refinements);
            }
            Cloud::Given { .. } => {}
        }
        found.0
    }
}

impl BackgroundGrid {
    /// Every number that cannot be used.
    pub fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        found.positive("cell", self.cell);
        if let Some(ratio) = self.cells_per_spacing {
            found.positive("cells_per_spacing", ratio);
        }
        if let Some(edge) = self.boundary_cell {
            found.positive("boundary_cell", edge);
        }
        found.sizes("refinements", &self.refinements);
        let points = self.gauss_points;
        found.add_if(!(1..=5).contains(&points), "gauss_points", Wrong::GaussPoints(points));
        found.0
    }
}

impl Amplitude {
    /// Every number that cannot be used.
    pub fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        match self {
            Amplitude::Constant => {}
            Amplitude::Linear { duration } => found.positive("linear.duration", *duration),
            Amplitude::Smooth { duration } => found.positive("smooth.duration", *duration),
            Amplitude::Table(rows) => {
                found.add_if(rows.is_empty(), "table", Wrong::Empty);
                for (n, pair) in rows.windows(2).enumerate() {
                    let ((before, _), (after, _)) = (pair[0], pair[1]);
                    let wrong = Wrong::TimesFall { before, after };
                    found.add_if(
                        after.partial_cmp(&before) != Some(Greater),
                        &format!("table[{}]", n + 1),
                        wrong,
                    );
                }
            }
        }
        found.0
    }
}

impl Motion {
    /// Every number that cannot be used.
    pub fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        match self {
            Motion::Dynamic { end, step, damping } => {
                found.positive("end", *end);
                found.not_negative("damping", *damping);
                found.part("step", step.check());
            }
            Motion::Static(relaxation) | Motion::Relaxed(relaxation) => {
                found.0.extend(relaxation.check());
            }
            Motion::Newton(newton) => {
                found.positive("load_end", newton.load_end);
                found.tolerance("tolerance", newton.tolerance);
                found.at_least_one("parts", newton.parts);
            }
        }
        found.0
    }
}

impl Relaxation {
    fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        found.positive("load_end", self.load_end);
        found.at_least_one("load_steps", self.load_steps);
        found.at_least_one("max_steps", self.max_steps);
        found.at_least_one("parts", self.parts);
        found.tolerance("tolerance", self.tolerance);
        found.part("step", self.step.check());
        found.0
    }
}

impl StepControl {
    fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        let scaling = self.mass_scaling;
        let is_scaling = scaling >= 1.0 && scaling.is_finite();
        found.add_if(!is_scaling, "mass_scaling", Wrong::BelowOne(scaling));
        let factor = self.safety_factor;
        found.add_if(!(factor > 0.0 && factor <= 1.0), "safety_factor", Wrong::NotUpToOne(factor));
        found.at_least_one("reevaluate_every", self.reevaluate_every);
        if let Some(fixed) = self.fixed {
            found.positive("fixed", fixed);
        }
        found.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::motion::Newton;

    fn fields(mistakes: &[Mistake]) -> Vec<&str> {
        mistakes.iter().map(|mistake| mistake.field.as_str()).collect()
    }

    #[test]
    fn what_is_recommended_has_no_mistakes() {
        assert_eq!(Recipe::with_spacing(0.1).check(), []);
        assert_eq!(Motion::Static(Relaxation::default()).check(), []);
        assert_eq!(Motion::Newton(Newton::default()).check(), []);
        assert_eq!(Motion::dynamic(1.0, 0.0).check(), []);
    }

    #[test]
    fn every_number_of_a_recipe_is_looked_at() {
        let mut recipe = Recipe::with_spacing(f64::NAN);
        recipe.dilation = 1.0;
        recipe.basis = Basis::ModifiedQuadratic { regularisation: 0.0 };
        recipe.grid.gauss_points = 6;
        recipe.grid.boundary_cell = Some(-1.0);
        recipe.gradients = recipe.gradients.with_tolerance(0.0);
        let expected = [
            "cloud.spacing",
            "dilation",
            "basis.regularisation",
            "grid.cell",
            "grid.boundary_cell",
            "grid.gauss_points",
            "gradients.tolerance",
        ];
        assert_eq!(fields(&recipe.check()), expected);
    }

    #[test]
    fn every_number_of_a_motion_is_looked_at() {
        let step = StepControl {
            safety_factor: 3.0,
            reevaluate_every: 0,
            fixed: Some(0.0),
            mass_scaling: f64::INFINITY,
        };
        let of_step =
            ["step.mass_scaling", "step.safety_factor", "step.reevaluate_every", "step.fixed"];
        let dynamic = Motion::Dynamic { end: 0.0, step, damping: -1.0 };
        assert_eq!(fields(&dynamic.check()), [&["end", "damping"][..], &of_step].concat());
        let relaxation = Relaxation {
            load_end: 0.0,
            load_steps: 0,
            tolerance: 2.0,
            max_steps: 0,
            step,
            ..Relaxation::default()
        };
        let of_relaxation = ["load_end", "load_steps", "max_steps", "tolerance"];
        let expected = [&of_relaxation[..], &of_step].concat();
        assert_eq!(fields(&Motion::Relaxed(relaxation).check()), expected);
        let newton = Motion::Newton(Newton { load_end: -1.0, tolerance: 1.0, ..Newton::default() });
        assert_eq!(fields(&newton.check()), ["load_end", "tolerance"]);
    }

    #[test]
    fn times_of_a_table_must_increase() {
        let table = Amplitude::Table(vec![(0.0, 0.0), (1.0, 1.0), (1.0, 2.0)]);
        let wrong = Wrong::TimesFall { before: 1.0, after: 1.0 };
        assert_eq!(table.check(), [Mistake { field: "table[2]".into(), wrong }]);
        assert_eq!(Amplitude::Table(Vec::new()).check()[0].wrong, Wrong::Empty);
        assert_eq!(fields(&Amplitude::Smooth { duration: 0.0 }.check()), ["smooth.duration"]);
    }
}
