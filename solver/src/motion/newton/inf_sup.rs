//! Whether the displacements of a cloud answer all pressures of its patches: the inf-sup value.
#![allow(non_snake_case)]

use super::free_space::FreeSpace;
use super::linear::{MOST_WITH_PRESSURES, Saddle, SaddlePatch, Solver, System};
use crate::algebra::packed::{axpy, dot, largest, normalise, orthogonalise};
use crate::algebra::random::noise;
use crate::force::{ModuliAtRest, OwnPressures, Workspace};
use crate::model::Model;
use crate::model::rigid_motions::free_rigid_motions;
use crate::motion::critical_time_step::largest_ritz_pair;
use crate::motion::tangent::Tangent;

/// Projected bulk modulus over the shear modulus that acts beside the pressures \[–\]: with it the
/// tangent at rest of a law with an isochoric part is 2 μ ε.
const SHEAR_ALONE: f64 = 2.0 / 3.0;
/// About how many shear moduli resist a change of volume in the Schur complement of a patch \[–\].
const RESISTS: f64 = 2.0;
/// Relative residual of each solution, in the norm of its preconditioner \[–\].
const FORCING: f64 = 1e-6;
/// Relative width of the interval for the eigenvalue \[–\].
const TOLERANCE: f64 = 0.02;
const FEWEST_STEPS: usize = 8;
const MOST_STEPS: usize = 40;
/// Free part of the forces of a constant pressure below which it is one that no displacement
/// answers, since the body is held all around \[–\].
const ENCLOSED: f64 = 0.02;
/// Part of a motion that is left where all of it is held, by round-off \[–\].
const STILL: f64 = 1e-9;

/// What a cloud does to the pressures of its patches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InfSup {
    /// β of (21.18) \[–\]; no more than this where it was not found to 1 %.
    pub value: f64,
    /// Whether it was found to 1 %.
    pub converged: bool,
    /// Pressures, four a patch in space and three in a plane.
    pub pressures: usize,
    /// Products with the tangent.
    pub products: usize,
}

/// The smallest β with β ‖p‖ ≤ sup_v ∫ p Div v dV/‖v‖ for all pressures p of the patches under the
/// conditions of t = 0, by Lanczos on the inverse of the Schur complement (method book, eq. 21.18).
/// `None` where no J is projected, or rigid motions are free.
pub fn inf_sup(model: &Model) -> Option<InfSup> {
    let rest = vec![0.0; model.size()];
    if free_rigid_motions(model, 0.0, &rest) > 0 {
        return None;
    }
    let mut workspace = Workspace::new(&model.points);
    let mut schur = Schur::new(model, &rest, &mut workspace)?;
    if !schur.moves() {
        let pressures = schur.pressures;
        return Some(InfSup { value: 0.0, converged: true, pressures, products: 0 });
    }
    let mut noise = noise();
    let mut first: Vec<f64> = schur.scales.iter().map(|_| noise()).collect();
    schur.mask(&mut first);
    normalise(&mut first);
    let mut basis = vec![first];
    let (mut diagonal, mut off_diagonal): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    loop {
        let last = basis.len() - 1;
        let mut next = schur.inverse_times(&basis[last]);
        diagonal.push(dot(&next, &basis[last]));
        orthogonalise(&mut next, &basis);
        let beta = dot(&next, &next).sqrt();
        let (ritz, weights) = largest_ritz_pair(&diagonal, &off_diagonal);
        let residual = beta * weights[last].abs();
        let steps = basis.len();
        let ended = beta <= 1e-12 * ritz || steps >= schur.pressures;
        let converged = ended || steps >= FEWEST_STEPS && residual <= TOLERANCE * ritz;
        if converged || steps >= MOST_STEPS || beta.is_nan() {
            let Schur { pressures, products, solved, .. } = schur;
            let (value, converged) = (ritz.sqrt().recip(), converged && solved);
            return Some(InfSup { value, converged, pressures, products });
        }
        next.iter_mut().for_each(|x| *x /= beta);
        off_diagonal.push(beta);
        basis.push(next);
    }
}

/// D s G A⁻¹ Gᵀ s D: A the tangent at rest, G the volumes of patches along displacements, D = √μ/s.
struct Schur<'a, 'w> {
    model: &'a Model,
    rest: &'a [f64],
    workspace: &'w mut Workspace,
    linear: Solver,
    free: FreeSpace<'a>,
    patches: Vec<SaddlePatch>,
    /// D \[√Pa\]; 0 of functions that no point sees.
    scales: Vec<f64>,
    /// A pressure that no displacement answers.
    enclosed: Option<Vec<f64>>,
    pressures: usize,
    products: usize,
    /// Whether all solutions have come to their residual.
    solved: bool,
}

