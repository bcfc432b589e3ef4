//! A symmetric matrix of blocks, one for each pair of functions.

use crate::algebra::tensor::{Matrix3, Vector3};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

/// The lower triangle, column by column of the functions.
#[derive(Clone)]
pub(super) struct CoarseMatrix {
    /// Components of a function.
    components: usize,
    /// (row, block) with rows from the column's own on, ascending \[column\].
    columns: Vec<Vec<(u32, Matrix3)>>,
}

impl CoarseMatrix {
    pub fn new(count: usize, components: usize) -> CoarseMatrix {
        CoarseMatrix { components, columns: vec![Vec::new(); count] }
    }

    /// Makes room for all pairs of some functions.
    pub fn reserve(&mut self, functions: &[u32]) {
        for &i in functions {
            functions.iter().filter(|&&j| i >= j).for_each(|&j| {
                self.block(i, j);
            });
        }
    }

    /// The block of row i and column j ≤ i.
    fn block(&mut self, i: u32, j: u32) -> &mut Matrix3 {
        let column = &mut self.columns[j as usize];
        let place = match column.binary_search_by_key(&i, |entry| entry.0) {
            Ok(place) => place,
            Err(place) => {
                column.insert(place, (i, Matrix3::zeros()));
                place
            }
        };
        &mut column[place].1
    }

    /// The energy μ (|Grad v|² + Grad v : Grad vᵀ)/2 + λ (div v)²/2 of a point, its moduli
    /// multiplied by its weight \[N·m\].
    pub fn add_elastic(&mut self, functions: &[(u32, Vector3)], shear: f64, lame: f64) {
        for (i, g) in functions {
            for (j, h) in functions.iter().filter(|(j, _)| i >= j) {
                let block = self.block(*i, *j);
                *block += lame * g * h.transpose() + shear * h * g.transpose();
                let product = shear * g.dot(h);
                (0..3).for_each(|k| block[(k, k)] += product);
            }
        }
    }

    /// The energy Σ_b modulus (m_b · v)²/2 with four moments m_b of each function.
    pub fn add_squares(&mut self, functions: &[(u32, [Vector3; 4])], modulus: f64) {
        for (i, moments) in functions {
            for (j, others) in functions.iter().filter(|(j, _)| i >= j) {
                let mut sum = Matrix3::zeros();
                for (g, h) in moments.iter().zip(others) {
                    sum += g * h.transpose();
                }
                *self.block(*i, *j) += modulus * sum;
            }
        }
    }

    /// A spring \[N/m\] along a unit vector at a place with some values of functions.
    pub fn add_spring(
        &mut self,
        functions: &[u32],
        values: &[f32],
        along: &Vector3,
        stiffness: f64,
    ) {
        let direction = stiffness * along * along.transpose();
        for (&i, &f) in functions.iter().zip(values) {
            for (&j, &g) in functions.iter().zip(values).filter(|(j, _)| i >= **j) {
                *self.block(i, j) += f64::from(f) * f64::from(g) * direction;
            }
        }
    }

    /// Number of functions.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Mean of the diagonal of a function's own block \[N/m\].
    pub fn mean_diagonal(&self, function: u32) -> f64 {
        let d = self.components;
        let own = self.columns[function as usize].first();
        own.map_or(0.0, |(_, block)| (0..d).map(|k| block[(k, k)]).sum::<f64>() / d as f64)
    }

    /// Adds to all components of a function \[N/m\].
    pub fn add_to_diagonal(&mut self, function: u32, stiffness: f64) {
        let block = self.block(function, function);
        (0..3).for_each(|k| block[(k, k)] += stiffness);
    }

    /// The lower triangle, component by component.
    pub fn assembled(&self) -> SparseColMat<usize, f64> {
        let d = self.components;
        let size = d * self.columns.len();
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for (column, blocks) in self.columns.iter().enumerate() {
            for l in 0..d {
                for (row, block) in blocks {
                    let first = if *row as usize == column { l } else { 0 };
                    rows.extend((first..d).map(|k| d * *row as usize + k));
                    values.extend((first..d).map(|k| block[(k, l)]));
                }
                starts.push(rows.len());
            }
        }
        let symbolic = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
        SparseColMat::new(symbolic, values)
    }
}
