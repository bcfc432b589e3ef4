//! Essential conditions: prescribed displacements on a selection of nodes.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3, rotation, vector_at};
use crate::discretisation::moments::homogeneous;
use crate::discretisation::{Discretisation, holds};
use crate::error::Error;
use crate::model::collocation::{Collocation, Scratch};
use crate::problem::{Enforcement, EssentialCondition, Field, Prescribed, Problem};
use nalgebra::{Matrix4, Vector4};

/// Directions with less than this share of all moments are empty \[–\].
const EMPTY: f64 = 1e-12;

/// The conditions of a problem, resolved to nodes and components.
#[derive(Debug, Clone)]
pub struct Constraints {
    pub conditions: Vec<EssentialCondition>,
    /// Consecutive spans of time with the same active conditions; the last
    /// one has no end.
    stages: Vec<Stage>,
}

#[derive(Debug, Clone)]
struct Stage {
    /// Holds for t < `until` \[s\].
    until: f64,
    /// One set of rows per component that is constrained at all.
    sets: Vec<ConstraintSet>,
}

/// All constraints on one component of the displacement.
#[derive(Debug, Clone)]
pub struct ConstraintSet {
    pub component: usize,
    pub rows: Vec<ConstraintRow>,
    /// `None`: the nodal parameter is set directly.
    collocation: Option<Collocation>,
}

impl ConstraintSet {
    fn new(
        component: usize,
        mut rows: Vec<ConstraintRow>,
        problem: &Problem,
        discretisation: &Discretisation,
        mass: &[f64],
    ) -> Result<ConstraintSet, Error> {
        let collocation = match problem.recipe.enforcement {
            Enforcement::Direct => None,
            Enforcement::Collocation => {
                fit_mean_gradient(&mut rows, component, &problem.conditions, discretisation);
                let nodes: Vec<u32> = rows.iter().map(|row| row.node).collect();
                let dependent = Error::DependentConstraints {
                    component: ['x', 'y', 'z'][component],
                    rows: rows.len(),
                };
                Some(Collocation::new(discretisation, mass, &nodes).ok_or(dependent)?)
            }
        };
        Ok(ConstraintSet { component, rows, collocation })
    }
}

/// One constrained component of one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstraintRow {
    pub node: u32,
    /// Index into [`Constraints::conditions`].
    pub condition: u32,
    /// Displacement at amplitude 1 \[m\]; a rotation has its own pose instead.
    pub displacement: f64,
}

/// Multipliers of the last step, and scratch that is kept between steps.
#[derive(Debug, Default)]
pub struct ConstraintForces {
    /// \[set\]\[row\] \[kg·m\], sets as in the stage that was enforced last.
    multipliers: Vec<Vec<f64>>,
    stage: usize,
    poses: Vec<Pose>,
    scratch: Scratch,
}

/// Force \[N\] and moment \[N·m\] that a condition exerts on the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reaction {
    pub force: Vector3,
    pub moment: Vector3,
}

