//! External forces and initial velocities.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::{Discretisation, Rows, Warning};
use crate::error::Error;
use crate::geometry::{Field, Selector};
use crate::model::essential::Constraints;
use crate::model::loaded_part::LoadedPart;
use crate::model::loaded_volume::LoadedVolume;
use crate::model::mass::masses;
use crate::problem::{
    Amplitude, Cavity, EssentialCondition, Loads, Motion, Prescribed, Problem, Traction,
};
use std::f64::consts::PI;

/// A nodal force pattern with the amplitude that scales it.
#[derive(Debug, Clone)]
pub struct LoadPattern {
    /// Force at amplitude 1 \[component of node\] \[N\].
    pub force: Vec<f64>,
    /// The factor over time.
    pub amplitude: Amplitude,
}

/// All load patterns of a problem: body forces Σ_q ρ w_q φ_a b and tractions
/// ∮ φ_a t dA over the selected boundary panels, by the surface rule of the
/// consistent gradients (method book, eqs. 14.1 and 14.2).
pub fn load_patterns(
    problem: &Problem,
    discretisation: &Discretisation,
    density: &[f64],
) -> Result<Vec<LoadPattern>, Error> {
    let d = problem.dimension.components();
    let size = d * discretisation.cloud.positions.len();
    let mut patterns = Vec::new();
    for (index, body_force) in problem.loads.body_forces.iter().enumerate() {
        let mut force = vec![0.0; size];
        let mut add_points =
            |positions: &[Vector3], masses: &[f64], rows: &Rows| -> Result<bool, Error> {
                for (point, (X, mass)) in positions.iter().zip(masses).enumerate() {
                    let acceleration = value(&body_force.acceleration, X, ("body_force", index))?;
                    for entry in rows.row(point) {
                        let nodal_mass = mass * rows.phi[entry];
                        add(&mut force, d, rows.nodes[entry], &(acceleration * nodal_mass));
                    }
                }
                Ok(!positions.is_empty())
            };
        let acts = if body_force.part.is_everything() {
            let mut acts = false;
            for (quadrature, rows) in discretisation.volumes() {
                let masses: Vec<f64> = masses(quadrature, density).collect();
                acts |= add_points(&quadrature.positions, &masses, rows)?;
            }
            acts
        } else {
            let part = LoadedVolume::new(problem, discretisation, (index, &body_force.part))?;
            add_points(&part.positions, &part.masses, &part.rows)?
        };
        if !acts {
            return Err(Error::EmptyBodyForce { index });
        }
        patterns.push(LoadPattern { force, amplitude: body_force.amplitude.clone() });
    }
    for (index, traction) in problem.loads.tractions.iter().enumerate() {
        let force = traction_force(problem, discretisation, (index, traction))?;
        patterns.push(LoadPattern { force, amplitude: traction.amplitude.clone() });
    }
    Ok(patterns)
}

/// Gives the mean of each body force over everything to the masses that were `added` \[node\] \[kg\],
/// so that a body falls as one. Force and moment of a connected body do not change, since what is
/// added has neither mass nor first moments (method book, eq. 14.10).
pub fn follow_masses(
    patterns: &mut [LoadPattern],
    problem: &Problem,
    (added, mass, bodies): (&[f64], &[f64], &[u32]),
) {
    let d = problem.dimension.components();
    let count = bodies.iter().max().map_or(0, |last| *last as usize + 1);
    for (pattern, load) in patterns.iter_mut().zip(&problem.loads.body_forces) {
        if !load.part.is_everything() {
            continue;
        }
        let (mut totals, mut masses) = (vec![0.0; d * count], vec![0.0; count]);
        for (node, &body) in bodies.iter().enumerate() {
            masses[body as usize] += mass[node];
            for k in 0..d {
                totals[d * body as usize + k] += pattern.force[d * node + k];
            }
        }
        for (node, &body) in bodies.iter().enumerate() {
            for k in 0..d {
                let mean = totals[d * body as usize + k] / masses[body as usize];
                pattern.force[d * node + k] += added[node] * mean;
            }
        }
    }
}

fn traction_force(
    problem: &Problem,
    discretisation: &Discretisation,
    (index, traction): (usize, &Traction),
) -> Result<Vec<f64>, Error> {
    let d = problem.dimension.components();
    let nodes = discretisation.cloud.positions.len();
    let Some(part) = LoadedPart::new(problem, discretisation, &traction.part)? else {
        return Err(Error::EmptyTraction { name: traction.name.clone() });
    };
    let mut force = vec![0.0; d * nodes];
    let strengths = part.strengths(nodes, |panel| traction.traction.at(&panel.centre));
    let forces = part.rule().scatter(nodes, &strengths);
    for (node, nodal_force) in forces.iter().enumerate() {
        let position = &discretisation.cloud.positions[node];
        is_number(nodal_force, position, ("traction", index))?;
        add(&mut force, d, node as u32, nodal_force);
    }
    Ok(force)
}

