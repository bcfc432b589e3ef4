//! Files of a run: VTU frames with a PVD, histories as CSV, the displacement field, `result.json`.
#![allow(non_snake_case)]

use super::contact::contact_fields;
use super::error_bar::{Estimated, Indicator};
use super::prepare::Prepared;
use super::record::{Frame, Recording};
use super::result::{failed_json, result_json};
use super::solve::Solved;
use super::stored_field::{FIELD_FILE, StoredField};
use super::vtu::{Order, PointArray, VtuFrame, write_pvd, write_vtu};
use crate::scene::Case;
use anyhow::{Context, Result};
use mtled::algebra::tensor::Matrix3;
use mtled::error::Error;
use mtled::model::contact::{ContactResult, ContactSurface};
use mtled::motion::internal_force::projected_mean_stress;
use mtled::problem::{Motion, Problem};
use mtled_checks::escape::{csv_text, file_name, printable_json};
use mtled_checks::report::write_atomically;
use serde_json::Value;
use std::io::ErrorKind;
use std::path::Path;

/// Writes all files of a run to `dir` and returns the text of `result.json`.
pub fn write_outputs(
    case: &Case,
    solved: &Solved,
    record: &Recording,
    contacts: &[ContactResult],
    bars: Option<&Estimated>,
    dir: &Path,
) -> Result<String> {
    let indicator = bars.and_then(|bars| bars.as_ref().ok()?.indicator.as_ref());
    write_recorded(case, &solved.prepared, record, indicator, dir)?;
    let (u, stopped) = (&solved.state.displacement, solved.summary.stopped);
    StoredField::new(case, &solved.prepared, u, stopped).write(dir)?;
    write_result(&result_json(case, solved, record, contacts, bars), dir)
}

/// Writes what a run had recorded when it ended with an error.
pub fn write_failed(
    case: &Case,
    prepared: &Prepared,
    record: &Recording,
    error: &Error,
    dir: &Path,
) -> Result<String> {
    write_recorded(case, prepared, record, None, dir)?;
    write_result(&failed_json(case, prepared, record, error), dir)
}

fn write_result(result: &Value, dir: &Path) -> Result<String> {
    let text = printable_json(&serde_json::to_string_pretty(result)?) + "\n";
    write_atomically(&dir.join("result.json"), text.as_bytes())?;
    Ok(text)
}

/// Writes the recording, which a failed run has too. The files of an earlier run are taken
/// away first and the PVD is written last, so that it never names frames of two runs.
fn write_recorded(
    case: &Case,
    prepared: &Prepared,
    record: &Recording,
    indicator: Option<&Indicator>,
    dir: &Path,
) -> Result<()> {
    remove_earlier_run(dir)?;
    let collection = write_frames(case, prepared, record, indicator, dir)?;
    write_atomically(&dir.join("history.csv"), history_csv(case, record)?.as_bytes())?;
    let name = file_name(&format!("{}.pvd", case.name));
    write_pvd(&dir.join(name), order(&case.problem.motion), &collection)
}

/// Removes `result.json` and the collections of frames, then the frames and the histories.
fn remove_earlier_run(dir: &Path) -> Result<()> {
    let mut others = vec![dir.join("history.csv"), dir.join(FIELD_FILE)];
    let mut indices = vec![dir.join("result.json")];
    let unreadable = || format!("cannot read the folder {}", dir.display());
    if dir.exists() {
        for entry in std::fs::read_dir(dir).with_context(unreadable)? {
            let path = entry.with_context(unreadable)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if is_frame(&name) {
                others.push(path);
            } else if name.ends_with(".pvd") && lists_frames(&path) {
                indices.push(path);
            }
        }
    }
    for file in indices.iter().chain(&others) {
        match std::fs::remove_file(file) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                let what = format!("cannot remove {} of an earlier run", file.display());
                return Err(error).context(what);
            }
            _ => {}
        }
    }
    Ok(())
}

fn frame_name(number: usize) -> String {
    format!("nodes_{number:04}.vtu")
}

fn is_frame(name: &str) -> bool {
    let number = name.strip_prefix("nodes_").and_then(|rest| rest.strip_suffix(".vtu"));
    number.is_some_and(|n| n.len() >= 4 && n.bytes().all(|digit| digit.is_ascii_digit()))
}