impl Constraints {
    /// Selects nodes and factors the collocation systems. Where two active
    /// conditions claim the same component of a node, the first stated wins.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
        mass: &[f64],
    ) -> Result<Constraints, Error> {
        let conditions = problem.conditions.clone();
        let positions = &discretisation.cloud.positions;
        let selected: Vec<Vec<u32>> =
            conditions.iter().map(|condition| select(condition, discretisation)).collect();
        if let Some(index) = selected.iter().position(Vec::is_empty) {
            return Err(Error::EmptySelection { name: conditions[index].name.clone() });
        }
        let mut ends: Vec<f64> = conditions.iter().filter_map(|c| c.release).collect();
        ends.push(f64::INFINITY);
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let stage = |until: f64| -> Result<Stage, Error> {
            let active = |c: usize| conditions[c].release.is_none_or(|release| release >= until);
            let mut sets = Vec::new();
            for component in 0..problem.dimension.components() {
                let rows = claim(&conditions, &selected, component, active, positions);
                if !rows.is_empty() {
                    sets.push(ConstraintSet::new(component, rows, problem, discretisation, mass)?);
                }
            }
            Ok(Stage { until, sets })
        };
        let stages = ends.into_iter().map(stage).collect::<Result<_, _>>()?;
        Ok(Constraints { conditions, stages })
    }

    /// The sets that are active at time `t` \[s\].
    pub fn active(&self, t: f64) -> &[ConstraintSet] {
        &self.stages[self.stage(t)].sets
    }

    /// Index of the span of time that `t` \[s\] lies in.
    pub fn stage(&self, t: f64) -> usize {
        self.stages.iter().position(|stage| t < stage.until).unwrap_or(self.stages.len() - 1)
    }

    /// Whether some component of a node is prescribed for ever.
    pub fn always_holds(&self, node: u32) -> bool {
        let last = &self.stages[self.stages.len() - 1];
        last.sets.iter().any(|set| set.rows.iter().any(|row| row.node == node))
    }

    /// Changes the predicted displacements `u` \[m\] so that they meet the
    /// conditions of time `t` \[s\], and tells each change of an entry to
    /// `also(index, Δu)`. The multipliers m Δu \[kg·m\] stay in `forces`.
    pub fn enforce(
        &self,
        t: f64,
        positions: &[Vector3],
        mass: &[f64],
        u: &mut [f64],
        forces: &mut ConstraintForces,
        also: impl FnMut(usize, f64),
    ) {
        let mut poses = std::mem::take(&mut forces.poses);
        poses.clear();
        poses.extend(self.conditions.iter().map(|condition| Pose::at(condition, t)));
        let target = |row: &ConstraintRow, component: usize| {
            let condition = row.condition as usize;
            let X = &positions[row.node as usize];
            poses[condition].target(&self.conditions[condition].prescribed, row, X, component)
        };
        self.enforce_targets(t, mass, u, forces, target, also);
        forces.poses = poses;
    }

    /// As [`Constraints::enforce`] with all targets zero: the projection onto
    /// the displacements that the conditions leave free.
    pub fn project(&self, t: f64, mass: &[f64], u: &mut [f64], forces: &mut ConstraintForces) {
        self.enforce_targets(t, mass, u, forces, |_, _| 0.0, |_, _| ());
    }

    fn enforce_targets(
        &self,
        t: f64,
        mass: &[f64],
        u: &mut [f64],
        forces: &mut ConstraintForces,
        target: impl Fn(&ConstraintRow, usize) -> f64,
        mut also: impl FnMut(usize, f64),
    ) {
        forces.stage = self.stage(t);
        let components = u.len() / mass.len();
        let sets = &self.stages[forces.stage].sets;
        forces.multipliers.resize_with(sets.len(), Vec::new);
        for (set, values) in sets.iter().zip(&mut forces.multipliers) {
            let index = |node: u32| components * node as usize + set.component;
            values.clear();
            values.extend(set.rows.iter().map(|row| target(row, set.component)));
            match &set.collocation {
                Some(collocation) => {
                    collocation.solve(values, &mut forces.scratch, |node| u[index(node)]);
                    collocation.corrections(mass, values, |node, delta| {
                        u[index(node)] += delta;
                        also(index(node), delta);
                    });
                }
                None => {
                    for (row, value) in set.rows.iter().zip(values) {
                        let delta = *value - u[index(row.node)];
                        u[index(row.node)] = *value;
                        *value = mass[row.node as usize] * delta;
                        also(index(row.node), delta);
                    }
                }
            }
        }
    }

    /// Force and moment about `about` that each condition exerts on the body
    /// with reference `positions` \[m\] and nodal parameters `u` \[m\], from the
    /// multipliers of the last step times `force_factor` \[1/s²\].
    pub fn reactions(
        &self,
        forces: &ConstraintForces,
        force_factor: f64,
        about: &Vector3,
        positions: &[Vector3],
        u: &[f64],
    ) -> Vec<Reaction> {
        let components = u.len() / positions.len();
        let nothing = Reaction { force: Vector3::zeros(), moment: Vector3::zeros() };
        let mut reactions = vec![nothing; self.conditions.len()];
        let sets = &self.stages[forces.stage].sets;
        for (set, multipliers) in sets.iter().zip(&forces.multipliers) {
            for (i, (row, multiplier)) in set.rows.iter().zip(multipliers).enumerate() {
                let node = row.node as usize;
                // A constraint acts on the field where it prescribes the field.
                let displacement = match &set.collocation {
                    Some(collocation) => collocation.displacement(i, u, components),
                    None => vector_at(u, node, components),
                };
                let mut force = Vector3::zeros();
                force[set.component] = multiplier * force_factor;
                let reaction = &mut reactions[row.condition as usize];
                reaction.force += force;
                reaction.moment += (positions[node] + displacement - about).cross(&force);
            }
        }
        reactions
    }
}

/// A condition at one instant.
#[derive(Debug, Clone, Copy)]
struct Pose {
    amplitude: f64,
    /// R − I for a rotation.
    turn: Matrix3,
}

impl Pose {
    fn at(condition: &EssentialCondition, t: f64) -> Pose {
        let amplitude = condition.amplitude.at(t);
        let turn = match condition.prescribed {
            Prescribed::Displacement(_) | Prescribed::Field(_) => Matrix3::zeros(),
            Prescribed::Rotation { axis, angle, .. } => {
                rotation(&axis, amplitude * angle) - Matrix3::identity()
            }
        };
        Pose { amplitude, turn }
    }

    /// The displacement component \[m\] wanted at reference position `X`.
    fn target(
        &self,
        prescribed: &Prescribed,
        row: &ConstraintRow,
        X: &Vector3,
        component: usize,
    ) -> f64 {
        match prescribed {
            Prescribed::Displacement(_) | Prescribed::Field(_) => self.amplitude * row.displacement,
            Prescribed::Rotation { point, .. } => (self.turn * (X - point))[component],
        }
    }
}

fn select(condition: &EssentialCondition, discretisation: &Discretisation) -> Vec<u32> {
    let cloud = &discretisation.cloud;
    let chosen = |&node: &u32| holds(condition, cloud, node as usize);
    (0..cloud.positions.len() as u32).filter(chosen).collect()
}

