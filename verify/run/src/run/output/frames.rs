//! Frames of the fields, and the collections that list them: of the body, which a program for
//! pictures shows at once, and of the nodes.
#![allow(non_snake_case)]

use super::body::BodyFrames;
use super::node_fields::{NodeFields, field_at_nodes};
use super::vtu::{Order, PointArray, VtuFrame, write_pvd, write_vtu};
use crate::picture::Body;
use crate::run::contact::contact_gaps;
use crate::run::error_bar::Indicator;
use crate::run::record::{Frame, Recording};
use anyhow::Result;
use mtled::Simulation;
use mtled::motion::nodal_fields::LocalFields;
use mtled::problem::{Motion, Problem};
use mtled_case::scene::Case;
use mtled_checks::escape::file_name;
use std::path::{Path, PathBuf};

/// What the names of frames start with: of the display mesh, and of the nodes.
const BODY: &str = "body_";
const NODES: &str = "nodes_";

fn frame_name(kind: &str, number: usize) -> String {
    format!("{kind}{number:04}.vtu")
}

/// Whether a file is a frame of a run.
pub(crate) fn is_frame(name: &str) -> bool {
    let rest = name.strip_prefix(NODES).or(name.strip_prefix(BODY));
    let number = rest.and_then(|rest| rest.strip_suffix(".vtu"));
    number.is_some_and(|n| n.len() >= 4 && n.bytes().all(|digit| digit.is_ascii_digit()))
}

/// The last frame of the body in the folder of a run, or the one of a number.
pub fn last_body_frame(dir: &Path, number: Option<usize>) -> std::io::Result<Option<PathBuf>> {
    if let Some(number) = number {
        let path = dir.join(frame_name(BODY, number));
        return Ok(path.is_file().then_some(path));
    }
    let mut names: Vec<String> = Vec::new();
    for entry in std::fs::read_dir(dir)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name.starts_with(BODY) && is_frame(&name) {
            names.push(name);
        }
    }
    // Beyond 9999 names are longer.
    Ok(names.into_iter().max_by_key(|name| (name.len(), name.clone())).map(|name| dir.join(name)))
}

/// Whether a collection names frames of a run, under whatever name of the case.
pub(crate) fn lists_frames(collection: &Path) -> bool {
    let lists =
        |text: String| [NODES, BODY].iter().any(|kind| text.contains(&format!("file=\"{kind}")));
    std::fs::read_to_string(collection).is_ok_and(lists)
}

/// A static run has no physical time, unless a material has a memory: its frames are numbered.
fn order(problem: &Problem) -> Order {
    match problem.motion {
        Motion::Dynamic { .. } => Order::Time,
        _ if problem.has_memory() => Order::Time,
        Motion::Static(_) | Motion::Relaxed(_) | Motion::Newton(_) => Order::Number,
    }
}

/// Frames that were written, each with what orders it.
pub(crate) struct Frames {
    order: Order,
    at: Vec<f64>,
    /// The body at the end, to be drawn.
    pub last: Option<Body>,
    /// Whether the body has frames too: it has none where nothing of it is as large as a cell.
    of_body: bool,
}

impl Frames {
    /// Writes the collections: of the body under the name of the case, of the nodes beside it.
    pub(crate) fn write_collections(&self, case: &Case, dir: &Path) -> Result<()> {
        let collection = |kind: &str| -> Vec<(f64, String)> {
            let names = (0..self.at.len()).map(|number| frame_name(kind, number));
            self.at.iter().copied().zip(names).collect()
        };
        let path = |ending: &str| dir.join(file_name(&format!("{}{ending}.pvd", case.name)));
        if !self.of_body {
            return write_pvd(&path(""), self.order, &collection(NODES));
        }
        write_pvd(&path("_nodes"), self.order, &collection(NODES))?;
        write_pvd(&path(""), self.order, &collection(BODY))
    }
}

