//! The lowest eigenpairs of a stiffness and a mass, by a block method.

use crate::algebra::packed::{axpy, combine, make_orthogonal, overlap};
use crate::algebra::random::noise;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Symmetric operators K and M on a space: K is positive there, M not negative.
pub(crate) trait Operators {
    /// Length of a vector.
    fn size(&self) -> usize;
    /// Dimension of the space.
    fn dimension(&self) -> usize;
    /// Takes out of a vector what is not in the space.
    fn project(&mut self, vector: &mut [f64]);
    /// K v.
    fn stiffness(&mut self, vector: &[f64]) -> Vec<f64>;
    /// M v.
    fn mass(&self, vector: &[f64]) -> Vec<f64>;
    /// About K⁻¹ r, of the space; `None` where the search is to end.
    fn solve(&mut self, residual: &[f64], found: usize) -> Option<Vec<f64>>;
}

/// An eigenvalue λ and its eigenvector.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    /// vᵀ K v.
    pub value: f64,
    /// v with vᵀ M v = 1.
    pub vector: Vec<f64>,
    /// √(rᵀ K⁻¹ r/λ) of r = K v − λ M v from products of its own \[–\]: some eigenvalue differs from
    /// λ by at most this part of itself.
    pub residual: f64,
}

/// Vectors beside the pairs that are asked for: with them these converge faster, and of equal
/// eigenvalues at the end of the row none is missed.
const BESIDE: usize = 4;
/// Vectors over those of the block at which the space is shortened to the block.
const LONGEST: usize = 4;
/// Random vectors with which pairs that were missed are looked for at the end, and how often
/// each is brought nearer to the lowest eigenvectors.
const LOOKS: (usize, usize) = (2, 2);
/// Times that all pairs are improved.
const MOST_ROUNDS: usize = 100;
/// Square of the part of a vector below which nothing of it is new \[–\].
const NOTHING: f64 = 1e-20;

/// The `count` lowest eigenpairs of K v = λ M v in ascending order, each to a residual of
/// `tolerance` unless the search ends before: Rayleigh and Ritz's method in a space that grows by
/// about K⁻¹ of each residual (Davidson 1975, with blocks and restarts; method book, eq. 30.3). A block of random
/// vectors has a part in every eigenvector, also of equal eigenvalues. `None` where a solution was
/// ended.
pub(crate) fn lowest_pairs(
    operators: &mut impl Operators,
    count: usize,
    tolerance: f64,
) -> Option<Vec<Pair>> {
    let block = (count + BESIDE).min(operators.dimension());
    let mut space = Space::default();
    let mut noise = noise();
    for _ in 0..block {
        let any: Vec<f64> = (0..operators.size()).map(|_| noise()).collect();
        space.look(operators, any, 1, 0)?;
    }
    // The values of pairs that were near enough.
    let mut near: Vec<f64> = vec![f64::INFINITY; count];
    let mut looked = false;
    for _ in 0..MOST_ROUNDS {
        let ritz = space.ritz(block);
        let is_open = |&i: &usize| near[i] - ritz.values[i] > tolerance * ritz.values[i];
        let open: Vec<usize> = (0..count).filter(is_open).collect();
        let found = count - open.len();
        if open.is_empty() && looked || space.basis.len() >= operators.dimension() {
            break;
        }
        let residuals: Vec<Vec<f64>> = open.par_iter().map(|&i| ritz.residual(&space, i)).collect();
        if space.basis.len() + open.len().max(LOOKS.0 * LOOKS.1) > LONGEST * block {
            space.shorten(&ritz);
        }
        let before = space.basis.len();
        for (i, residual) in open.iter().zip(residuals) {
            let change = operators.solve(&residual, found)?;
            let is_near = size(&residual, &change, ritz.values[*i]) <= tolerance;
            near[*i] = if is_near { ritz.values[*i] } else { f64::INFINITY };
            space.add(operators, change);
        }
        if open.is_empty() {
            looked = true;
            for _ in 0..LOOKS.0 {
                let any: Vec<f64> = (0..operators.size()).map(|_| noise()).collect();
                space.look(operators, any, LOOKS.1, found)?;
            }
        } else if space.basis.len() == before {
            break;
        }
    }
    let ritz = space.ritz(count);
    space.pairs(operators, &ritz)
}

/// √(rᵀ K⁻¹ r/λ) of a residual r and about K⁻¹ r (method book, eq. 30.4).
fn size(residual: &[f64], change: &[f64], value: f64) -> f64 {
    (overlap(residual, change) / value).abs().sqrt()
}

