//! An inspection as text and as JSON.

use super::inspection::{Inspection, LARGEST_SEARCH, Place};
use mtled::algebra::tensor::{Vector3, bounding_box};
use mtled::discretisation::Footprint;
use mtled::model::zero_energy::{CapturedMotion, ZERO_ENERGY_FRACTION, ZeroEnergyModes};
use mtled::motion::newton::InfSup;
use mtled::problem::Dimension;
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use mtled_run::run::warnings;
use serde_json::{Value, json};

/// A support is called poor above this fraction of the largest accepted condition number \[–\].
const POOR: f64 = 0.1;
/// Nodes with less than this fraction of the largest spacing that limit the time step are
/// reported \[–\].
const FINE: f64 = 0.5;
/// Inf-sup value \[–\] below which a pressure is answered by next to nothing that is free.
const UNANSWERED: f64 = 1e-3;
/// Inf-sup value \[–\] below which a smaller spacing is advised: bodies of two and more spacings
/// have 0.27 to 0.53, plates of one spacing that are held on one side 0.16, on both sides 0.
const STIFF: f64 = 0.1;

/// The inspection on one screen.
pub(crate) fn to_text(inspection: &Inspection) -> String {
    let mut lines = discretisation_text(inspection);
    lines.extend(step_text(inspection));
    lines.extend(memory_text(inspection));
    lines.extend(modes_text(inspection.modes.as_ref()));
    lines.extend(inspection.inf_sup.as_ref().map(inf_sup_text));
    lines.push("advice".into());
    lines.extend(advice(inspection).into_iter().map(|line| format!("  {line}")));
    lines.join("\n") + "\n"
}

fn discretisation_text(inspection: &Inspection) -> Vec<String> {
    let Inspection { case, simulation, .. } = inspection;
    let (discretisation, model) = (&simulation.discretisation, &simulation.model);
    let (nodes, points) = (model.positions.len(), discretisation.supports.len());
    let (few, many) = inspection.support;
    let (lower, upper) = bounding_box(&model.positions);
    let mut lines = vec![
        std::iter::once(format!("{}: {}", case.name, case.title))
            .chain(case.overrides().iter().map(|set| format!("  with {set}")))
            .map(|line| printable(&line))
            .collect::<Vec<_>>()
            .join("\n"),
        format!(
            "nodes               {nodes}, {} of them on the boundary; all are covered",
            discretisation.cloud.on_boundary.iter().filter(|b| **b).count()
        ),
        format!("                    from ({}) to ({})", show(&lower), show(&upper)),
        format!(
            "quadrature points   {points}: {} per node",
            four_digits(points as f64 / nodes as f64)
        ),
        format!(
            "nodes per support   {} in the mean, {few} to {many}; {} supports enlarged",
            four_digits(discretisation.mean_support()),
            discretisation.enlarged
        ),
        range("nodal spacing", "m", &inspection.spacings),
        range("lumped mass", "kg", &inspection.masses),
        format!(
            "worst conditions    of at most {} that are accepted",
            four_digits(inspection.largest_condition)
        ),
    ];
    lines.extend(inspection.conditions.iter().map(|place| {
        let Place { value, index, position } = place;
        format!("                    {} at point {index} ({})", four_digits(*value), show(position))
    }));
    if let Some(correction) = discretisation.correction {
        lines.push(format!(
            "gradients           consistent to {:.1e}, tolerance {:.1e}, {} iterations; error of plain \
             ones {:.1e}",
            correction.residual, correction.tolerance, correction.iterations, correction.defect
        ));
        if let Some(iterations) = correction.linear_stress_iterations {
            lines.push(format!(
                "                    of second order: linear stresses nearly, {iterations} iterations"
            ));
        }
    }
    lines
}

/// The critical time step and the memory that a step reads.
fn step_text(inspection: &Inspection) -> [String; 2] {
    let model = &inspection.simulation.model;
    let bytes = model.bytes_per_step() as f64;
    let entries = inspection.simulation.discretisation.supports.nodes.len();
    let single = inspection.case.problem.recipe.gradient_storage.is_single(entries);
    [
        format!(
            "critical step       {} s at rest, {} times the per-point bound of {} s; limited near node \
         {} ({})",
            four_digits(inspection.critical.time_step),
            four_digits(inspection.critical.time_step / model.per_point_bound),
            four_digits(model.per_point_bound),
            inspection.weakest.index,
            show(&inspection.weakest.position)
        ),
        format!(
            "memory              {} MB are read in each step, {:.0} bytes per point; gradients in {} \
         precision",
            four_digits(bytes / 1e6),
            bytes / model.point_positions.len() as f64,
            if single { "single" } else { "double" }
        ),
    ]
}

