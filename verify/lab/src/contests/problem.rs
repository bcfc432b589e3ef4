//! A problem of a contest: a case with the solution that answers are compared with.

use super::identity::Identity;
use crate::lab::store::Source;
use anyhow::{Context, Result, bail};
use mtled_case::protocol::Answered;
use mtled_case::reference::quantities;
use mtled_run::accuracy::{Difference, Group, ReferenceSolution};
use std::str::FromStr;
use std::sync::Arc;

/// A case with its reference solution.
#[derive(Debug)]
pub struct ContestCase {
    /// Which of the benchmark it is, such as `cube_shear-v1`; the name of a case of the user.
    pub id: String,
    /// The case file.
    pub source: Arc<Source>,
    /// What answers are compared with.
    pub reference: ReferenceSolution,
    /// What is compared first.
    pub group: Group,
}

/// A distance of neighbouring nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spacing {
    /// Times that of the case \[–\].
    Factor(f64),
    /// \[m\]
    Metres(f64),
}

/// Why a text is no distance of nodes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a length in metres or a factor such as x1.4")]
pub struct NotASpacing(String);

impl FromStr for Spacing {
    type Err = NotASpacing;

    fn from_str(text: &str) -> Result<Spacing, NotASpacing> {
        let number = text.strip_prefix('x').unwrap_or(text);
        let value = number.parse::<f64>().ok().filter(|value| *value > 0.0 && value.is_finite());
        match (value, text.starts_with('x')) {
            (Some(value), true) => Ok(Spacing::Factor(value)),
            (Some(value), false) => Ok(Spacing::Metres(value)),
            (None, _) => Err(NotASpacing(text.to_string())),
        }
    }
}

impl Spacing {
    /// In metres, where that of the case is known if it is needed.
    pub fn metres(self, own: Option<f64>) -> Option<f64> {
        match self {
            Spacing::Metres(metres) => Some(metres),
            Spacing::Factor(factor) => Some(factor * own?),
        }
    }
}

impl ContestCase {
    /// A case with the reference solution that belongs to its problem: one of `files` (name,
    /// text), or the bundled one.
    pub fn new(source: Arc<Source>, files: &[(String, String)]) -> Result<ContestCase> {
        let case = &source.case;
        let own = files.iter().find(|(_, text)| text.contains(&case.problem_hash));
        let reference = match own {
            Some((name, text)) => Some(ReferenceSolution::from_file(case, text, name)?),
            None => ReferenceSolution::bundled(case),
        };
        let Some(reference) = reference else {
            bail!(
                "{}: there is no reference of this problem; name its file with --reference FILE",
                source.file.display()
            );
        };
        let group = reference.group(case);
        let group = group.with_context(|| format!("{} has nothing to compare", case.name))?;
        // A file of the user's own may differ from the bundled reference.
        let identity = Identity::of_inputs(&case.problem_hash).filter(|_| own.is_none());
        let id = identity.map_or(&source.name, |identity| &identity.id).clone();
        Ok(ContestCase { id, source, reference, group })
    }

    /// Distances of nodes \[m\], which must go from coarse to fine.
    pub fn ladder(&self, spacings: &[Spacing]) -> Result<Vec<f64>> {
        let own = self.source.case.problem.recipe.spacing();
        let metres = spacings.iter().map(|spacing| spacing.metres(own));
        let Some(metres) = metres.collect::<Option<Vec<f64>>>() else {
            bail!("{} has no spacing; give spacings in metres", self.source.file.display());
        };
        if metres.windows(2).all(|pair| pair[0] > pair[1]) {
            Ok(metres)
        } else {
            bail!("spacings must go from coarse to fine")
        }
    }

    /// The error of an answer in a group; None where the answer or the reference lacks it.
    pub fn error(&self, group: Group, answered: &Answered) -> Option<Difference> {
        let case = &self.source.case;
        let all = quantities(case).into_iter().zip(&answered.values);
        let complete = all.filter(|(quantity, _)| group.holds(case, quantity));
        if complete.map(|(_, values)| values.is_some()).any(|given| !given) {
            return None;
        }
        let values: Vec<Vec<f64>> =
            answered.values.iter().map(|values| values.clone().unwrap_or_default()).collect();
        self.reference.difference(case, group, &values)
    }

    /// The error bar of the reference in the group that is compared first \[–\].
    pub(crate) fn bar(&self) -> f64 {
        self.reference.bar(&self.source.case, self.group)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spacing_is_a_length_or_a_factor() {
        assert_eq!("x1.4".parse(), Ok(Spacing::Factor(1.4)));
        assert_eq!("0.02".parse(), Ok(Spacing::Metres(0.02)));
        for text in ["", "x", "-1", "xnan", "0", "inf"] {
            assert!(text.parse::<Spacing>().is_err(), "{text}");
        }
    }
}
