//! What an error costs: this run and the stored finite-element runs of a case.

use crate::studies::comparison::compared::Compared;
use mtled_run::accuracy::{Cost, Group, cost_at};

/// Error \[–\] and CPU time \[s\] of one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CostPoint {
    pub error: f64,
    pub cpu: f64,
}

/// The meshes of one finite-element code, from coarse to fine.
#[derive(Debug)]
pub(crate) struct CodeCosts {
    pub code: String,
    /// When they ran, YYYY-MM-DD.
    pub date: String,
    pub meshes: Vec<CostPoint>,
}

/// All runs of a case.
#[derive(Debug)]
pub(crate) struct Costs {
    pub case: String,
    pub own: CostPoint,
    /// Error bar of the reference \[–\]; which of two errors below it is the smaller one is not
    /// known.
    pub floor: f64,
    pub codes: Vec<CodeCosts>,
}

/// CPU time of a code over that of this solver at equal error \[–\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Ratio {
    /// Between two meshes.
    Equal(f64),
    /// The coarsest mesh is as accurate.
    AtMost(f64),
    /// No mesh is as accurate.
    AtLeast(f64),
}

impl Ratio {
    pub(crate) fn value(self) -> f64 {
        match self {
            Ratio::Equal(value) | Ratio::AtMost(value) | Ratio::AtLeast(value) => value,
        }
    }
}

impl Costs {
    /// The costs of a case whose displacements are compared.
    pub(crate) fn of(compared: &Compared) -> Option<Costs> {
        let groups = [Group::Displacement, Group::CentreOfMass];
        let (group, own) =
            groups.into_iter().find_map(|group| Some((group, compared.of(group)?)))?;
        let codes = compared.file.solutions.iter().map(|solution| {
            let point = |mesh| {
                let error = compared.of_mesh(group, mesh)?.rms;
                Some(CostPoint { error, cpu: mesh.cpu_s })
            };
            CodeCosts {
                code: solution.code.clone(),
                date: solution.date.clone(),
                meshes: solution.meshes.iter().filter_map(point).collect(),
            }
        });
        Some(Costs {
            case: compared.case.name.clone(),
            own: CostPoint { error: own.rms, cpu: compared.cpu },
            floor: own.bar,
            codes: codes.collect(),
        })
    }

    /// The error at which times are compared: that of this solver, or the reference's error bar
    /// where it is larger \[–\].
    pub(crate) fn level(&self) -> f64 {
        self.own.error.max(self.floor)
    }

    /// CPU time of a code over that of this solver at [`Self::level`]; None for a code without
    /// meshes.
    pub(crate) fn ratio(&self, code: &CodeCosts) -> Option<Ratio> {
        let finest = code.meshes.last()?;
        let runs: Vec<(f64, f64)> = code.meshes.iter().map(|mesh| (mesh.error, mesh.cpu)).collect();
        Some(match cost_at(&runs, self.level()) {
            None => Ratio::AtLeast(finest.cpu / self.own.cpu),
            Some(Cost { value, at_most: true }) => Ratio::AtMost(value / self.own.cpu),
            Some(Cost { value, .. }) => Ratio::Equal(value / self.own.cpu),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Meshes with the errors 1e-2, 1e-3 and 1e-4 that take 1, 10 and 100 s.
    fn costs(error: f64, floor: f64) -> Costs {
        let meshes = [(1e-2, 1.0), (1e-3, 10.0), (1e-4, 100.0)];
        let meshes = meshes.map(|(error, cpu)| CostPoint { error, cpu }).to_vec();
        let code = CodeCosts { code: "fenicsx".into(), date: "2026-11-21".into(), meshes };
        let own = CostPoint { error, cpu: 2.0 };
        Costs { case: "cube".into(), own, floor, codes: vec![code] }
    }

    fn ratio(error: f64, floor: f64) -> Ratio {
        let costs = costs(error, floor);
        costs.ratio(&costs.codes[0]).unwrap()
    }

    #[test]
    fn times_are_compared_at_the_error_of_this_solver() {
        assert_eq!(ratio(0.1, 1e-6), Ratio::AtMost(0.5));
        assert!(matches!(ratio(1e-3, 1e-6), Ratio::Equal(value) if (value - 5.0).abs() < 1e-9));
        assert_eq!(ratio(1e-5, 1e-6), Ratio::AtLeast(50.0));
    }

    #[test]
    fn nothing_below_the_error_bar_of_the_reference_is_an_advantage() {
        // The time of the finite elements is that at the error bar, between two meshes.
        assert_eq!(ratio(1e-9, 5e-4), ratio(5e-4, 1e-9));
        assert!(matches!(ratio(1e-9, 5e-4), Ratio::Equal(value) if value < 50.0));
        assert_eq!(ratio(1e-9, 0.1), Ratio::AtMost(0.5));
    }
}
