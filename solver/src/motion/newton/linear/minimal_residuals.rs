//! Corrections of displacements and pressures together, by minimal residuals.

use super::conjugate_gradients::Solver;
use super::system::{Correction, Saddle, SaddlePatch, System};
use crate::algebra::packed::{axpy, dot, largest};
use crate::model::Model;
use crate::motion::newton::free_space::FreeSpace;

/// Iterations after which a correction is taken as it is.
pub(crate) const MOST: usize = 1000;

impl Solver {
    /// MINRES (Paige, Saunders 1975) with the preconditioner of displacements and the Schur
    /// complements of patches, while `go_on` says so.
    pub(super) fn solve_saddle(
        &mut self,
        model: &Model,
        free: &mut FreeSpace,
        mut system: System,
        Saddle { residual: gaps, patches }: Saddle,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Correction {
        self.prepare(free, system.shift);
        let size = model.size();
        let mut solution = std::mem::take(&mut system.change);
        solution.resize(size + gaps.len(), 0.0);
        let mut residual = std::mem::take(&mut system.residual);
        residual.extend(gaps);
        let forcing = system.forcing;
        let start = solution.clone();
        let mut stopped = false;
        let (mut right, mut products) =
            self.right_side(model, &mut system, &patches, (residual, &start));
        let first = self.both_preconditioned(model, free, &patches, &mut right);
        let mut lanczos = Recurrence::new(right.clone(), first);
        let mut target = forcing * lanczos.left.abs();
        while products < MOST {
            stopped = !go_on();
            let left = lanczos.left.abs();
            if stopped || left.is_nan() || left <= target || lanczos.norm <= f64::MIN_POSITIVE {
                break;
            }
            lanczos.normalise();
            let mut next =
                system.saddle_times(model, &self.at_rest.diagonal, &patches, &lanczos.descent);
            products += 1;
            let diagonal = lanczos.orthogonalise(&mut next);
            let descent = self.both_preconditioned(model, free, &patches, &mut next);
            lanczos.advance(diagonal, next, descent, &mut solution);
            if self.count(model, free, &mut system) {
                let way: Vec<f64> = solution.iter().zip(&start).map(|(a, b)| a - b).collect();
                let of = (&patches[..], &right[..], &way[..]);
                let whole;
                (lanczos, whole) = self.started_again(model, free, &mut system, of);
                target = forcing * whole;
                products += 1;
            }
        }
        let step: Vec<f64> = solution.iter().zip(&start).map(|(a, b)| a - b).collect();
        let curvature = curvature(size, &step, &right, &patches);
        if curvature < 0.0 {
            self.factors.leave();
        }
        let pressures = solution.split_off(size);
        Correction {
            change: solution,
            pressures,
            fluids: Vec::new(),
            indefinite: curvature < 0.0,
            products,
            of_factors: self.factors.take_cost(),
            stopped,
        }
    }

    /// What a start \[m\] leaves of the right side, and the products that took.
    fn right_side(
        &self,
        model: &Model,
        system: &mut System,
        patches: &[SaddlePatch],
        (mut residual, start): (Vec<f64>, &[f64]),
    ) -> (Vec<f64>, usize) {
        if largest(start) == 0.0 {
            return (residual, 0);
        }
        let product = system.saddle_times(model, &self.at_rest.diagonal, patches, start);
        axpy(&mut residual, -1.0, &product);
        (residual, 1)
    }

    /// The recurrence for what a way \[m\] has left of the right side, and the norm of the whole of it,
    /// with what preconditions now.
    fn started_again(
        &mut self,
        model: &Model,
        free: &mut FreeSpace,
        system: &mut System,
        (patches, right, way): (&[SaddlePatch], &[f64], &[f64]),
    ) -> (Recurrence, f64) {
        let whole = self.both_preconditioned(model, free, patches, &mut right.to_vec());
        let whole = dot(right, &whole).max(0.0).sqrt();
        let mut rest = right.to_vec();
        let product = system.saddle_times(model, &self.at_rest.diagonal, patches, way);
        axpy(&mut rest, -1.0, &product);
        let descent = self.both_preconditioned(model, free, patches, &mut rest);
        (Recurrence::new(rest, descent), whole)
    }

    /// Of displacements and pressures; what is held leaves `residual`.
    fn both_preconditioned(
        &mut self,
        model: &Model,
        free: &mut FreeSpace,
        patches: &[SaddlePatch],
        residual: &mut [f64],
    ) -> Vec<f64> {
        let (forces, gaps) = residual.split_at_mut(model.size());
        let mut descent = self.preconditioned(model, free, forces);
        let rows = patches.iter().zip(gaps.as_chunks::<4>().0);
        descent.extend(rows.flat_map(|(patch, gaps)| gaps.map(|gap| gap / patch.schur)));
        descent
    }
}

/// Δuᵀ K Δu of the solution of (K Δu + s Gᵀ q, s G Δu − S q) = (r, b).
fn curvature(size: usize, step: &[f64], right: &[f64], patches: &[SaddlePatch]) -> f64 {
    let (u, q) = step.split_at(size);
    let (r, b) = right.split_at(size);
    let stored: f64 = patches
        .iter()
        .zip(q.as_chunks::<4>().0)
        .map(|(patch, q)| patch.compliance * dot(q, q))
        .sum();
    dot(u, r) - dot(q, b) - stored
}

/// The three-term recurrences of Lanczos' vectors and of the directions.
struct Recurrence {
    /// The last two vectors of the residual, and the preconditioned last one.
    vectors: [Vec<f64>; 2],
    descent: Vec<f64>,
    directions: [Vec<f64>; 2],
    /// Norms of the last two vectors.
    norm: f64,
    norm_before: f64,
    /// Signed norm of the residual.
    left: f64,
    /// Cosine and sine of the last two rotations.
    rotations: [(f64, f64); 2],
}

impl Recurrence {
    fn new(residual: Vec<f64>, descent: Vec<f64>) -> Recurrence {
        let norm = dot(&residual, &descent).max(0.0).sqrt();
        let zeros = || vec![0.0; residual.len()];
        Recurrence {
            directions: [zeros(), zeros()],
            vectors: [zeros(), residual],
            descent,
            norm,
            norm_before: 1.0,
            left: norm,
            rotations: [(1.0, 0.0); 2],
        }
    }

