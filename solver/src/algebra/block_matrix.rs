//! A symmetric matrix of blocks, one for each pair of functions.

use crate::algebra::tensor::{Matrix3, Vector3, vector_at};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

/// ∂P_ij/∂F_kl \[3 k + l\]\[3 i + j\] of a point.
pub type PointTangent = [[f64; 9]; 9];

/// The lower triangle, column by column of the functions.
#[derive(Debug, Clone)]
pub(crate) struct BlockMatrix {
    /// Components of a function.
    components: usize,
    columns: Vec<Column>,
}

/// Rows from the column's own on, ascending, and their blocks.
#[derive(Debug, Clone, Default)]
struct Column {
    rows: Vec<u32>,
    blocks: Vec<Matrix3>,
}

impl Column {
    /// The block of a row that comes at a place or after it; moves the place there.
    fn block_from(&mut self, place: &mut usize, row: u32) -> &mut Matrix3 {
        while self.rows.get(*place).is_some_and(|at| *at < row) {
            *place += 1;
        }
        if self.rows.get(*place) != Some(&row) {
            self.rows.insert(*place, row);
            self.blocks.insert(*place, Matrix3::zeros());
        }
        &mut self.blocks[*place]
    }

    fn block(&mut self, row: u32) -> &mut Matrix3 {
        let mut place = self.rows.partition_point(|at| *at < row);
        self.block_from(&mut place, row)
    }
}

impl BlockMatrix {
    pub fn new(count: usize, components: usize) -> BlockMatrix {
        BlockMatrix { components, columns: vec![Column::default(); count] }
    }

    /// All entries become 0, and stay.
    pub fn clear(&mut self) {
        self.columns.iter_mut().for_each(|column| column.blocks.fill(Matrix3::zeros()));
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
        self.columns[j as usize].block(i)
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

    /// ∂P/∂F of a point, multiplied by its weight \[N·m\]; functions ascend.
    pub fn add_tangent(&mut self, functions: &[(u32, Vector3)], tangent: &PointTangent) {
        for (first, (j, h)) in functions.iter().enumerate() {
            // ∂P_ij/∂v_k along the gradient of the column's function.
            let mut slopes = [[0.0; 9]; 3];
            for (k, slopes) in slopes.iter_mut().enumerate() {
                for l in 0..3 {
                    let entries = &tangent[3 * k + l];
                    slopes.iter_mut().zip(entries).for_each(|(sum, entry)| *sum += h[l] * entry);
                }
            }
            let (column, mut place) = (&mut self.columns[*j as usize], 0);
            for (i, g) in &functions[first..] {
                let block = column.block_from(&mut place, *i);
                for (k, slopes) in slopes.iter().enumerate() {
                    for i in 0..3 {
                        let row = [slopes[3 * i], slopes[3 * i + 1], slopes[3 * i + 2]];
                        block[(i, k)] += row[0] * g.x + row[1] * g.y + row[2] * g.z;
                    }
                }
            }
        }
    }

    /// Adds a block for each pair of some functions, which ascend, of a symmetric matrix.
    pub fn add_pairs<T>(&mut self, functions: &[(u32, T)], block: impl Fn(&T, &T) -> Matrix3) {
        for (first, (j, h)) in functions.iter().enumerate() {
            let (column, mut place) = (&mut self.columns[*j as usize], 0);
            for (i, g) in &functions[first..] {
                *column.block_from(&mut place, *i) += block(g, h);
            }
        }
    }

    /// Adds another matrix of as many functions, times a factor.
    pub fn add(&mut self, other: &BlockMatrix, factor: f64) {
        for (column, other) in self.columns.iter_mut().zip(&other.columns) {
            let mut place = 0;
            for (row, block) in other.rows.iter().zip(&other.blocks) {
                *column.block_from(&mut place, *row) += factor * block;
            }
        }
    }

    /// Adds the product with a vector.
    pub fn add_times(&self, vector: &[f64], product: &mut [f64]) {
        let d = self.components;
        for (j, column) in self.columns.iter().enumerate() {
            let own = vector_at(vector, j, d);
            let mut sum = Vector3::zeros();
            for (row, block) in column.rows.iter().zip(&column.blocks) {
                let row = *row as usize;
                let other = block * own;
                (0..d).for_each(|k| product[d * row + k] += other[k]);
                if row != j {
                    sum += block.tr_mul(&vector_at(vector, row, d));
                }
            }
            (0..d).for_each(|k| product[d * j + k] += sum[k]);
        }
    }

    /// The energy Σ_bc H_bc (m_b · v) (m_c · v)/2 with four moments m of each function;
    /// functions ascend.
    pub fn add_squares(&mut self, functions: &[(u32, [Vector3; 4])], moduli: &[[f64; 4]; 4]) {
        let stiff = |moments: &[Vector3; 4]| -> [Vector3; 4] {
            moduli.map(|row| row.iter().zip(moments).map(|(h, m)| *h * m).sum())
        };
        let with_stiff = |(number, m): &(u32, [Vector3; 4])| (*number, (*m, stiff(m)));
        let both: Vec<_> = functions.iter().map(with_stiff).collect();
        self.add_pairs(&both, |(moments, _), (_, stiff)| {
            moments.iter().zip(stiff).map(|(g, h)| g * h.transpose()).sum()
        });
    }

    /// A spring \[N/m\] along a unit vector at a place with some values of functions.
    pub fn add_spring<F: Copy + Into<f64>>(
        &mut self,
        functions: &[u32],
        values: &[F],
        along: &Vector3,
        stiffness: f64,
    ) {
        let direction = stiffness * along * along.transpose();
        for (&i, &f) in functions.iter().zip(values) {
            for (&j, &g) in functions.iter().zip(values).filter(|(j, _)| i >= **j) {
                *self.block(i, j) += f.into() * g.into() * direction;
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
        let own = self.columns[function as usize].blocks.first();
        own.map_or(0.0, |block| (0..d).map(|k| block[(k, k)]).sum::<f64>() / d as f64)
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
        for (column, of_rows) in self.columns.iter().enumerate() {
            for l in 0..d {
                for (row, block) in of_rows.rows.iter().zip(&of_rows.blocks) {
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