/// The rows of one component: every active condition that prescribes it, the
/// first stated first, each node once, in ascending order.
fn claim(
    conditions: &[EssentialCondition],
    selected: &[Vec<u32>],
    component: usize,
    active: impl Fn(usize) -> bool,
    positions: &[Vector3],
) -> Vec<ConstraintRow> {
    let mut owner = vec![None; positions.len()];
    for (index, condition) in conditions.iter().enumerate() {
        let prescribes = match condition.prescribed {
            Prescribed::Displacement(values) => values[component].is_some(),
            Prescribed::Rotation { .. } | Prescribed::Field(_) => true,
        };
        if !prescribes || !active(index) {
            continue;
        }
        for &node in &selected[index] {
            owner[node as usize].get_or_insert(index as u32);
        }
    }
    let row = |(node, condition): (usize, Option<u32>)| {
        let condition = condition?;
        let displacement = match &conditions[condition as usize].prescribed {
            Prescribed::Displacement(values) => values[component].unwrap_or(0.0),
            Prescribed::Field(field) => field.at(&positions[node])[component],
            Prescribed::Rotation { .. } => 0.0,
        };
        Some(ConstraintRow { node: node as u32, condition, displacement })
    };
    owner.into_iter().enumerate().filter_map(row).collect()
}

/// Where one field ū is prescribed all around a body, the mean gradient that nodes
/// with vector areas a_c see, Σ_c ū_c a_c/V, is made the field's own, ∮ ū N dA/V, by
/// the smallest changes of the form a_c·β. A nearly incompressible body that has no
/// free face to move would be squeezed by what the nodes miss of its change of
/// volume. Nodes see affine fields exactly: these are taken out first.
fn fit_mean_gradient(
    rows: &mut [ConstraintRow],
    component: usize,
    conditions: &[EssentialCondition],
    discretisation: &Discretisation,
) {
    let surface = &discretisation.surface;
    let Some(field) = field_all_around(rows, conditions, &surface.held_areas) else { return };
    let areas: Vec<Vector3> = rows.iter().map(|row| area_at(row, &surface.held_areas)).collect();
    let positions = &discretisation.cloud.positions;
    let at = |row: &ConstraintRow| positions[row.node as usize];
    let samples =
        |(row, area): (&ConstraintRow, &Vector3)| (at(row), area.norm(), row.displacement);
    let Some(affine) = affine_fit(rows.iter().zip(&areas).map(samples).collect()) else { return };
    let mut gap = Vector3::zeros();
    for panel in &surface.panels {
        let rest = field.at(&panel.centre)[component] - affine(&panel.centre);
        gap += panel.area * rest * panel.normal;
    }
    let mut gram = Matrix3::zeros();
    for (row, area) in rows.iter().zip(&areas) {
        gap -= (row.displacement - affine(&at(row))) * area;
        gram += area * area.transpose();
    }
    if let Ok(inverse) = gram.pseudo_inverse(EMPTY * gram.trace()) {
        let beta = inverse * gap;
        rows.iter_mut().zip(&areas).for_each(|(row, area)| row.displacement += beta.dot(area));
    }
}

/// The field that alone prescribes all `rows`, if these are at all nodes with areas.
fn field_all_around<'a>(
    rows: &[ConstraintRow],
    conditions: &'a [EssentialCondition],
    areas: &[(u32, Vector3)],
) -> Option<&'a Field> {
    let condition = rows.first()?.condition;
    let Prescribed::Field(field) = &conditions[condition as usize].prescribed else { return None };
    let one = rows.iter().all(|row| row.condition == condition);
    let held = |(node, _): &(u32, Vector3)| rows.binary_search_by_key(node, |row| row.node).is_ok();
    (one && !areas.is_empty() && areas.iter().all(held)).then_some(field)
}

fn area_at(row: &ConstraintRow, areas: &[(u32, Vector3)]) -> Vector3 {
    let index = areas.binary_search_by_key(&row.node, |(node, _)| *node);
    index.map_or(Vector3::zeros(), |index| areas[index].1)
}

/// The affine function nearest to samples (X, size, value), by least squares.
fn affine_fit(samples: Vec<(Vector3, f64, f64)>) -> Option<impl Fn(&Vector3) -> f64> {
    let origin = samples.first()?.0;
    let distance = |(X, ..): &(Vector3, f64, f64)| (X - origin).norm();
    let length = samples.iter().map(distance).fold(f64::MIN_POSITIVE, f64::max);
    let p = move |X: &Vector3| homogeneous(&((X - origin) / length));
    let (mut gram, mut moments) = (Matrix4::zeros(), Vector4::zeros());
    for (X, size, value) in &samples {
        gram += *size * p(X) * p(X).transpose();
        moments += *size * *value * p(X);
    }
    let coefficients = gram.pseudo_inverse(EMPTY * gram.trace()).ok()? * moments;
    Some(move |X: &Vector3| coefficients.dot(&p(X)))
}
