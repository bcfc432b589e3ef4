//! Histories as a table and as CSV.

use crate::run::record::{Recording, Sample};
use anyhow::Result;
use mtled::problem::Motion;
use mtled_case::scene::Case;
use mtled_checks::escape::csv_text;

/// Names of columns with units, and one row per sample; probes with one position only (lattices
/// are in `result.json`). A run that ended before its probes were made has no columns for them.
pub fn history(case: &Case, record: &Recording) -> (Vec<String>, Vec<Vec<f64>>) {
    let axes = ["x", "y", "z"];
    let single: Vec<usize> =
        (0..record.references.len()).filter(|&i| record.references[i].len() == 1).collect();
    let mut header: Vec<String> =
        ["step", "time_s", "smallest_jacobian", "touching_nodes"].map(String::from).into();
    header.extend(
        ["kinetic_j", "strain_j", "external_work_j", "constraint_work_j", "damping_loss_j"]
            .map(String::from),
    );
    let extra = case.problem.regions.iter().any(|r| r.viscosity.is_some() || r.active.is_some());
    if extra {
        header.push("extra_work_j".to_string());
    }
    let moving = matches!(case.problem.motion, Motion::Dynamic { .. });
    if moving {
        header.extend(axes.map(|axis| format!("momentum_{axis}_kg_m_per_s")));
        header.extend(axes.map(|axis| format!("angular_momentum_{axis}_kg_m2_per_s")));
    }
    let obstructed = !case.problem.obstacles.is_empty();
    if obstructed {
        header.extend(["contact_energy_j", "contact_loss_j"].map(String::from));
    }
    for &probe in &single {
        header.extend(axes.map(|axis| format!("{}.u{axis}_m", case.probes[probe].name)));
    }
    header.extend(of_loads(case));
    let row = |sample: &Sample| {
        let e = &sample.energies;
        let mut row =
            vec![sample.step as f64, sample.time, sample.smallest_jacobian, sample.touching as f64];
        row.extend([e.kinetic, e.strain, e.external_work, e.constraint_work, e.damping_loss]);
        if extra {
            row.push(e.extra_work);
        }
        if moving {
            row.extend(sample.momenta.linear.iter().chain(sample.momenta.angular.iter()));
        }
        if obstructed {
            row.extend([e.contact_energy, e.contact_loss]);
        }
        for &probe in &single {
            row.extend(sample.displacements[probe][0].iter());
        }
        for reaction in &sample.reactions {
            row.extend(reaction.force.iter().chain(reaction.moment.iter()));
        }
        row.extend(sample.contact_forces.iter().chain(&sample.spring_forces).flatten());
        row.extend(sample.cavities.iter().flat_map(|cavity| [cavity.volume, cavity.pressure]));
        row.extend(&sample.region_volumes);
        row
    };
    (header, record.samples.iter().map(row).collect())
}

/// Names of the columns of conditions, obstacles, springs, cavities and regions.
fn of_loads(case: &Case) -> Vec<String> {
    let axes = ["x", "y", "z"];
    let mut header = Vec::new();
    for condition in &case.problem.conditions {
        header.extend(axes.map(|axis| format!("{}.f{axis}_n", condition.name)));
        header.extend(axes.map(|axis| format!("{}.m{axis}_n_m", condition.name)));
    }
    for obstacle in &case.problem.obstacles {
        header.extend(axes.map(|axis| format!("{}.contact_f{axis}_n", obstacle.name)));
    }
    let loads = &case.problem.loads;
    for spring in &loads.springs {
        header.extend(axes.map(|axis| format!("{}.f{axis}_n", spring.name)));
    }
    for cavity in &loads.cavities {
        header.extend(["volume_m3", "pressure_pa"].map(|what| format!("{}.{what}", cavity.name)));
    }
    if case.outputs.volumes {
        header
            .extend(case.problem.regions.iter().map(|region| format!("{}.volume_m3", region.name)));
    }
    header
}

/// [`history`] as CSV.
pub(crate) fn history_csv(case: &Case, record: &Recording) -> Result<String> {
    let (header, rows) = history(case, record);
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header.iter().map(|name| csv_text(name)))?;
    for row in rows {
        writer.write_record(row.iter().map(f64::to_string))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
