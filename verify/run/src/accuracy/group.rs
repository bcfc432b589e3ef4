//! Groups of quantities that are compared together.

use mtled_case::reference::{Family, Quantity};
use mtled_case::scene::{Case, ProbeKind};

/// Quantities that are compared together.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    serde::Serialize,
    serde::Deserialize,
    clap::ValueEnum,
)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum Group {
    /// Of points and lattices.
    Displacement,
    /// Displacement of centres of mass.
    CentreOfMass,
    /// Reaction forces.
    Force,
    /// Reaction moments.
    Moment,
    /// Of the whole body.
    StrainEnergy,
    /// Of the whole body.
    KineticEnergy,
}

impl Group {
    /// Every group, in the order in which one is chosen where none is named.
    pub const ALL: [Group; 6] = [
        Group::Displacement,
        Group::CentreOfMass,
        Group::Force,
        Group::Moment,
        Group::StrainEnergy,
        Group::KineticEnergy,
    ];

    /// As it is written on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Group::Displacement => "displacement",
            Group::CentreOfMass => "centre_of_mass",
            Group::Force => "force",
            Group::Moment => "moment",
            Group::StrainEnergy => "strain_energy",
            Group::KineticEnergy => "kinetic_energy",
        }
    }

    /// What it is called in reports.
    pub fn label(self) -> &'static str {
        match self {
            Group::Displacement => "displacement of the probes",
            Group::CentreOfMass => "centres of mass",
            Group::Force => "reactions",
            Group::Moment => "reaction moments",
            Group::StrainEnergy => "strain energy",
            Group::KineticEnergy => "kinetic energy",
        }
    }

    /// The kind of its quantities.
    pub(crate) fn family(self) -> Family {
        match self {
            Group::Displacement | Group::CentreOfMass => Family::Displacement,
            Group::Force => Family::Force,
            Group::Moment => Family::Moment,
            Group::StrainEnergy => Family::StrainEnergy,
            Group::KineticEnergy => Family::KineticEnergy,
        }
    }

    /// Whether a quantity of a case belongs to it.
    pub fn holds(self, case: &Case, quantity: &Quantity) -> bool {
        let centre = || {
            case.probes.iter().any(|probe| {
                quantity.name.strip_prefix("displacement/") == Some(probe.name.as_str())
                    && matches!(probe.kind, ProbeKind::CentreOfMass { .. })
            })
        };
        quantity.family == self.family()
            && match self {
                Group::Displacement => !centre(),
                Group::CentreOfMass => centre(),
                _ => true,
            }
    }
}