/// The value of a field of an entry of a list.
fn value(
    field: &Field,
    position: &Vector3,
    (what, index): (&'static str, usize),
) -> Result<Vector3, Error> {
    let value = field.at(position);
    is_number(&value, position, (what, index))?;
    Ok(value)
}

fn is_number(
    value: &Vector3,
    position: &Vector3,
    (what, index): (&'static str, usize),
) -> Result<(), Error> {
    let is_number = value.iter().all(|component| component.is_finite());
    is_number.then_some(()).ok_or(Error::NoValue { what, index, position: *position })
}

fn add(force: &mut [f64], components: usize, node: u32, nodal_force: &Vector3) {
    for k in 0..components {
        force[components * node as usize + k] += nodal_force[k];
    }
}

/// Velocity at t = 0 \[component of node\] \[m/s\]. Each part must set that of some node.
pub fn initial_velocity(
    problem: &Problem,
    discretisation: &Discretisation,
) -> Result<Vec<f64>, Error> {
    let components = problem.dimension.components();
    let mut velocity = vec![0.0; components * discretisation.cloud.positions.len()];
    let parts = &problem.loads.initial_velocities;
    let mut used = vec![false; parts.len()];
    for (node, position) in discretisation.cloud.positions.iter().enumerate() {
        if let Some(index) = parts.iter().position(|(part, _)| part.contains(position)) {
            used[index] = true;
            let own = value(&parts[index].1, position, ("initial_velocity", index))?;
            for k in 0..components {
                velocity[components * node + k] = own[k];
            }
        }
    }
    match used.iter().position(|used| !used) {
        Some(index) => Err(Error::EmptyInitialVelocity { index }),
        None => Ok(velocity),
    }
}

/// Loads that have no effect, or not their whole effect.
pub fn check_loads(
    problem: &Problem,
    discretisation: &Discretisation,
    constraints: &Constraints,
) -> Vec<Warning> {
    let cloud = &discretisation.cloud;
    let carried = |part: &Selector, acts: &dyn Fn(&Vector3, usize) -> bool| {
        let selected =
            |&node: &usize| cloud.on_boundary[node] && part.contains(&cloud.positions[node]);
        let prescribed = |node: usize| {
            (0..problem.dimension.components())
                .filter(|&k| acts(&cloud.positions[node], k))
                .all(|k| constraints.always_prescribes(node as u32, k))
        };
        let mut nodes = (0..cloud.positions.len()).filter(selected).peekable();
        nodes.peek().is_some() && nodes.all(prescribed)
    };
    let Loads { tractions, pressures, .. } = &problem.loads;
    let tractions =
        tractions.iter().filter(|t| carried(&t.part, &|X, k| t.traction.at(X)[k] != 0.0));
    let pressures = pressures.iter().filter(|p| carried(&p.part, &|_, _| true));
    let names = tractions.map(|t| &t.name).chain(pressures.map(|p| &p.name));
    let mut warnings: Vec<Warning> =
        names.map(|name| Warning::CarriedTraction { name: name.clone() }).collect();
    if !matches!(problem.motion, Motion::Dynamic { .. }) {
        warnings.extend(unfinished(problem).chain(released(problem)));
        warnings.extend(problem.conditions.iter().filter_map(sudden_turn));
    }
    warnings
}

/// Conditions that no longer act when the load of a static problem ends.
fn released(problem: &Problem) -> impl Iterator<Item = Warning> {
    let end = problem.motion.end();
    problem.conditions.iter().filter_map(move |condition| {
        let release = condition.release.filter(|release| *release <= end)?;
        Some(Warning::ReleasedEarly { name: condition.name.clone(), release, end })
    })
}

/// A rotation that begins with more than half a turn.
fn sudden_turn(condition: &EssentialCondition) -> Option<Warning> {
    let Prescribed::Rotation { angle, .. } = condition.prescribed else { return None };
    let angle = angle * condition.amplitude.at(0.0);
    let name = condition.name.clone();
    (angle.abs() > PI).then_some(Warning::SuddenTurn { name, angle })
}

/// Amplitudes that are on their way when the load of a static problem ends.
fn unfinished<'a>(problem: &'a Problem) -> impl Iterator<Item = Warning> + 'a {
    let end = problem.motion.end();
    let conditions = problem.conditions.iter().map(|c| (c.name.clone(), &c.amplitude));
    let tractions = problem.loads.tractions.iter().map(|t| (t.name.clone(), &t.amplitude));
    let pressures = problem.loads.pressures.iter().map(|p| (p.name.clone(), &p.amplitude));
    let inflow = |c: &'a Cavity| Some((c.name.clone(), &c.fluid.as_ref()?.amplitude));
    let body_forces = problem.loads.body_forces.iter().enumerate();
    let body_forces = body_forces.map(|(n, b)| (format!("body_force[{n}]"), &b.amplitude));
    let inflows = problem.loads.cavities.iter().filter_map(inflow);
    conditions.chain(tractions).chain(pressures).chain(inflows).chain(body_forces).filter_map(
        move |(name, amplitude)| {
            let (Amplitude::Linear { duration } | Amplitude::Smooth { duration }) = *amplitude
            else {
                return None;
            };
            let factor = amplitude.at(end);
            (duration > end).then_some(Warning::UnfinishedLoad { name, duration, end, factor })
        },
    )
}
