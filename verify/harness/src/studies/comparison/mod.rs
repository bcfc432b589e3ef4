//! The solver with the recipes of the cases against the finite-element references.

pub mod benchmarks;
mod compared;
pub mod convergence;
mod cost_figures;
mod costs;
mod cut;
mod cut_drawings;
pub mod fibres;
pub mod held_patches;
mod limits;
pub mod published;
mod tables;

use crate::studies::comparison::compared::{Compared, compare_all};
use crate::studies::comparison::cost_figures::{
    costs_table, error_over_cost, times_at_equal_error,
};
use crate::studies::comparison::costs::Costs;
use crate::studies::comparison::limits::{TARGET, limit};
use crate::studies::comparison::tables::{brain_table, differences_table};
use crate::studies::workbench::Workbench;
use anyhow::{Result, bail};
use mtled_checks::study::{Bound, Check, Figure, Kind, Study};
use mtled_run::accuracy::Group;

/// Compares all bundled cases with their references.
pub(crate) fn comparison(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut compared = Vec::new();
    let mut failures = Vec::new();
    for result in compare_all(bench) {
        match result {
            Ok(case) => compared.push(case),
            Err(error) => failures.push(format!("{error:#}")),
        }
    }
    study.tables.push(differences_table(&compared));
    if let Some(brain) = compared.iter().find(|c| c.case.name == "brain_slice") {
        study.tables.push(brain_table(brain));
    }
    add_figures(study, &compared);
    study.notes.push(
        "Each case is solved once, with the recipe of its file. Differences are relative to the \
         largest value of their group in the reference; a bound is the limit plus the reference's \
         own error bar. Where the limit is above 2 % the check is a regression: it shows change, \
         not accuracy."
            .into(),
    );
    study.notes.push(
        "Brain slice: the error bars do not include the outline. Voxel edges of about 0.1 mm on it \
         influence how the brain slides along the skull and rotates after the release; smoothing them \
         more or less moves the finite-element centres by 0.03 mm at 1 s and 0.05 mm at 2 s, of a \
         displacement of 2 to 6 mm. A centre that differs by more than 2 % in the table differs by \
         little more than that. The penalty of the contact moves centres by 0.012 mm, half the step \
         by 0.005 mm."
            .into(),
    );
    compared.iter().for_each(|case| add_checks(study, case));
    if !failures.is_empty() {
        bail!("{}", failures.join("; "));
    }
    Ok(())
}

/// Error over processor time of all cases, and cuts through those with a label map.
fn add_figures(study: &mut Study, compared: &[Compared]) {
    let costs: Vec<Costs> = compared.iter().filter_map(Costs::of).collect();
    study.figures.push(Figure::Plot(times_at_equal_error(&costs)));
    study.figures.push(Figure::Panels(error_over_cost(&costs)));
    study.tables.push(costs_table(&costs));
    let cuts = compared.iter().filter_map(|case| case.cut.clone());
    study.figures.extend(cuts.map(Figure::Panels));
    study.leading = study.figures.len();
}

/// A check of every group that is compared and that the case has.
fn add_checks(study: &mut Study, compared: &Compared) {
    for group in Group::ALL {
        let Some((limit, reason)) = limit(&compared.case.name, group) else { continue };
        let Some(difference) = compared.of(group) else { continue };
        let (kind, source) = if limit > TARGET {
            (Kind::Regression, reason)
        } else {
            (Kind::Reference, "2 % of the largest value")
        };
        let mut check = Check::new(
            &format!("comparison/{}/{}", compared.case.name, group.name()),
            &format!("{}: {}, rms relative difference", compared.case.title, group.label()),
            kind,
            difference.rms,
            Bound::AtMost(limit + difference.bar),
            "1",
            &format!("{source}: {limit}, and {:.1e} of the reference itself", difference.bar),
        );
        check.reference_error = Some(difference.bar);
        study.checks.push(check);
    }
}