/// Writes the frames of a recording.
pub(crate) fn write_frames(
    case: &Case,
    simulation: &Simulation,
    record: &Recording,
    indicator: Option<&Indicator>,
    dir: &Path,
) -> Result<Frames> {
    let problem = &case.problem;
    let positions = &simulation.discretisation.cloud.positions;
    let points: Vec<[f64; 3]> = positions.iter().map(|X| (*X).into()).collect();
    let order = order(problem);
    let body = if record.frames.is_empty() { None } else { BodyFrames::new(simulation)? };
    let (mut at, mut last) = (Vec::new(), None);
    for (number, frame) in record.frames.iter().enumerate() {
        let is_last = number + 1 == record.frames.len();
        let indicator = indicator.filter(|_| is_last);
        let mode = record.unstable_mode.as_ref().filter(|_| is_last);
        let fields = NodeFields::new(simulation, frame, indicator)?;
        let numbers = numbers(problem, frame);
        let of_body =
            body.as_ref().map(|body| body.frame(simulation, frame, &fields, mode, numbers.clone()));
        let of_nodes = node_frame(simulation, &points, fields, mode, numbers)?;
        write_vtu(&dir.join(frame_name(NODES, number)), &of_nodes)?;
        if let Some(of_body) = of_body {
            write_vtu(&dir.join(frame_name(BODY, number)), &of_body)?;
            if let Some(body) = body.as_ref().filter(|_| is_last) {
                last = Some(body.drawn(of_body));
            }
        }
        at.push(match order {
            Order::Time => frame.time,
            Order::Number => number as f64,
        });
    }
    Ok(Frames { order, at, last, of_body: body.is_some() })
}

/// The body of the last frame of a recording; none without frames, or where nothing of the body
/// is as large as a cell.
pub(crate) fn body_at_end(
    case: &Case,
    simulation: &Simulation,
    record: &Recording,
    indicator: Option<&Indicator>,
) -> Result<Option<Body>> {
    let problem = &case.problem;
    let Some(frame) = record.frames.last() else { return Ok(None) };
    let Some(body) = BodyFrames::new(simulation)? else { return Ok(None) };
    let fields = NodeFields::new(simulation, frame, indicator)?;
    let mode = record.unstable_mode.as_ref();
    let numbers = numbers(problem, frame);
    Ok(Some(body.drawn(body.frame(simulation, frame, &fields, mode, numbers))))
}

/// Time of a frame \[s\], or how far a static run had come.
fn numbers(problem: &Problem, frame: &Frame) -> Vec<(&'static str, f64)> {
    match order(problem) {
        Order::Time => vec![("TimeValue", frame.time)],
        Order::Number => {
            vec![("step", frame.step as f64), ("load_fraction", frame.time / problem.motion.end())]
        }
    }
}

/// The fields at the nodes; the motion in which the body is unstable, if it is.
fn node_frame<'a>(
    simulation: &Simulation,
    points: &'a [[f64; 3]],
    fields: NodeFields,
    mode: Option<&Vec<f64>>,
    numbers: Vec<(&'static str, f64)>,
) -> Result<VtuFrame<'a>> {
    let local = fields.material.at_nodes();
    let gaps = fields.contact_pressure.as_ref().map(|_| {
        let positions = &simulation.discretisation.cloud.positions;
        contact_gaps((&simulation.model.contact, fields.time), positions, &fields.displacement)
    });
    let mut point_data = vec![
        PointArray::new("displacement", 3, fields.displacement),
        PointArray::new("J", 1, local.iter().map(|local| local.jacobian).collect()),
        PointArray::new("cauchy_stress", 9, local.iter().flat_map(|local| local.stress).collect()),
        PointArray::new("pressure", 1, local.iter().map(LocalFields::pressure).collect()),
    ];
    if let (Some(gaps), Some(pressures)) = (gaps, fields.contact_pressure) {
        point_data.push(PointArray::new("contact_gap", 1, gaps));
        point_data.push(PointArray::new("contact_pressure", 1, pressures));
    }
    if let Some(mode) = mode {
        point_data.push(PointArray::new("unstable_mode", 3, field_at_nodes(simulation, mode)?));
    }
    if let Some(bars) = fields.error_bar {
        point_data.push(PointArray::new("displacement_error_bar", 1, bars));
    }
    Ok(VtuFrame { numbers, points, cells: None, point_data })
}