/// Vectors that are orthonormal in M, and what the operators make of them.
#[derive(Default)]
struct Space {
    basis: Vec<Vec<f64>>,
    stiffness: Vec<Vec<f64>>,
    mass: Vec<Vec<f64>>,
    /// The lower triangle of the products with K \[row\]\[column\].
    products: Vec<Vec<f64>>,
}

/// The lowest eigenpairs within a space.
struct Ritz {
    values: Vec<f64>,
    /// In the basis \[pair\].
    weights: Vec<Vec<f64>>,
}

impl Space {
    /// Brings a vector nearer to the lowest eigenvectors `times` times, and takes each step.
    fn look(
        &mut self,
        operators: &mut impl Operators,
        mut vector: Vec<f64>,
        times: usize,
        found: usize,
    ) -> Option<()> {
        for _ in 0..times {
            operators.project(&mut vector);
            make_orthogonal(&mut vector, &self.basis, &self.mass);
            vector = operators.solve(&operators.mass(&vector), found)?;
            self.add(operators, vector.clone());
        }
        Some(())
    }

    /// Takes what is new of a vector.
    fn add(&mut self, operators: &mut impl Operators, mut vector: Vec<f64>) {
        operators.project(&mut vector);
        let before = overlap(&vector, &operators.mass(&vector));
        make_orthogonal(&mut vector, &self.basis, &self.mass);
        // What a small rest has of the forbidden is round-off of the whole.
        operators.project(&mut vector);
        make_orthogonal(&mut vector, &self.basis, &self.mass);
        let mut mass = operators.mass(&vector);
        let square = overlap(&vector, &mass);
        if square.is_nan() || square <= NOTHING * before {
            return;
        }
        let length = square.sqrt();
        vector.iter_mut().chain(&mut mass).for_each(|x| *x /= length);
        let stiffness = operators.stiffness(&vector);
        self.basis.push(vector);
        self.products.push(self.basis.par_iter().map(|own| overlap(own, &stiffness)).collect());
        self.stiffness.push(stiffness);
        self.mass.push(mass);
    }

    fn ritz(&self, most: usize) -> Ritz {
        let n = self.basis.len();
        let form = DMatrix::from_fn(n, n, |i, j| self.products[i.max(j)][i.min(j)]);
        let eigen = form.symmetric_eigen();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        order.truncate(most);
        let weights = |&i: &usize| eigen.eigenvectors.column(i).iter().copied().collect();
        Ritz {
            values: order.iter().map(|&i| eigen.eigenvalues[i]).collect(),
            weights: order.iter().map(weights).collect(),
        }
    }

    /// Keeps the eigenvectors alone.
    fn shorten(&mut self, ritz: &Ritz) {
        for vectors in [&mut self.basis, &mut self.stiffness, &mut self.mass] {
            *vectors = ritz.weights.par_iter().map(|own| combine(vectors, own)).collect();
        }
        let row = |i: usize| {
            let mut row = vec![0.0; i];
            row.push(ritz.values[i]);
            row
        };
        self.products = (0..ritz.values.len()).map(row).collect();
    }

    /// The pairs, their values and residuals from products of their own.
    fn pairs(&self, operators: &mut impl Operators, ritz: &Ritz) -> Option<Vec<Pair>> {
        let pair = |weights: &Vec<f64>| {
            let mut vector = combine(&self.basis, weights);
            let mut mass = operators.mass(&vector);
            let length = overlap(&vector, &mass).sqrt();
            vector.iter_mut().chain(&mut mass).for_each(|x| *x /= length);
            let mut residual = operators.stiffness(&vector);
            let value = overlap(&vector, &residual);
            axpy(&mut residual, -value, &mass);
            let change = operators.solve(&residual, ritz.values.len())?;
            Some(Pair { value, residual: size(&residual, &change, value), vector })
        };
        let mut pairs: Vec<Pair> = ritz.weights.iter().map(pair).collect::<Option<_>>()?;
        pairs.sort_by(|a, b| a.value.total_cmp(&b.value));
        Some(pairs)
    }
}

impl Ritz {
    /// K v − λ M v of a pair.
    fn residual(&self, space: &Space, i: usize) -> Vec<f64> {
        let mut residual = combine(&space.stiffness, &self.weights[i]);
        axpy(&mut residual, -self.values[i], &combine(&space.mass, &self.weights[i]));
        residual
    }
}
