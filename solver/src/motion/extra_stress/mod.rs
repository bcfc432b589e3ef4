//! Stresses beside those of the laws: what viscosity remembers, what active fibres pull with, and
//! the work of both.
#![allow(non_snake_case)]

use crate::algebra::lanes::{LANES, SimdBlock};
use crate::force::{
    Block, ENTRIES, ExtraStress, Found, Symmetric, Workspace, deformation_gradients,
};
use crate::material::PronySeries;
use crate::model::Model;

/// Extra stresses of all blocks at the last time that was remembered; nothing where no material
/// has any.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub struct ExtraState {
    blocks: Vec<Option<BlockState>>,
    /// From the time that is remembered to that of the forces to come \[s\].
    pub(crate) interval: f64,
}

#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct BlockState {
    /// H_i of each term of the Prony series (method book, eq. 3.24) \[term\]\[SIMD block\] \[Pa\].
    branches: Vec<Vec<Symmetric>>,
    /// What the forces were computed from then.
    before: Vec<Found>,
    /// T_a then \[Pa\].
    tension: f64,
}

impl BlockState {
    /// At rest.
    fn new(block: &Block) -> BlockState {
        let (groups, one) = (block.groups(), SimdBlock([1.0; LANES]));
        let mut rest = Found::default();
        rest.right_cauchy_green[..3].fill(one);
        let terms = block.viscosity.as_ref().map_or(0, |series| series.terms().len());
        BlockState {
            branches: vec![vec![Symmetric::default(); groups]; terms],
            before: vec![rest; groups],
            tension: 0.0,
        }
    }

    /// Σ_i g_i H_i + T_a f ⊗ f at a SIMD block, the stress that does the work of
    /// [`ExtraState::remember`].
    fn stress(&self, block: &Block, group: usize, tension: f64) -> Symmetric {
        let mut sum = active(block, group, tension);
        for (term, branch) in terms(block).zip(&self.branches) {
            add(&mut sum, term.g, &branch[group]);
        }
        sum
    }
}

fn terms(block: &Block) -> impl Iterator<Item = &crate::material::PronyTerm> {
    block.viscosity.as_ref().map_or(&[][..], PronySeries::terms).iter()
}

/// T_a at time `t` \[s\] \[Pa\].
fn tension(block: &Block, t: f64) -> f64 {
    block.active.as_ref().map_or(0.0, |active| active.tension * active.amplitude.at(t))
}

/// T f ⊗ f of the fibres at a SIMD block.
fn active(block: &Block, group: usize, tension: f64) -> Symmetric {
    let mut sum = Symmetric::default();
    if block.active.is_some() {
        let frame = &block.frames[group];
        for (entry, (i, j)) in sum.iter_mut().zip(ENTRIES) {
            for lane in 0..LANES {
                entry.0[lane] = tension * frame[3 * i].0[lane] * frame[3 * j].0[lane];
            }
        }
    }
    sum
}

/// Adds `factor` times a tensor.
fn add(sum: &mut Symmetric, factor: f64, tensor: &Symmetric) {
    for (sum, entry) in sum.iter_mut().zip(tensor) {
        sum.0.iter_mut().zip(entry.0).for_each(|(sum, value)| *sum += factor * value);
    }
}

/// ½ A : (B − C) at each point of a SIMD block; off the diagonal every entry counts twice.
fn work(stress: &Symmetric, after: &Symmetric, before: &Symmetric) -> [f64; LANES] {
    let mut sums = [0.0; LANES];
    for n in 0..6 {
        let factor = if n < 3 { 0.5 } else { 1.0 };
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += factor * stress[n].0[lane] * (after[n].0[lane] - before[n].0[lane]);
        }
    }
    sums
}

/// Σ_q w_q of values at a SIMD block of a block.
fn weighted(block: &Block, group: usize, values: [f64; LANES]) -> f64 {
    let weights = &block.quadrature_weights[LANES * group..LANES * (group + 1)];
    weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
}

impl ExtraState {
    /// Of a body at rest.
    pub fn new(model: &Model) -> ExtraState {
        if !model.has_extra_stress() {
            return ExtraState::default();
        }
        let state = |block: &Block| block.has_extra_stress().then(|| BlockState::new(block));
        ExtraState { blocks: model.points.blocks.iter().map(state).collect(), interval: 0.0 }
    }

    /// As of [`State`](crate::motion::state::State::misfit).
    pub(crate) fn misfit(&self, model: &Model) -> Option<(usize, usize)> {
        let sizes = |state: &ExtraState| -> Vec<(usize, usize)> {
            let size = |b: &BlockState| (b.before.len(), b.branches.iter().map(Vec::len).sum());
            state.blocks.iter().map(|b| b.as_ref().map_or((0, 0), size)).collect()
        };
        let (found, needed) = (sizes(self), sizes(&ExtraState::new(model)));
        let sum = |sizes: &[(usize, usize)]| sizes.iter().map(|(a, b)| a + b).sum();
        (found != needed).then(|| (sum(&found), sum(&needed)))
    }

