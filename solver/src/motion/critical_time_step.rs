//! The largest stable step of the tangent operator, by Lanczos.
#![allow(non_snake_case)]

use crate::algebra::packed::{axpy, combine, dot, norm, normalise, orthogonalise};
use crate::algebra::random::noise;
use crate::force::Workspace;
use crate::model::Model;
use crate::motion::tangent::Tangent;

/// The critical step and what it cost.
#[derive(Debug, Clone, PartialEq)]
pub struct CriticalStep {
    /// 2/√λ with λ the upper end of the interval that holds the largest
    /// eigenvalue \[s\].
    pub time_step: f64,
    /// Products with the tangent operator; each is one evaluation of the
    /// internal force, and one more is needed for all.
    pub products: usize,
    /// The mode found, M^(1/2) u with norm 1 \[component of node\].
    pub mode: Vec<f64>,
    /// The stiffest motion of every neighbourhood, as large everywhere, M^(1/2) u
    /// \[component of node\]: where [`local_growth`] starts from.
    pub pattern: Vec<f64>,
}

/// Relative width of the interval for the largest eigenvalue \[–\].
const EIGENVALUE_TOLERANCE: f64 = 5e-3;
const MOST_PRODUCTS: usize = 80;
/// Products after which the start of a Lanczos run shows the stiffest pattern
/// of every neighbourhood.
const PATTERN_POWER: usize = 18;
/// Fewest products from a random start, and from what an earlier run has left.
/// A small residual only tells that some eigenvalue is near; from a random
/// start the largest of n is missed by more than a fraction ε with a probability
/// below 1.648 √n exp(−(2k − 1)√ε) after k products (Kuczyński, Woźniakowski
/// 1992): one per cent for n = 10⁴, ε = 6 % and k = 20. The levelled pattern of
/// an earlier run holds the stiffest motion of every neighbourhood, and few
/// products suffice (study "time_step" compares with runs from random starts).
const FEWEST_PRODUCTS: usize = 20;
const FEWEST_PRODUCTS_KNOWN: usize = 8;

/// The stable limit 2/√λ_max(M⁻¹K) of the tangent operator at displacements
/// `u` \[m\] under the conditions of time `t` \[s\], by Lanczos with full
/// reorthogonalisation on M^(−1/2) K M^(−1/2). The returned step belongs to
/// the Ritz value plus its residual, which is the safe side unless a mode was
/// missed (study "time_step" measures how often, on random small bodies). Where the
/// conditions leave nothing free until a release, the step is that after it: no step
/// would be too long for a body without freedom, and it would pass over the release.
pub fn critical_time_step(
    model: &Model,
    u: &[f64],
    t: f64,
    earlier: Option<&CriticalStep>,
    workspace: &mut Workspace,
) -> CriticalStep {
    let mut tangent = Tangent::new(model, u, decisive_time(model, t), workspace);
    let mut basis = vec![starting_vector(&mut tangent, earlier)];
    let fewest = if earlier.is_some() { FEWEST_PRODUCTS_KNOWN } else { FEWEST_PRODUCTS };
    let (mut diagonal, mut off_diagonal): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    loop {
        let last = basis.len() - 1;
        let mut next = tangent.apply(&basis[last]);
        diagonal.push(dot(&next, &basis[last]));
        orthogonalise(&mut next, &basis);
        let beta = norm(&next);
        let (ritz, weights) = largest_ritz_pair(&diagonal, &off_diagonal);
        let residual = beta * weights[last].abs();
        let products = basis.len();
        let exhausted = products >= MOST_PRODUCTS.min(tangent.free_size());
        let converged = products >= fewest && residual <= EIGENVALUE_TOLERANCE * ritz;
        // The Krylov space ends where beta is nothing but round-off.
        let ended = beta.is_nan() || beta <= 1e-12 * ritz;
        if converged || exhausted || ended {
            let mode = combine(&basis, &weights);
            let time_step = 2.0 / (ritz + residual).sqrt();
            let pattern = pattern(model, &basis, &diagonal, &off_diagonal);
            return CriticalStep { time_step, products, mode, pattern };
        }
        next.iter_mut().for_each(|x| *x /= beta);
        off_diagonal.push(beta);
        basis.push(next);
    }
}

