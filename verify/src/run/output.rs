//! Files of a run: VTU frames with a PVD, histories as CSV, `result.json`.
#![allow(non_snake_case)]

use super::prepare::Prepared;
use super::record::Recording;
use super::result::result_json;
use super::solve::Solved;
use super::vtu::{PointArray, VtuFrame, write_pvd, write_vtu};
use crate::scene::Case;
use anyhow::Result;
use mtled::algebra::tensor::Matrix3;
use mtled::motion::internal_force::projected_mean_stress;
use mtled::problem::{Motion, Problem};
use mtled_checks::report::write_atomically;
use std::path::Path;

/// Writes all files of a run to `dir` and returns the text of `result.json`.
pub fn write_outputs(
    case: &Case,
    solved: &Solved,
    record: &Recording,
    dir: &Path,
) -> Result<String> {
    write_recorded(case, &solved.prepared, record, dir)?;
    let text = serde_json::to_string_pretty(&result_json(case, solved, record))? + "\n";
    write_atomically(&dir.join("result.json"), text.as_bytes())?;
    Ok(text)
}

/// Writes the recording, which a failed run has too, and removes the `result.json` of
/// an earlier run.
pub fn write_recorded(
    case: &Case,
    prepared: &Prepared,
    record: &Recording,
    dir: &Path,
) -> Result<()> {
    if let Err(error) = std::fs::remove_file(dir.join("result.json"))
        && error.kind() != std::io::ErrorKind::NotFound
    {
        return Err(error.into());
    }
    write_frames(case, prepared, record, dir)?;
    write_atomically(&dir.join("history.csv"), history_csv(case, record)?.as_bytes())
}

fn write_frames(case: &Case, prepared: &Prepared, record: &Recording, dir: &Path) -> Result<()> {
    let dynamic = matches!(case.problem.motion, Motion::Dynamic { .. });
    let positions = &prepared.discretisation.cloud.positions;
    let points: Vec<[f64; 3]> = positions.iter().map(|X| (*X).into()).collect();
    let mut series = Vec::new();
    for (index, frame) in record.frames.iter().enumerate() {
        let name = format!("nodes_{index:04}.vtu");
        // A static run has no physical time: its frames are numbered by steps.
        let time = if dynamic { frame.time } else { frame.step as f64 };
        write_vtu(
            &dir.join(&name),
            &node_frame(&case.problem, prepared, &points, &frame.displacement, time)?,
        )?;
        series.push((time, name));
    }
    write_pvd(&dir.join(format!("{}.pvd", case.name)), &series)
}

/// Fields at the nodes: displacement of the approximation (not the nodal parameters),
/// and J, Cauchy stress and pressure averaged from the quadrature points around.
fn node_frame<'a>(
    problem: &Problem,
    prepared: &Prepared,
    points: &'a [[f64; 3]],
    u: &[f64],
    time: f64,
) -> Result<VtuFrame<'a>> {
    let d = prepared.model.components;
    let cloud = &prepared.discretisation.cloud;
    let rows = prepared.discretisation.rows_at(&cloud.positions)?;
    let displacement: Vec<f64> =
        (0..rows.len()).flat_map(|i| <[f64; 3]>::from(rows.interpolate(i, u, d))).collect();
    let (jacobian, stress) = averaged(problem, prepared, u);
    let pressure = stress.chunks(9).map(|s| -(s[0] + s[4] + s[8]) / 3.0).collect();
    Ok(VtuFrame {
        time,
        points,
        point_data: vec![
            PointArray::new("displacement", 3, displacement),
            PointArray::new("J", 1, jacobian),
            PointArray::new("cauchy_stress", 9, stress),
            PointArray::new("pressure", 1, pressure),
        ],
    })
}

/// J \[–\] and Cauchy stress by rows \[Pa\], projected pressure included, averaged over the
/// quadrature points that a node supports, weighted by volume times φ where positive.
fn averaged(problem: &Problem, prepared: &Prepared, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let discretisation = &prepared.discretisation;
    let (rows, quadrature) = (&discretisation.supports, &discretisation.quadrature);
    let nodes = discretisation.cloud.positions.len();
    let (mut total, mut jacobian, mut stress) =
        (vec![0.0; nodes], vec![0.0; nodes], vec![0.0; 9 * nodes]);
    let projected = projected_mean_stress(&prepared.model, u);
    for (point, mean_stress) in projected.into_iter().enumerate() {
        let F = rows.deformation_gradient(point, u, prepared.model.components);
        let law = &problem.regions[quadrature.regions[point] as usize].material.law;
        let sigma = law.cauchy(&F) + Matrix3::from_diagonal_element(mean_stress);
        for entry in rows.row(point) {
            let node = rows.nodes[entry] as usize;
            let weight = quadrature.weights[point] * rows.phi[entry].max(1e-6);
            total[node] += weight;
            jacobian[node] += weight * F.determinant();
            for (k, value) in sigma.transpose().iter().enumerate() {
                stress[9 * node + k] += weight * value;
            }
        }
    }
    for node in 0..nodes {
        jacobian[node] /= total[node];
        stress[9 * node..9 * node + 9].iter_mut().for_each(|value| *value /= total[node]);
    }
    (jacobian, stress)
}

/// One row per sample; probes with one position only (lattices are in
/// `result.json`).
fn history_csv(case: &Case, record: &Recording) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let axes = ["x", "y", "z"];
    let single: Vec<usize> =
        (0..case.probes.len()).filter(|&i| record.references[i].len() == 1).collect();
    let mut header: Vec<String> =
        ["step", "time_s", "smallest_jacobian", "touching_nodes"].map(String::from).into();
    header.extend(
        ["kinetic_j", "strain_j", "external_work_j", "constraint_work_j", "damping_loss_j"]
            .map(String::from),
    );
    for &probe in &single {
        header.extend(axes.map(|axis| format!("{}.u{axis}_m", case.probes[probe].name)));
    }
    for condition in &case.problem.conditions {
        header.extend(axes.map(|axis| format!("{}.f{axis}_n", condition.name)));
        header.extend(axes.map(|axis| format!("{}.m{axis}_n_m", condition.name)));
    }
    writer.write_record(&header)?;
    for sample in &record.samples {
        let e = &sample.energies;
        let mut row =
            vec![sample.step as f64, sample.time, sample.smallest_jacobian, sample.touching as f64];
        row.extend([e.kinetic, e.strain, e.external_work, e.constraint_work, e.damping_loss]);
        for &probe in &single {
            row.extend(sample.displacements[probe][0].iter());
        }
        for reaction in &sample.reactions {
            row.extend(reaction.force.iter().chain(reaction.moment.iter()));
        }
        writer.write_record(row.iter().map(f64::to_string))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