    /// Has the extra stresses of time `t` \[s\] act in forces and products to come: in the interval
    /// since what is remembered the isochoric stress is taken to grow by equal parts (method book,
    /// eq. 3.25).
    pub fn act(&self, model: &Model, t: f64, workspace: &mut Workspace) {
        self.act_with(model, |block| tension(block, t), workspace);
    }

    /// As [`ExtraState::act`] with the largest tension that active fibres have at any time from `t`
    /// \[s\] on, for a time step that is stable with all of them.
    pub fn act_at_most(&self, model: &Model, t: f64, workspace: &mut Workspace) {
        let largest = |block: &Block| {
            let Some(active) = &block.active else { return 0.0 };
            let corners = active.amplitude.corners();
            let later = corners.into_iter().filter(|corner| *corner > t).chain([t]);
            later.map(|time| tension(block, time)).fold(f64::NEG_INFINITY, f64::max)
        };
        self.act_with(model, largest, workspace);
    }

    fn act_with(&self, model: &Model, tension: impl Fn(&Block) -> f64, workspace: &mut Workspace) {
        let interval = self.interval;
        for (index, (block, state)) in model.points.blocks.iter().zip(&self.blocks).enumerate() {
            let (Some(state), Some(extra)) = (state, workspace.extra(index)) else { continue };
            let tension = tension(block);
            let decay = || terms(block).map(|term| (term, term.left_after(interval)));
            extra.relaxed = decay().map(|(term, (_, mean))| term.g * (1.0 - mean)).sum();
            let ExtraStress { stress, .. } = extra;
            for (group, sum) in stress.iter_mut().enumerate() {
                *sum = active(block, group, tension);
                for ((term, (left, mean)), branch) in decay().zip(&state.branches) {
                    add(sum, term.g * left, &branch[group]);
                    add(sum, -term.g * mean, &state.before[group].isochoric);
                }
            }
        }
    }

    /// Remembers the state that the last forces were computed from, under [`ExtraState::act`] of
    /// the same time. Returns the work done against viscous branches, and by active fibres with the
    /// other sign, since what was remembered before \[J\].
    pub fn remember(&mut self, model: &Model, t: f64, workspace: &mut Workspace) -> f64 {
        let interval = std::mem::take(&mut self.interval);
        let mut total = 0.0;
        for (index, (block, state)) in model.points.blocks.iter().zip(&mut self.blocks).enumerate()
        {
            let (Some(state), Some(extra)) = (state, workspace.extra(index)) else { continue };
            let tension = tension(block, t);
            for (group, found) in extra.found.iter().enumerate() {
                let was = state.stress(block, group, state.tension);
                let before = state.before[group];
                for (term, branch) in terms(block).zip(&mut state.branches) {
                    let (left, mean) = term.left_after(interval);
                    let mut grown = Symmetric::default();
                    add(&mut grown, left, &branch[group]);
                    add(&mut grown, mean, &found.isochoric);
                    add(&mut grown, -mean, &before.isochoric);
                    branch[group] = grown;
                }
                let mut mean = Symmetric::default();
                add(&mut mean, 0.5, &was);
                add(&mut mean, 0.5, &state.stress(block, group, tension));
                let done = work(&mean, &found.right_cauchy_green, &before.right_cauchy_green);
                total += weighted(block, group, done);
                state.before[group] = *found;
            }
            state.tension = tension;
        }
        total
    }

    /// Work \[J\] as of [`ExtraState::remember`] from what is remembered to displacements `u` \[m\],
    /// with the stresses that are remembered.
    pub fn work_towards(&self, model: &Model, u: &[f64]) -> f64 {
        let mut total = 0.0;
        for (block, state) in model.points.blocks.iter().zip(&self.blocks) {
            let Some(state) = state else { continue };
            let mut now = vec![Symmetric::default(); block.groups()];
            deformation_gradients(&model.points, block, u, |lane, F| {
                let C = F.transpose() * F;
                for (entry, place) in now[lane / LANES].iter_mut().zip(ENTRIES) {
                    entry.0[lane % LANES] = C[place];
                }
            });
            for (group, now) in now.iter().enumerate() {
                let stress = state.stress(block, group, state.tension);
                let before = &state.before[group].right_cauchy_green;
                total += weighted(block, group, work(&stress, now, before));
            }
        }
        total
    }

    /// What is added to the second Piola–Kirchhoff stress of the laws, as it is remembered \[point\]
    /// \[xx, yy, zz, xy, yz, xz\] \[Pa\]; nothing where no material has any.
    pub fn stresses(&self, model: &Model) -> Vec<[f64; 6]> {
        if self.blocks.is_empty() {
            return Vec::new();
        }
        let mut stresses = vec![[0.0; 6]; model.point_positions.len()];
        for (block, state) in model.points.blocks.iter().zip(&self.blocks) {
            let Some(state) = state else { continue };
            let relaxing = block.viscosity.as_ref().map_or(0.0, PronySeries::relaxing);
            for lane in block.occupied() {
                let group = lane / LANES;
                let mut sum = state.stress(block, group, state.tension);
                add(&mut sum, -relaxing, &state.before[group].isochoric);
                stresses[block.point(lane)] = sum.map(|entry| entry.0[lane % LANES]);
            }
        }
        stresses
    }
}