impl<'a, 'w> Schur<'a, 'w> {
    fn new(model: &'a Model, rest: &'a [f64], workspace: &'w mut Workspace) -> Option<Self> {
        let (mut patches, mut scales, mut constant) = (Vec::new(), Vec::new(), Vec::new());
        for block in &model.points.blocks {
            let Some(projection) = &block.projection else { continue };
            let (moduli, s) = (ModuliAtRest::of(block), projection.fraction);
            let mu = moduli.shear;
            let is_projected = moduli.part_within(SHEAR_ALONE) < 1.0;
            for chunk in &block.chunks {
                let schur = s * s / (RESISTS * mu);
                patches.push(match is_projected {
                    true => SaddlePatch { fraction: s, compliance: 0.0, schur },
                    false => SaddlePatch { fraction: 0.0, compliance: 1.0, schur: 1.0 },
                });
                scales.extend([if is_projected { mu.sqrt() / s } else { 0.0 }; 4]);
                constant.extend([1.0 / projection.basis_at(chunk.lanes.start)[0], 0.0, 0.0, 0.0]);
            }
        }
        let mut schur = Schur {
            model,
            rest,
            workspace,
            linear: Solver::new(model, SHEAR_ALONE),
            free: FreeSpace::new(model, 0.0),
            patches,
            scales,
            enclosed: None,
            pressures: 0,
            products: 0,
            solved: true,
        };
        schur.leave_out_unseen();
        schur.pressures = schur.scales.iter().filter(|scale| **scale > 0.0).count();
        if schur.moves() {
            schur.find_enclosed(constant);
        }
        (schur.pressures > 0).then_some(schur)
    }

    /// Whether the conditions leave any motion free.
    fn moves(&mut self) -> bool {
        let mut noise = noise();
        let mut any: Vec<f64> = self.rest.iter().map(|_| noise()).collect();
        let all = largest(&any);
        self.free.project(&mut any);
        largest(&any) > STILL * all
    }

    /// Functions of a basis that are 0 at all points of their patch, as across a plane.
    fn leave_out_unseen(&mut self) {
        let mut noise = noise();
        let any: Vec<f64> = self.rest.iter().map(|_| noise()).collect();
        let none = vec![0.0; self.scales.len()];
        let (_, volumes) = at_rest(self.model, self.rest, self.workspace).saddle_times(&any, &none);
        let unseen = volumes.iter().map(|volume| *volume == 0.0);
        self.scales
            .iter_mut()
            .zip(unseen)
            .filter(|(_, unseen)| *unseen)
            .for_each(|(s, _)| *s = 0.0);
    }

    /// Finds out whether a constant pressure \[Pa·m^(3/2)\] has forces on what is free.
    fn find_enclosed(&mut self, constant: Vec<f64>) {
        let still = vec![0.0; self.rest.len()];
        let (forces, _) =
            at_rest(self.model, self.rest, self.workspace).saddle_times(&still, &constant);
        let all = self.model.accelerations(&forces);
        let mut free = all.clone();
        self.free.project(&mut free);
        if dot(&free, &free) <= ENCLOSED * ENCLOSED * dot(&all, &all) {
            let mut own: Vec<f64> = constant
                .iter()
                .zip(&self.scales)
                .map(|(p, d)| if *d > 0.0 { p / d } else { 0.0 })
                .collect();
            normalise(&mut own);
            // Constant but for round-off and what the gradients lack in consistency.
            let mut own = self.inverse_times(&own);
            normalise(&mut own);
            self.enclosed = Some(own);
        }
    }

    fn mask(&self, vector: &mut [f64]) {
        vector.iter_mut().zip(&self.scales).filter(|(_, d)| **d == 0.0).for_each(|(x, _)| *x = 0.0);
        if let Some(enclosed) = &self.enclosed {
            let part = dot(vector, enclosed);
            axpy(vector, -part, enclosed);
        }
    }

    /// The solution of the saddle system without compliance has the pressures −(s G A⁻¹ Gᵀ s)⁻¹ b.
    fn inverse_times(&mut self, vector: &[f64]) -> Vec<f64> {
        let mut right = vector.to_vec();
        self.mask(&mut right);
        let scaled = |(x, d): (&f64, &f64)| if *d > 0.0 { -x / d } else { 0.0 };
        let residual = right.iter().zip(&self.scales).map(scaled).collect();
        let (size, saddle) = (self.rest.len(), Saddle { residual, patches: self.patches.clone() });
        let tangent = at_rest(self.model, self.rest, self.workspace);
        let system = System {
            tangent,
            residual: vec![0.0; size],
            change: vec![0.0; size],
            forcing: FORCING,
            sliding: Vec::new(),
            shift: 0.0,
            guide: None,
            saddle: Some(saddle),
        };
        let solution = self.linear.solve(self.model, &mut self.free, system, &mut || true);
        self.products += solution.products;
        self.solved &= solution.products < MOST_WITH_PRESSURES;
        let unscaled = |(q, d): (&f64, &f64)| if *d > 0.0 { q / d } else { 0.0 };
        let mut image: Vec<f64> =
            solution.pressures.iter().zip(&self.scales).map(unscaled).collect();
        self.mask(&mut image);
        image
    }
}

/// The tangent A.
fn at_rest<'a>(model: &'a Model, rest: &'a [f64], workspace: &'a mut Workspace) -> Tangent<'a> {
    let own = OwnPressures::zero(&model.points, SHEAR_ALONE);
    Tangent::new(model, rest, 0.0, workspace).with_pressures(Some(own))
}