/// The largest local growth \[1/s²\] of a product with the tangent at
/// displacements `u` \[m\]: the largest, over all neighbourhoods, of the size of
/// the image over the size of `pattern`. The pattern is replaced by its image,
/// brought to the same size everywhere: power iteration in all neighbourhoods at
/// once, so that one product sees the body stiffen wherever it does.
pub fn local_growth(
    model: &Model,
    u: &[f64],
    t: f64,
    pattern: &mut Vec<f64>,
    workspace: &mut Workspace,
) -> f64 {
    let mut tangent = Tangent::new(model, u, decisive_time(model, t), workspace);
    let before = local_squares(model, pattern);
    let image = tangent.apply(pattern);
    let after = local_squares(model, &image);
    let growth = before.iter().zip(&after).filter(|(b, _)| **b > 0.0).map(|(b, a)| a / b);
    let largest = growth.fold(0.0, f64::max).sqrt();
    *pattern = image;
    level(model, pattern, &after);
    largest
}

/// The time \[s\] under whose conditions a step from `t` has to be stable: where they leave
/// nothing free at `t`, the first release after it that frees something.
fn decisive_time(model: &Model, t: f64) -> f64 {
    let constraints = &model.constraints;
    let frees_some = |t: &f64| constraints.count(*t) < model.size();
    if frees_some(&t) {
        return t;
    }
    let releases = constraints.conditions.iter().filter_map(|condition| condition.release);
    let first = releases.filter(|release| *release > t && frees_some(release)).reduce(f64::min);
    first.unwrap_or(t)
}

/// Mean square of a field over the supports of the points around each node.
fn local_squares(model: &Model, field: &[f64]) -> Vec<f64> {
    let d = model.components;
    let square = |node: u32| -> f64 {
        field[d * node as usize..d * (node as usize + 1)].iter().map(|x| x * x).sum()
    };
    let mut sums = vec![(0.0, 0.0); model.positions.len()];
    for block in &model.points.blocks {
        for lane in block.occupied() {
            let nodes = || block.support_nodes(lane, d).map(|local| block.nodes[local]);
            let mean = nodes().map(square).sum::<f64>() / nodes().count() as f64;
            for node in nodes() {
                let (sum, count) = &mut sums[node as usize];
                (*sum, *count) = (*sum + mean, *count + 1.0);
            }
        }
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// Scales a field by its local size.
fn level(model: &Model, field: &mut [f64], squares: &[f64]) {
    for (values, square) in field.chunks_exact_mut(model.components).zip(squares) {
        if *square > 0.0 {
            values.iter_mut().for_each(|x| *x /= square.sqrt());
        }
    }
}

/// Noise, or the last mode and pattern in equal parts with a little of it.
fn starting_vector(tangent: &mut Tangent, earlier: Option<&CriticalStep>) -> Vec<f64> {
    let mut noise = noise();
    let mut vector: Vec<f64> = tangent.root_mass.iter().map(|_| noise()).collect();
    normalise(&mut vector);
    if let Some(CriticalStep { mode, pattern, .. }) = earlier {
        vector.iter_mut().for_each(|x| *x *= 0.1);
        for known in [mode, pattern] {
            axpy(&mut vector, 1.0 / norm(known).max(f64::MIN_POSITIVE), known);
        }
    }
    tangent.project(&mut vector);
    normalise(&mut vector);
    vector
}

/// Largest eigenvalue of the tridiagonal matrix and its unit eigenvector.
pub(super) fn largest_ritz_pair(diagonal: &[f64], off_diagonal: &[f64]) -> (f64, Vec<f64>) {
    let n = diagonal.len();
    let matrix = nalgebra::DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off_diagonal[i.min(j)],
        _ => 0.0,
    });
    let eigen = matrix.symmetric_eigen();
    let top = eigen.eigenvalues.imax();
    (eigen.eigenvalues[top], eigen.eigenvectors.column(top).iter().copied().collect())
}

/// The start after [`PATTERN_POWER`] products, from the Krylov space alone:
/// A^k v₀ = V T^k e₁, levelled.
fn pattern(model: &Model, basis: &[Vec<f64>], diagonal: &[f64], off_diagonal: &[f64]) -> Vec<f64> {
    let n = basis.len();
    let mut weights = vec![0.0; n];
    weights[0] = 1.0;
    for _ in 0..PATTERN_POWER.min(n - 1) {
        let image = |i: usize| {
            let below = if i > 0 { off_diagonal[i - 1] * weights[i - 1] } else { 0.0 };
            let above = if i + 1 < n { off_diagonal[i] * weights[i + 1] } else { 0.0 };
            diagonal[i] * weights[i] + below + above
        };
        weights = (0..n).map(image).collect();
        normalise(&mut weights);
    }
    let mut field = combine(basis, &weights);
    let squares = local_squares(model, &field);
    level(model, &mut field, &squares);
    field
}
