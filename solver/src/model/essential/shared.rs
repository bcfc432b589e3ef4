//! Conditions that prescribe the same components of the same nodes.
#![allow(non_snake_case)]

use super::rows::{ConditionState, ConstraintRow, row_of, selected_nodes};
use crate::algebra::tensor::Vector3;
use crate::discretisation::neighbours::Neighbours;
use crate::discretisation::nodes::NodeCloud;
use crate::discretisation::{Discretisation, Warning};
use crate::error::Error;
use crate::problem::{Amplitude, EssentialCondition, Problem};

/// Displacements of one node may differ by this fraction of its spacing \[–\]: round-off.
const AGREEMENT: f64 = 1e-9;
/// Instants at which conditions are compared, and where the tables of their amplitudes bend.
const INSTANTS: usize = 65;
/// Neighbours on a boundary lie within this many spacings \[–\].
const REACH: f64 = 1.5;

/// Two conditions, the nodes that both select, and the components that both prescribe.
struct Shared<'a> {
    conditions: [&'a EssentialCondition; 2],
    nodes: Vec<u32>,
    components: Vec<usize>,
}

/// Refuses two conditions that prescribe different displacements of one node. Where they
/// prescribe the same, the first has the force: a warning says so, unless the shared nodes
/// are but an edge between two faces.
pub(crate) fn check_shared_nodes(
    problem: &Problem,
    discretisation: &Discretisation,
) -> Result<Vec<Warning>, Error> {
    let conditions = &problem.conditions;
    let cloud = &discretisation.cloud;
    let selected = selected_nodes(conditions, discretisation)?;
    let mut warnings = Vec::new();
    for second in 0..conditions.len() {
        for first in 0..second {
            let both = [&conditions[first], &conditions[second]];
            let components: Vec<usize> = (0..problem.dimension.components())
                .filter(|&k| both.iter().all(|condition| condition.prescribes(k)))
                .collect();
            let [a, b] = [&selected[first], &selected[second]];
            let nodes: Vec<u32> =
                a.iter().copied().filter(|node| b.binary_search(node).is_ok()).collect();
            if components.is_empty() || nodes.is_empty() {
                continue;
            }
            let shared = Shared { conditions: both, nodes, components };
            shared.refuse_contradiction(problem.motion.end(), cloud)?;
            if !shared.is_edge([a, b], cloud) {
                warnings.push(shared.warning());
            }
        }
    }
    Ok(warnings)
}

impl Shared<'_> {
    fn refuse_contradiction(&self, end: f64, cloud: &NodeCloud) -> Result<(), Error> {
        for t in self.instants(end) {
            let states = self.conditions.map(|condition| ConditionState::at(condition, t));
            let displacement = |which: usize, node: u32, component: usize| {
                let X = &cloud.positions[node as usize];
                let prescribed = &self.conditions[which].prescribed;
                let row: ConstraintRow = row_of(prescribed, node, which, component, X);
                states[which].target(prescribed, &row, X, component)
            };
            for &component in &self.components {
                let differ = |&&node: &&u32| {
                    let difference =
                        displacement(0, node, component) - displacement(1, node, component);
                    difference.abs() > AGREEMENT * cloud.spacing[node as usize]
                };
                let Some(&node) = self.nodes.iter().find(differ) else { continue };
                let [first, second] = self.conditions.map(|condition| condition.name.clone());
                return Err(Error::ContradictingConditions {
                    first,
                    second,
                    component: AXES[component],
                    nodes: self.nodes.iter().filter(differ).count(),
                    node: node as usize,
                    position: cloud.positions[node as usize],
                    time: t,
                    displacements: [0, 1].map(|which| displacement(which, node, component)),
                });
            }
        }
        Ok(())
    }

    /// While both are active.
    fn instants(&self, end: f64) -> Vec<f64> {
        let releases = self.conditions.iter().filter_map(|condition| condition.release);
        let end = releases.fold(end, f64::min);
        let mut instants: Vec<f64> =
            (0..INSTANTS).map(|n| end * n as f64 / (INSTANTS - 1) as f64).collect();
        for condition in self.conditions {
            if let Amplitude::Table(rows) = &condition.amplitude {
                instants.extend(rows.iter().map(|row| row.0).filter(|t| (0.0..end).contains(t)));
            }
        }
        // A condition holds until its release, not at it.
        instants.retain(|&t| self.conditions.iter().all(|c| c.release.is_none_or(|r| t < r)));
        instants
    }

    /// Whether each shared node has neighbours that only the one condition selects, and
    /// neighbours that only the other does.
    fn is_edge(&self, selected: [&Vec<u32>; 2], cloud: &NodeCloud) -> bool {
        let position = |&node: &u32| cloud.positions[node as usize];
        let reach = |node: u32| REACH * cloud.spacing[node as usize];
        let longest = self.nodes.iter().map(|&node| reach(node)).fold(0.0, f64::max);
        selected.iter().all(|nodes| {
            let alone = |node: &&u32| self.nodes.binary_search(node).is_err();
            let own: Vec<Vector3> = nodes.iter().filter(alone).map(position).collect();
            if own.is_empty() {
                return false;
            }
            let search = Neighbours::new(&own, longest);
            self.nodes.iter().all(|node| {
                let mut near = false;
                search.for_each_within(&position(node), reach(*node), |_, _| near = true);
                near
            })
        })
    }

    fn warning(&self) -> Warning {
        let [first, second] = self.conditions.map(|condition| condition.name.clone());
        let components = self.components.iter().map(|&k| AXES[k]).collect();
        Warning::SharedNodes { first, second, components, nodes: self.nodes.len() }
    }
}

const AXES: [char; 3] = ['x', 'y', 'z'];
