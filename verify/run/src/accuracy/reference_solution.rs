//! The reference solution of a case.

use super::difference::{Difference, difference};
use super::finest::{FinestField, finest};
use super::group::Group;
use mtled_case::bundled::REFERENCES;
use mtled_case::reference::agreement::rms_of_points;
use mtled_case::reference::{
    Agreement, Quantity, ReferenceError, ReferenceValues, agreements, read_reference,
};
use mtled_case::scene::Case;
use mtled_checks::report::four_digits;

/// Values with error bars that a run is compared with.
#[derive(Debug, Clone)]
pub struct ReferenceSolution {
    /// Instants of the values \[s\].
    pub times: Vec<f64>,
    /// In the order of the quantities of the case.
    pub quantities: Vec<ReferenceValues>,
    /// Where they come from, for reports.
    pub source: String,
    /// Quantities in which its codes differ by more than their error bars, each with by how much.
    pub disagreements: Vec<(Quantity, String)>,
}

impl ReferenceSolution {
    /// From a stored reference of two finite-element codes; the error says why it cannot
    /// be used.
    pub fn from_file(
        case: &Case,
        text: &str,
        name: &str,
    ) -> Result<ReferenceSolution, ReferenceError> {
        let file = read_reference(case, text)?;
        let codes: Vec<&str> = file.solutions.iter().map(|s| s.code.as_str()).collect();
        let agreements = agreements(case, &file);
        let apart = agreements.iter().filter(|agreement| !agreement.agrees());
        let disagreement = |agreement: &Agreement| {
            let (name, times) = (&agreement.quantity.name, four_digits(agreement.ratio()));
            let codes = codes.join(" and ");
            let text = format!("{codes} differ in {name} by {times} times their error bars");
            (agreement.quantity.clone(), text)
        };
        Ok(ReferenceSolution {
            times: file.times_s.clone(),
            quantities: agreements.iter().map(|a| a.reference()).collect(),
            source: format!("finite elements ({}), {name}", codes.join(" and ")),
            disagreements: apart.map(disagreement).collect(),
        })
    }

    /// The bundled reference of this problem, whatever the name of the file. Its moments are about the
    /// origin: a case that asks for others has none.
    pub fn bundled(case: &Case) -> Option<ReferenceSolution> {
        if case.outputs.moment_about.norm() > 0.0 {
            return None;
        }
        let hash = format!("\"{}\"", case.problem_hash);
        let (name, text) = REFERENCES.iter().find(|(_, text)| text.contains(&hash))?;
        let mut reference =
            ReferenceSolution::from_file(case, text, &format!("bundled reference {name}")).ok()?;
        if let Ok(Some(finest)) = finest(case) {
            reference.refine(finest);
        }
        Some(reference)
    }

    /// Replaces a quantity by that of a finer mesh.
    fn refine(&mut self, finest: FinestField) {
        let known = self.quantities.iter_mut().find(|q| q.quantity.name == finest.quantity);
        let Some(known) = known.filter(|known| known.values.len() == finest.values.len()) else {
            return;
        };
        known.error = rms_of_points(&finest.errors, known.quantity.family.components());
        known.values = finest.values;
        known.errors = finest.errors;
        self.source += &format!("; {} on a finer mesh ({})", finest.quantity, finest.source);
    }

    /// How the codes of the reference disagree in quantities of a group.
    pub fn disagreements(&self, case: &Case, group: Group) -> Vec<&str> {
        let own = self.disagreements.iter().filter(|(quantity, _)| group.holds(case, quantity));
        own.map(|(_, text)| text.as_str()).collect()
    }

    /// Its own error in a group, over the largest value \[–\].
    pub fn bar(&self, case: &Case, group: Group) -> f64 {
        let own: Vec<Vec<f64>> = self.quantities.iter().map(|q| q.values.clone()).collect();
        self.difference(case, group, &own).map_or(0.0, |difference| difference.bar)
    }

    /// Whether it has something of a group.
    pub fn has(&self, case: &Case, group: Group) -> bool {
        let own: Vec<Vec<f64>> = self.quantities.iter().map(|q| q.values.clone()).collect();
        difference(case, group, &self.quantities, &own).is_some()
    }

    /// What is compared where the user names nothing: the first group with a reference.
    pub fn group(&self, case: &Case) -> Option<Group> {
        Group::ALL.into_iter().find(|group| self.has(case, *group))
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

    /// Root mean square difference of two runs over the largest value of the kind \[–\].
    pub fn difference_between(
        &self,
        case: &Case,
        group: Group,
        one: &[Vec<f64>],
        other: &[Vec<f64>],
    ) -> Option<f64> {
        let replaced = |(known, values): (&ReferenceValues, &Vec<f64>)| ReferenceValues {
            values: values.clone(),
            ..known.clone()
        };
        let other: Vec<ReferenceValues> = self.quantities.iter().zip(other).map(replaced).collect();
        difference(case, group, &other, one).map(|difference| difference.rms)
    }
}
