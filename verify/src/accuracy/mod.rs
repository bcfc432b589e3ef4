//! How wrong a run is: its numbers against a truth that carries its own error bar.

mod finest;
mod own;
mod values;

pub use finest::{Finest, finest};
pub use own::extrapolated;
pub use values::{SAMPLES, values};

use crate::bundled::REFERENCES;
use crate::reference::agreement::rms_of_points;
use crate::reference::{Agreed, Family, Quantity, ReferenceError, agree, read_reference};
use crate::scene::{Case, ProbeKind};

/// What is smaller than this share of its kind counts as zero \[–\].
const ZERO: f64 = 1e-6;

/// Values that are taken for true.
#[derive(Debug, Clone)]
pub struct Truth {
    /// Instants of the values \[s\].
    pub times: Vec<f64>,
    /// In the order of the quantities of the case.
    pub quantities: Vec<Agreed>,
    /// Where they come from, in words.
    pub source: String,
}

/// Quantities that are judged together.
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
    CentreOfMass,
    /// Of the supports.
    Force,
    Moment,
    StrainEnergy,
    KineticEnergy,
}

/// Every group, in the order in which one is picked where none is named.
pub const GROUPS: [Group; 6] = [
    Group::Displacement,
    Group::CentreOfMass,
    Group::Force,
    Group::Moment,
    Group::StrainEnergy,
    Group::KineticEnergy,
];

/// A difference from the truth, relative to the largest number of its kind in the
/// case \[–\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Over points and instants.
    pub rms: f64,
    pub max: f64,
    /// The truth's own error, rms.
    pub bar: f64,
}

impl Group {
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

    pub fn words(self) -> &'static str {
        match self {
            Group::Displacement => "displacement of the probes",
            Group::CentreOfMass => "centres of mass",
            Group::Force => "reactions",
            Group::Moment => "reaction moments",
            Group::StrainEnergy => "strain energy",
            Group::KineticEnergy => "kinetic energy",
        }
    }

    fn family(self) -> Family {
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

/// The difference over all quantities of a group; none where there are none or all
/// vanish, as moments do by symmetry.
pub fn difference(
    case: &Case,
    group: Group,
    truth: &[Agreed],
    computed: &[Vec<f64>],
) -> Option<Difference> {
    let components = group.family().components();
    let (mut apart, mut errors) = (Vec::new(), Vec::new());
    let (mut largest, mut max, mut zero) = (0.0f64, 0.0f64, 0.0f64);
    for (reference, computed) in truth.iter().zip(computed) {
        if !group.holds(case, &reference.quantity) {
            continue;
        }
        let length = |vector: &[f64]| vector.iter().map(|v| v * v).sum::<f64>().sqrt();
        let differences: Vec<f64> =
            computed.iter().zip(&reference.values).map(|(a, b)| a - b).collect();
        zero = zero.max(ZERO * reference.scale);
        largest = reference.values.chunks(components).map(length).fold(largest, f64::max);
        max = differences.chunks(components).map(length).fold(max, f64::max);
        errors.extend(std::iter::repeat_n(reference.error, differences.len() / components));
        apart.extend(differences);
    }
    (largest > zero).then(|| Difference {
        rms: rms_of_points(&apart, components) / largest,
        max: max / largest,
        bar: rms_of_points(&errors, 1) / largest,
    })
}

impl Truth {
    /// From a stored reference of two finite-element codes; the error says why a
    /// file is of no use.
    pub fn of_reference(case: &Case, text: &str, name: &str) -> Result<Truth, ReferenceError> {
        let file = read_reference(case, text)?;
        let codes: Vec<&str> = file.solutions.iter().map(|s| s.code.as_str()).collect();
        Ok(Truth {
            times: file.times_s.clone(),
            quantities: agree(case, &file).iter().map(|a| a.reference()).collect(),
            source: format!("finite elements ({}), {name}", codes.join(" and ")),
        })
    }

    /// The reference that the program carries for this problem, whatever the name
    /// of the file.
    pub fn carried(case: &Case) -> Option<Truth> {
        let hash = format!("\"{}\"", case.problem_hash);
        let (name, text) = REFERENCES.iter().find(|(_, text)| text.contains(&hash))?;
        let mut truth =
            Truth::of_reference(case, text, &format!("carried reference {name}")).ok()?;
        if let Ok(Some(finest)) = finest(case) {
            truth.sharpen(finest);
        }
        Some(truth)
    }

    /// Takes a quantity from a finer field.
    fn sharpen(&mut self, finest: Finest) {
        let known = self.quantities.iter_mut().find(|q| q.quantity.name == finest.quantity);
        let Some(known) = known.filter(|known| known.values.len() == finest.values.len()) else {
            return;
        };
        known.error = rms_of_points(&finest.errors, known.quantity.family.components());
        known.values = finest.values;
        known.errors = finest.errors;
        self.source += &format!("; {} on a finer mesh ({})", finest.quantity, finest.source);
    }

    /// What is judged where the user names nothing: the first group that the case
    /// has a truth for.
    pub fn group(&self, case: &Case) -> Option<Group> {
        let own: Vec<Vec<f64>> = self.quantities.iter().map(|q| q.values.clone()).collect();
        GROUPS.into_iter().find(|group| difference(case, *group, &self.quantities, &own).is_some())
    }

    /// The difference of computed values.
    pub fn difference(
        &self,
        case: &Case,
        group: Group,
        computed: &[Vec<f64>],
    ) -> Option<Difference> {
        difference(case, group, &self.quantities, computed)
    }

    /// How far two computed answers are apart: rms over the largest value of the
    /// kind \[–\].
    pub fn apart(
        &self,
        case: &Case,
        group: Group,
        one: &[Vec<f64>],
        other: &[Vec<f64>],
    ) -> Option<f64> {
        let moved = |(known, values): (&Agreed, &Vec<f64>)| Agreed {
            values: values.clone(),
            ..known.clone()
        };
        let other: Vec<Agreed> = self.quantities.iter().zip(other).map(moved).collect();
        difference(case, group, &other, one).map(|difference| difference.rms)
    }
}
