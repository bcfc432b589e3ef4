//! What obstacles do to the body, as JSON and as text, and its distance from them.
#![allow(non_snake_case)]

use mtled::algebra::tensor::Vector3;
use mtled::model::contact::{ContactPlan, ContactResult};
use mtled_case::scene::Case;
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use serde_json::{Value, json};

/// `contacts` of `result.json`.
pub(crate) fn contacts_json(case: &Case, results: &[ContactResult]) -> Vec<Value> {
    let obstacles = case.problem.obstacles.iter().zip(results);
    obstacles
        .map(|(obstacle, result)| {
            let mut contact = json!({
                "obstacle": obstacle.name,
                "nodes": result.nodes,
                "force_n": <[f64; 3]>::from(result.force),
                "normal_force_n": result.normal_force,
                "area_m2": result.area,
                "largest_pressure_pa": result.largest_pressure,
                "deepest_penetration_m": result.depth,
            });
            if result.area > 0.0 {
                contact["mean_pressure_pa"] = json!(result.normal_force / result.area);
            }
            if result.depth > 0.0 {
                contact["deepest_at_m"] = json!(<[f64; 3]>::from(result.deepest));
            }
            contact
        })
        .collect()
}

/// A line for each obstacle.
pub(crate) fn contacts_text(case: &Case, results: &[ContactResult]) -> Vec<String> {
    let line = |(obstacle, result): (&mtled::problem::Obstacle, &ContactResult)| {
        let name = printable(&obstacle.name);
        if result.nodes == 0 {
            return format!("  \"{name}\" touches nothing");
        }
        let [x, y, z] = <[f64; 3]>::from(result.force).map(four_digits);
        format!(
            "  \"{name}\" pushes {} nodes on {} m² with ({x}, {y}, {z}) N in sum, {} N along its normals, \
             {} Pa at most; {} m deep at most between nodes",
            result.nodes,
            four_digits(result.area),
            four_digits(result.normal_force),
            four_digits(result.largest_pressure),
            four_digits(result.depth)
        )
    };
    case.problem.obstacles.iter().zip(results).map(line).collect()
}

/// The gap to the nearest obstacle \[m\] at time `t` \[s\] at positions that have moved by `displacement`
/// \[position\]\[x, y, z\] \[m\].
pub(crate) fn contact_gaps(
    (plan, t): (&ContactPlan, f64),
    positions: &[Vector3],
    displacement: &[f64],
) -> Vec<f64> {
    let obstacles: Vec<_> = plan.all_placed(t).map(|(_, placed)| placed).collect();
    let moved = positions.iter().zip(displacement.as_chunks::<3>().0);
    let gap_at = |(X, u): (&Vector3, &[f64; 3])| {
        let x = X + Vector3::from(*u);
        obstacles.iter().map(|obstacle| obstacle.gap(&x)).fold(f64::INFINITY, f64::min)
    };
    moved.map(gap_at).collect()
}
