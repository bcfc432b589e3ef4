//! The constraints of a body over time, their enforcement and their reactions.
#![allow(non_snake_case)]

use super::collocation::Collocation;
use super::mean_gradient::fit_mean_gradient;
use super::rows::{ConditionState, ConstraintRow, rows_of_component, selected_nodes};
use crate::algebra::sparse_cholesky::Scratch;
use crate::algebra::tensor::Vector3;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::problem::{Enforcement, EssentialCondition, Prescribed, Problem};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The conditions of a problem, resolved to nodes and components.
#[derive(Debug, Clone)]
pub struct Constraints {
    /// As stated in the problem.
    pub conditions: Vec<EssentialCondition>,
    /// Consecutive time intervals between releases; the last one has no end.
    pub(super) stages: Vec<Stage>,
}

#[derive(Debug, Clone)]
pub(super) struct Stage {
    /// Active for t < `until` \[s\].
    until: f64,
    /// One set per constrained component.
    pub(super) sets: Vec<ConstraintSet>,
}

/// All constraints on one component of the displacement.
#[derive(Debug, Clone)]
pub struct ConstraintSet {
    /// 0, 1, 2 for x, y, z.
    pub component: usize,
    /// In ascending order of nodes.
    pub rows: Vec<ConstraintRow>,
    /// `None`: the nodal parameter is set directly. Sets with the same nodes have the same.
    pub(super) collocation: Option<Arc<Collocation>>,
}

impl ConstraintSet {
    fn new(
        component: usize,
        mut rows: Vec<ConstraintRow>,
        others: &[ConstraintSet],
        problem: &Problem,
        discretisation: &Discretisation,
        mass: &[f64],
    ) -> Result<ConstraintSet, Error> {
        let alike = others.iter().find(|other| {
            let nodes = other.rows.iter().map(|row| row.node);
            nodes.eq(rows.iter().map(|row| row.node))
        });
        let known = alike.and_then(|other| other.collocation.clone());
        let collocation = match problem.recipe.enforcement {
            Enforcement::Direct => None,
            Enforcement::Collocation => {
                fit_mean_gradient(&mut rows, component, &problem.conditions, discretisation);
                let nodes: Vec<u32> = rows.iter().map(|row| row.node).collect();
                let made = || Collocation::new(discretisation, mass, &nodes).map(Arc::new);
                let dependent = || Error::DependentConstraints {
                    component: ['x', 'y', 'z'][component],
                    rows: rows.len(),
                };
                Some(known.or_else(made).ok_or_else(dependent)?)
            }
        };
        Ok(ConstraintSet { component, rows, collocation })
    }

    /// Whether collocation at the same nodes holds both.
    fn has_nodes_of(&self, other: &ConstraintSet) -> bool {
        let both = self.collocation.as_ref().zip(other.collocation.as_ref());
        both.is_some_and(|(own, other)| Arc::ptr_eq(own, other))
    }

    fn constrains(&self, node: u32) -> bool {
        self.rows.binary_search_by_key(&node, |row| row.node).is_ok()
    }
}

/// Multipliers of the last enforcement, and scratch memory.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub struct ConstraintForces {
    /// \[set\]\[row\] \[kg·m\], the sets of `stage`.
    pub(super) multipliers: Vec<Vec<f64>>,
    pub(super) stage: usize,
    #[serde(skip)]
    states: Vec<ConditionState>,
    /// Of sets with the same nodes, one after the other.
    #[serde(skip)]
    values: Vec<f64>,
    #[serde(skip)]
    scratch: Scratch,
}

impl Constraints {
    /// What is held, whatever the times and displacements: of each stage and component the nodes,
    /// and whether their parameters are set directly.
    pub fn held(&self) -> Vec<(usize, bool, Vec<u32>)> {
        let of_set = |set: &ConstraintSet| {
            let nodes = set.rows.iter().map(|row| row.node).collect();
            (set.component, set.collocation.is_none(), nodes)
        };
        self.stages.iter().flat_map(|stage| stage.sets.iter().map(of_set)).collect()
    }

