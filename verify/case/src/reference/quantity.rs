//! The quantities of a reference of a case.

use crate::scene::{Case, ProbeKind};
use mtled::problem::Motion;
use serde::{Deserialize, Serialize};

/// Kinds of quantities; those of one kind share their unit and their size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Displacements of the positions of a probe.
    Displacement,
    /// Reference centre of mass of a probe.
    Centre,
    /// Force that a support exerts on the body.
    Force,
    /// Moment that a support exerts on the body.
    Moment,
    /// Of the whole body.
    StrainEnergy,
    /// Of the whole body.
    KineticEnergy,
}

impl Family {
    /// SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Family::Displacement | Family::Centre => "m",
            Family::Force => "N",
            Family::Moment => "N m",
            Family::StrainEnergy | Family::KineticEnergy => "J",
        }
    }

    /// Numbers that belong together: the components of a vector, or one.
    pub fn components(self) -> usize {
        match self {
            Family::StrainEnergy | Family::KineticEnergy => 1,
            _ => 3,
        }
    }
}

/// One quantity of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Its key in a reference file, such as `force/top`.
    pub name: String,
    /// Its kind.
    pub family: Family,
    /// Numbers per instant.
    pub width: usize,
    /// Whether it has a list per instant.
    pub changes: bool,
}

/// All quantities of a case, in the order of its probes and conditions.
pub fn quantities(case: &Case) -> Vec<Quantity> {
    let quantity = |name: String, family: Family, positions: usize| Quantity {
        name,
        family,
        width: positions * family.components(),
        changes: family != Family::Centre,
    };
    let mut all = Vec::new();
    for probe in &case.probes {
        let positions = probe.kind.positions().len().max(1);
        all.push(quantity(format!("displacement/{}", probe.name), Family::Displacement, positions));
        if matches!(probe.kind, ProbeKind::CentreOfMass { .. }) {
            all.push(quantity(format!("centre/{}", probe.name), Family::Centre, 1));
        }
    }
    for condition in &case.problem.conditions {
        all.push(quantity(format!("force/{}", condition.name), Family::Force, 1));
        all.push(quantity(format!("moment/{}", condition.name), Family::Moment, 1));
    }
    all.push(quantity("strain_energy".into(), Family::StrainEnergy, 1));
    if is_dynamic(case) {
        all.push(quantity("kinetic_energy".into(), Family::KineticEnergy, 1));
    }
    all
}

/// Whether the case has a history in time.
pub fn is_dynamic(case: &Case) -> bool {
    matches!(case.problem.motion, Motion::Dynamic { .. })
}

/// Diagonal of the box around the body \[m\].
pub(crate) fn size_of(case: &Case) -> f64 {
    case.problem.body.bounding_box().map_or(0.0, |(low, high)| (high - low).norm())
}