/// Whether a collection names frames of a run, under whatever name of the case.
fn lists_frames(collection: &Path) -> bool {
    std::fs::read_to_string(collection).is_ok_and(|text| text.contains("file=\"nodes_"))
}

/// A static run has no physical time: its frames are numbered.
fn order(motion: &Motion) -> Order {
    match motion {
        Motion::Dynamic { .. } => Order::Time,
        Motion::Automatic(_) | Motion::Static(_) | Motion::Equilibrium(_) => Order::Number,
    }
}

/// What orders each frame, and its file.
fn write_frames(
    case: &Case,
    prepared: &Prepared,
    record: &Recording,
    indicator: Option<&Indicator>,
    dir: &Path,
) -> Result<Vec<(f64, String)>> {
    let positions = &prepared.discretisation.cloud.positions;
    let points: Vec<[f64; 3]> = positions.iter().map(|X| (*X).into()).collect();
    let mut collection = Vec::new();
    let touches = !case.problem.obstacles.is_empty();
    let surface = touches.then(|| ContactSurface::new(&case.problem, &prepared.discretisation));
    let surface = surface.transpose()?;
    for (number, frame) in record.frames.iter().enumerate() {
        let name = frame_name(number);
        let mut fields = node_frame(&case.problem, prepared, &points, frame)?;
        if let Some(surface) = &surface {
            let displacement = &fields.point_data[0].values;
            let contact = contact_fields(surface, prepared, frame, displacement)?;
            fields.point_data.extend(contact);
        }
        let is_last = number + 1 == record.frames.len();
        if let Some(mode) = record.unstable_mode.as_ref().filter(|_| is_last) {
            let mode = field_at_nodes(prepared, mode)?;
            fields.point_data.push(PointArray::new("unstable_mode", 3, mode));
        }
        if let Some(indicator) = indicator.filter(|_| is_last) {
            let bar = PointArray::new(
                "displacement_error_bar",
                1,
                indicator.sizes(&fields.point_data[0].values),
            );
            fields.point_data.push(bar);
        }
        write_vtu(&dir.join(&name), &fields)?;
        let at = match order(&case.problem.motion) {
            Order::Time => frame.time,
            Order::Number => number as f64,
        };
        collection.push((at, name));
    }
    Ok(collection)
}

/// Time of a frame \[s\], or how far a static run had come.
fn numbers(motion: &Motion, frame: &Frame) -> Vec<(&'static str, f64)> {
    match order(motion) {
        Order::Time => vec![("TimeValue", frame.time)],
        Order::Number => {
            vec![("step", frame.step as f64), ("load_fraction", frame.time / motion.end())]
        }
    }
}

/// Fields at the nodes: displacement of the approximation (not the nodal parameters),
/// and J, Cauchy stress and pressure averaged from the quadrature points around.
fn node_frame<'a>(
    problem: &Problem,
    prepared: &Prepared,
    points: &'a [[f64; 3]],
    frame: &Frame,
) -> Result<VtuFrame<'a>> {
    let u = &frame.displacement;
    let displacement = field_at_nodes(prepared, u)?;
    let (jacobian, stress) = averaged(problem, prepared, u);
    let pressure = stress.chunks(9).map(|s| -(s[0] + s[4] + s[8]) / 3.0).collect();
    Ok(VtuFrame {
        numbers: numbers(&problem.motion, frame),
        points,
        point_data: vec![
            PointArray::new("displacement", 3, displacement),
            PointArray::new("J", 1, jacobian),
            PointArray::new("cauchy_stress", 9, stress),
            PointArray::new("pressure", 1, pressure),
        ],
    })
}

/// Values at the nodes of the field with nodal parameters `u` \[node\]\[x, y, z\].
fn field_at_nodes(prepared: &Prepared, u: &[f64]) -> Result<Vec<f64>> {
    let rows = prepared.discretisation.rows_at(&prepared.discretisation.cloud.positions)?;
    let value = |i| <[f64; 3]>::from(rows.interpolate(i, u, prepared.model.components));
    Ok((0..rows.len()).flat_map(value).collect())
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
    for obstacle in &case.problem.obstacles {
        header.extend(axes.map(|axis| format!("{}.contact_f{axis}_n", obstacle.name)));
    }
    writer.write_record(header.iter().map(|name| csv_text(name)))?;
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
        row.extend(sample.contact_forces.iter().flatten());
        writer.write_record(row.iter().map(f64::to_string))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