/// Memory of set-up and run without what is recorded \[bytes\].
fn estimate(inspection: &Inspection) -> f64 {
    Footprint::counted(&inspection.case.problem, &inspection.simulation.discretisation).bytes
}

/// Peak of the memory during the set-up, and its estimate.
fn memory_text(inspection: &Inspection) -> Option<String> {
    let (peak, model) = (inspection.peak? as f64, &inspection.simulation.model);
    let (nodes, points) = (model.positions.len() as f64, model.point_positions.len() as f64);
    let estimate = estimate(inspection);
    Some(format!(
        "                    {:.0} MB at the peak of the set-up ({:.0} estimated): {:.0} bytes per point, {:.0} per \
         node",
        peak / 1e6,
        estimate / 1e6,
        peak / points,
        peak / nodes
    ))
}

fn modes_text(modes: Option<&ZeroEnergyModes>) -> Vec<String> {
    let Some(modes) = modes else {
        return vec![format!(
            "zero-energy modes   not searched for above {LARGEST_SEARCH} nodes or with --modes never; \
             use --modes always"
        )];
    };
    let number = match modes.count {
        Some(count) => count.to_string(),
        None => format!("at least {} (the body is too large to count all)", modes.at_least()),
    };
    let mut lines = vec![
        format!("rigid motions       {} not constrained at the start", modes.rigid),
        format!(
            "zero-energy modes   {number} beyond the rigid motions: the quadrature captures less than {ZERO_ENERGY_FRACTION} \
             of their strain energy, compared with {} points",
            modes.finer_points
        ),
    ];
    lines.extend(modes.least_captured.iter().take(3).map(|motion| {
        let CapturedMotion { fraction, node, position } = motion;
        format!(
            "                    {fraction:.4} is captured, largest at node {node} ({})",
            show(position)
        )
    }));
    lines
}

/// What the user should change, in sentences.
pub(crate) fn advice(inspection: &Inspection) -> Vec<String> {
    let problem = &inspection.case.problem;
    let mut advice: Vec<String> = Vec::new();
    if inspection.modes.as_ref().is_some_and(|modes| modes.at_least() > 0) {
        advice.push(
            "There are motions without strain energy, which grow without any warning: use smaller cells \
             where they are largest. discretisation.grid.cells_per_spacing = 1.26 without cell and \
             refine gives two points per node in 3-D, also where the nodes are refined."
                .into(),
        );
    }
    if inspection.inf_sup.is_some_and(|found| found.value < STIFF) {
        advice.push(
            "What is free hardly answers some pressures of the patches (inf-sup value): the nearly \
             incompressible material is too stiff there, as where one spacing lies between two held faces. \
             Use a smaller discretisation.spacing."
                .into(),
        );
    }
    let warnings = warnings(inspection.case, inspection.simulation);
    advice.extend(warnings.iter().map(|warning| {
        let mut letters = warning.chars();
        let first = letters.next().into_iter().flat_map(char::to_uppercase);
        first.chain(letters).chain(['.']).collect::<String>()
    }));
    let worst = inspection.conditions.first();
    if let Some(place) = worst.filter(|place| place.value > POOR * inspection.largest_condition) {
        advice.push(format!(
            "The support of point {} is close to being refused: raise discretisation.dilation from {}, or \
             add nodes at ({}).",
            place.index,
            problem.recipe.dilation,
            show(&place.position)
        ));
    }
    let [_, largest] = inspection.spacings;
    if inspection.weakest.value < FINE * largest.value {
        advice.push(format!(
            "The time step is limited by the fine nodes near ({}): a coarser spacing there makes every \
             step longer.",
            show(&inspection.weakest.position)
        ));
    }
    if advice.is_empty() {
        advice.push("No reason against running this case was found.".into());
    }
    advice
}