    fn normalise(&mut self) {
        let norm = self.norm;
        self.descent.iter_mut().for_each(|z| *z /= norm);
    }

    /// Takes the last two vectors out of a product with the last one; returns the diagonal.
    fn orthogonalise(&self, product: &mut [f64]) -> f64 {
        let diagonal = dot(product, &self.descent);
        axpy(product, -diagonal / self.norm, &self.vectors[1]);
        axpy(product, -self.norm / self.norm_before, &self.vectors[0]);
        diagonal
    }

    /// Goes one step, and the solution with it.
    fn advance(
        &mut self,
        diagonal: f64,
        vector: Vec<f64>,
        descent: Vec<f64>,
        solution: &mut [f64],
    ) {
        let norm = dot(&vector, &descent).max(0.0).sqrt();
        let [(cosine_before, sine_before), (cosine, sine)] = self.rotations;
        let upper = cosine * diagonal - cosine_before * sine * self.norm;
        let length = upper.hypot(norm);
        let factors =
            [sine_before * self.norm, sine * diagonal + cosine_before * cosine * self.norm];
        let [mut direction, last] = std::mem::take(&mut self.directions);
        for ((w, z), last) in direction.iter_mut().zip(&self.descent).zip(&last) {
            *w = (z - factors[0] * *w - factors[1] * last) / length;
        }
        let rotation = (upper / length, norm / length);
        axpy(solution, rotation.0 * self.left, &direction);
        self.left *= -rotation.1;
        self.directions = [last, direction];
        let [_, before] = std::mem::take(&mut self.vectors);
        self.vectors = [before, vector];
        self.descent = descent;
        (self.norm_before, self.norm) = (self.norm, norm);
        self.rotations = [(cosine, sine), rotation];
    }
}
