//! What the conditions prescribe: for which component of which node, and how much.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3, rotation};
use crate::discretisation::{Discretisation, selects};
use crate::error::Error;
use crate::problem::{EssentialCondition, Field, Prescribed};

/// One constrained component of one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstraintRow {
    /// The node.
    pub node: u32,
    /// Index into [`Constraints::conditions`](super::Constraints::conditions).
    pub condition: u32,
    /// Displacement at amplitude 1 \[m\]; 0 for a rotation, which is not linear in
    /// its amplitude.
    pub displacement: f64,
}

/// The nodes that each condition selects \[condition\].
pub(super) fn selected_nodes(
    conditions: &[EssentialCondition],
    discretisation: &Discretisation,
) -> Result<Vec<Vec<u32>>, Error> {
    let cloud = &discretisation.cloud;
    let select = |condition: &EssentialCondition| {
        let selected = |&node: &u32| selects(condition, cloud, node as usize);
        let nodes: Vec<u32> = (0..cloud.positions.len() as u32).filter(selected).collect();
        if nodes.is_empty() {
            return Err(Error::EmptySelection { name: condition.name.clone() });
        }
        if let Prescribed::Field(field) = &condition.prescribed {
            for &node in &nodes {
                refuse_unknown(&condition.name, field, node as usize, &cloud.positions)?;
            }
        }
        Ok(nodes)
    };
    conditions.iter().map(select).collect()
}

/// Refuses a node that is too far from the data of a field, or at which it is no number.
fn refuse_unknown(
    name: &str,
    field: &Field,
    node: usize,
    positions: &[Vector3],
) -> Result<(), Error> {
    let (name, position) = (name.to_string(), positions[node]);
    if let Field::Scattered(data) = field {
        let (distance, reach) = (data.distance(&position), data.reach());
        if distance > reach {
            return Err(Error::BeyondData { name, node, position, distance, reach });
        }
    }
    if field.at(&position).iter().all(|component| component.is_finite()) {
        Ok(())
    } else {
        Err(Error::NoDisplacement { name, node, position })
    }
}

/// The rows of one component, in ascending order of nodes. A node that several
/// active conditions prescribe belongs to the first of them.
pub(super) fn rows_of_component(
    conditions: &[EssentialCondition],
    selected: &[Vec<u32>],
    component: usize,
    active: impl Fn(usize) -> bool,
    positions: &[Vector3],
) -> Vec<ConstraintRow> {
    let mut owner = vec![None; positions.len()];
    for (index, condition) in conditions.iter().enumerate() {
        if !condition.prescribes(component) || !active(index) {
            continue;
        }
        for &node in &selected[index] {
            owner[node as usize].get_or_insert(index as u32);
        }
    }
    let row = |(node, condition): (usize, Option<u32>)| {
        let condition = condition? as usize;
        let prescribed = &conditions[condition].prescribed;
        Some(row_of(prescribed, node as u32, condition, component, &positions[node]))
    };
    owner.into_iter().enumerate().filter_map(row).collect()
}

/// The row of a component that a condition prescribes of a node at `X`.
pub(super) fn row_of(
    prescribed: &Prescribed,
    node: u32,
    condition: usize,
    component: usize,
    X: &Vector3,
) -> ConstraintRow {
    let displacement = match prescribed {
        Prescribed::Displacement(values) => values[component].unwrap_or(0.0),
        Prescribed::Field(field) => field.at(X)[component],
        Prescribed::Rotation { .. } => 0.0,
    };
    ConstraintRow { node, condition: condition as u32, displacement }
}

/// What a condition prescribes at one instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct ConditionState {
    amplitude: f64,
    /// R − I of a rotation, otherwise 0.
    R_minus_I: Matrix3,
}

impl ConditionState {
    /// The state at time `t` \[s\].
    pub fn at(condition: &EssentialCondition, t: f64) -> ConditionState {
        let amplitude = condition.amplitude.at(t);
        let R_minus_I = match condition.prescribed {
            Prescribed::Displacement(_) | Prescribed::Field(_) => Matrix3::zeros(),
            Prescribed::Rotation { axis, angle, .. } => {
                rotation(&axis, amplitude * angle) - Matrix3::identity()
            }
        };
        ConditionState { amplitude, R_minus_I }
    }

    /// The prescribed displacement component \[m\] at reference position `X`.
    pub fn target(
        &self,
        prescribed: &Prescribed,
        row: &ConstraintRow,
        X: &Vector3,
        component: usize,
    ) -> f64 {
        match prescribed {
            Prescribed::Displacement(_) | Prescribed::Field(_) => self.amplitude * row.displacement,
            Prescribed::Rotation { point, .. } => (self.R_minus_I * (X - point))[component],
        }
    }
}