pub(crate) fn to_json(inspection: &Inspection) -> Value {
    let Inspection { case, simulation, .. } = inspection;
    let (discretisation, model) = (&simulation.discretisation, &simulation.model);
    let (nodes, points) = (model.positions.len(), discretisation.supports.len());
    let [smallest, largest] = &inspection.spacings;
    let (lower, upper) = bounding_box(&model.positions);
    json!({
        "schema_version": 1,
        "case": case.name,
        "dimension": match case.problem.dimension {
            Dimension::Three => "3d",
            Dimension::PlaneStrain { .. } => "plane_strain",
        },
        "nodes": nodes,
        "extent_m": [array(&lower), array(&upper)],
        "quadrature_points": points,
        "points_per_node": points as f64 / nodes as f64,
        "support": {
            "smallest": inspection.support.0,
            "mean": discretisation.mean_support(),
            "largest": inspection.support.1,
            "enlarged": discretisation.enlarged,
        },
        "uncovered_nodes": 0,
        "worst_conditions": inspection.conditions.iter().map(|p| located(p, "point")).collect::<Vec<_>>(),
        "largest_condition_accepted": inspection.largest_condition,
        "mass_kg": inspection.masses.iter().map(|p| located(p, "node")).collect::<Vec<_>>(),
        "spacing_m": inspection.spacings.iter().map(|p| located(p, "node")).collect::<Vec<_>>(),
        "spacing_ratio": largest.value / smallest.value,
        "gradients": discretisation.correction.map(|c| json!({
            "iterations": c.iterations,
            "relative_residual": c.residual,
            "tolerance": c.tolerance,
            "plain_defect": c.defect,
            "bodies": c.bodies,
        })),
        "critical_time_step_s": inspection.critical.time_step,
        "per_point_bound_s": model.per_point_bound,
        "weakest": {
            "node": inspection.weakest.index,
            "position_m": array(&inspection.weakest.position),
        },
        "bytes_per_step": model.bytes_per_step(),
        "estimated_memory_bytes": estimate(inspection).round(),
        "peak_memory_bytes": inspection.peak,
        "inf_sup": inspection.inf_sup.map(|found| json!({
            "value": found.value,
            "converged": found.converged,
            "pressures": found.pressures,
            "products": found.products,
        })),
        "zero_energy_modes": inspection.modes.as_ref().map(modes_json),
        "warnings": warnings(inspection.case, inspection.simulation),
        "advice": advice(inspection),
    })
}

fn inf_sup_text(found: &InfSup) -> String {
    let value = match found.value {
        value if value < UNANSWERED => format!("below {UNANSWERED}"),
        value if found.converged => four_digits(value),
        value => format!("at most {}", four_digits(value)),
    };
    let InfSup { pressures, products, .. } = found;
    format!(
        "inf-sup value       {value} of {pressures} pressures of patches, by {products} products"
    )
}

fn modes_json(modes: &ZeroEnergyModes) -> Value {
    json!({
        "count": modes.count,
        "at_least": modes.at_least(),
        "threshold": ZERO_ENERGY_FRACTION,
        "free_rigid_motions": modes.rigid,
        "finer_points": modes.finer_points,
        "softest": modes.least_captured.iter().map(|motion| json!({
            "share": motion.fraction,
            "node": motion.node,
            "position_m": array(&motion.position),
        })).collect::<Vec<_>>(),
    })
}

fn range(name: &str, unit: &str, [least, most]: &[Place; 2]) -> String {
    format!(
        "{name:<20}{} {unit} at node {} ({}) to {} {unit} at node {} ({}): ratio {}",
        four_digits(least.value),
        least.index,
        show(&least.position),
        four_digits(most.value),
        most.index,
        show(&most.position),
        four_digits(most.value / least.value)
    )
}

fn located(place: &Place, what: &str) -> Value {
    json!({ "value": place.value, what: place.index, "position_m": array(&place.position) })
}

fn array(v: &Vector3) -> [f64; 3] {
    [v.x, v.y, v.z]
}

/// Coordinates in metres.
fn show(v: &Vector3) -> String {
    format!("{}, {}, {} m", four_digits(v.x), four_digits(v.y), four_digits(v.z))
}