    /// Selects nodes and factors the collocation systems with the masses `mass`
    /// \[node\] \[kg\]. Where two active conditions prescribe the same component of
    /// a node, the first stated has the force.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
        mass: &[f64],
    ) -> Result<Constraints, Error> {
        let conditions = problem.conditions.clone();
        let positions = &discretisation.cloud.positions;
        let selected = selected_nodes(&conditions, discretisation)?;
        let mut ends: Vec<f64> = conditions.iter().filter_map(|c| c.release).collect();
        ends.push(f64::INFINITY);
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let stage = |until: f64| -> Result<Stage, Error> {
            let active = |c: usize| conditions[c].release.is_none_or(|release| release >= until);
            let mut sets = Vec::new();
            for component in 0..problem.dimension.components() {
                let rows = rows_of_component(&conditions, &selected, component, active, positions);
                if !rows.is_empty() {
                    let set =
                        ConstraintSet::new(component, rows, &sets, problem, discretisation, mass)?;
                    sets.push(set);
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

    /// Index of the interval between releases that contains `t` \[s\].
    pub fn stage(&self, t: f64) -> usize {
        self.stages.iter().position(|stage| t < stage.until).unwrap_or(self.stages.len() - 1)
    }

    /// Whether no prescribed displacement changes between two times \[s\].
    pub fn hold_still(&self, from: f64, to: f64) -> bool {
        let still = |condition: &EssentialCondition| match &condition.prescribed {
            Prescribed::Displacement(values) if values.iter().flatten().all(|&u| u == 0.0) => true,
            _ => condition.amplitude.at(from) == condition.amplitude.at(to),
        };
        self.stage(from) == self.stage(to) && self.conditions.iter().all(still)
    }

    /// By how much all prescribed rotations turn between two times, together \[rad\].
    pub(crate) fn turn(&self, (from, to): (f64, f64)) -> f64 {
        let of = |condition: &EssentialCondition| match condition.prescribed {
            Prescribed::Rotation { angle, .. } => {
                angle * (condition.amplitude.at(to) - condition.amplitude.at(from))
            }
            Prescribed::Displacement(_) | Prescribed::Field(_) => 0.0,
        };
        self.conditions.iter().map(|condition| of(condition).abs()).sum()
    }

    /// Whether one component of a node is prescribed and never released.
    pub fn always_prescribes(&self, node: u32, component: usize) -> bool {
        self.last().iter().any(|set| set.component == component && set.constrains(node))
    }

    /// Number of values that are prescribed at time `t` \[s\].
    pub fn count(&self, t: f64) -> usize {
        self.active(t).iter().map(|set| set.rows.len()).sum()
    }

    /// The sets that are never released.
    fn last(&self) -> &[ConstraintSet] {
        &self.stages[self.stages.len() - 1].sets
    }

    /// Calls `visit(component, (node, factor) …)` for every prescribed value at time `t`
    /// \[s\]: the sum of these nodal parameters is what is prescribed.
    pub fn for_each_row(
        &self,
        t: f64,
        mut visit: impl FnMut(usize, &mut dyn Iterator<Item = (u32, f64)>),
    ) {
        for set in self.active(t) {
            for (i, row) in set.rows.iter().enumerate() {
                match &set.collocation {
                    Some(collocation) => visit(set.component, &mut collocation.row(i)),
                    None => visit(set.component, &mut std::iter::once((row.node, 1.0))),
                }
            }
        }
    }

    /// The nodes of which all `components` are prescribed at time `t` \[s\], with the
    /// displacements \[m\] and the condition of the first component.
    pub fn prescribed_nodes(
        &self,
        t: f64,
        components: usize,
        positions: &[Vector3],
    ) -> Vec<(u32, Vector3, u32)> {
        let state = |condition| ConditionState::at(condition, t);
        let states: Vec<ConditionState> = self.conditions.iter().map(state).collect();
        let mut nodes: BTreeMap<u32, (usize, Vector3, u32)> = BTreeMap::new();
        for set in self.active(t) {
            for row in &set.rows {
                let condition = row.condition as usize;
                let X = &positions[row.node as usize];
                let prescribed = &self.conditions[condition].prescribed;
                let first = (0, Vector3::zeros(), row.condition);
                let (count, displacement, _) = nodes.entry(row.node).or_insert(first);
                *count += 1;
                displacement[set.component] =
                    states[condition].target(prescribed, row, X, set.component);
            }
        }
        let whole =
            |(node, (count, u, condition))| (count == components).then_some((node, u, condition));
        nodes.into_iter().filter_map(whole).collect()
    }

    /// Changes the predicted displacements `u` \[component of node\] \[m\] so that
    /// they meet the conditions of time `t` \[s\] (method book, eqs. 15.1 and 15.2),
    /// and calls `on_change(index, Δu)` for each changed entry. The multipliers m Δu
    /// \[kg·m\] are stored in `forces`.
    pub fn enforce(
        &self,
        t: f64,
        positions: &[Vector3],
        mass: &[f64],
        u: &mut [f64],
        forces: &mut ConstraintForces,
        on_change: impl FnMut(usize, f64),
    ) {
        let mut states = std::mem::take(&mut forces.states);
        states.clear();
        states.extend(self.conditions.iter().map(|condition| ConditionState::at(condition, t)));
        let target = |row: &ConstraintRow, component: usize| {
            let condition = row.condition as usize;
            let X = &positions[row.node as usize];
            states[condition].target(&self.conditions[condition].prescribed, row, X, component)
        };
        self.enforce_targets(t, mass, u, forces, target, on_change);
        forces.states = states;
    }

    /// Projects `u` onto the displacements that the conditions leave free: as
    /// [`Constraints::enforce`] with zero prescribed displacements.
    pub fn project(&self, t: f64, mass: &[f64], u: &mut [f64], forces: &mut ConstraintForces) {
        self.enforce_targets(t, mass, u, forces, |_, _| 0.0, |_, _| ());
    }

    pub(super) fn enforce_targets(
        &self,
        t: f64,
        mass: &[f64],
        u: &mut [f64],
        forces: &mut ConstraintForces,
        mut target: impl FnMut(&ConstraintRow, usize) -> f64,
        mut on_change: impl FnMut(usize, f64),
    ) {
        forces.stage = self.stage(t);
        let components = u.len() / mass.len();
        let sets = &self.stages[forces.stage].sets;
        forces.multipliers.resize_with(sets.len(), Vec::new);
        let mut multipliers = forces.multipliers.iter_mut();
        for alike in sets.chunk_by(ConstraintSet::has_nodes_of) {
            let values = &mut forces.values;
            values.clear();
            for set in alike {
                values.extend(set.rows.iter().map(|row| target(row, set.component)));
            }
            let field = Field { u, components, mass };
            match alike {
                [a, b, c] => field.take([a, b, c], values, &mut forces.scratch, &mut on_change),
                [a, b] => field.take([a, b], values, &mut forces.scratch, &mut on_change),
                [a] => field.take([a], values, &mut forces.scratch, &mut on_change),
                _ => unreachable!("a set for each component"),
            }
            for values in values.chunks(alike[0].rows.len()) {
                if let Some(multipliers) = multipliers.next() {
                    multipliers.clear();
                    multipliers.extend_from_slice(values);
                }
            }
        }
    }
}

/// A displacement field \[component of node\] \[m\] of nodes with masses \[kg\].
struct Field<'a> {
    u: &'a mut [f64],
    components: usize,
    mass: &'a [f64],
}

impl Field<'_> {
    /// Takes the values \[set\]\[row\] of sets with the same nodes, which become their multipliers.
    fn take<const K: usize>(
        self,
        sets: [&ConstraintSet; K],
        values: &mut [f64],
        scratch: &mut Scratch,
        on_change: &mut impl FnMut(usize, f64),
    ) {
        let Field { u, components, mass } = self;
        let offsets = sets.map(|set| set.component);
        let places = |node: u32| offsets.map(|offset| components * node as usize + offset);
        let Some(collocation) = &sets[0].collocation else {
            for (row, value) in sets[0].rows.iter().zip(values) {
                let place = places(row.node)[0];
                let delta = *value - u[place];
                u[place] = *value;
                *value = mass[row.node as usize] * delta;
                on_change(place, delta);
            }
            return;
        };
        collocation.solve(values, scratch, |node| places(node).map(|place| u[place]));
        collocation.corrections(mass, values, |node, deltas: [f64; K]| {
            for (place, delta) in places(node).into_iter().zip(deltas) {
                u[place] += delta;
                on_change(place, delta);
            }
        });
    }
}
