//! Sparse matrices that act alike on every component of a nodal field.

use fearless_simd::{Level, Simd, dispatch, f64x4, prelude::*};
use rayon::prelude::*;

/// Rows that are multiplied one after the other.
const ROWS_PER_TASK: usize = 512;

/// A vector at a node: its components, then zeros.
pub(crate) type Padded = [f64; 4];

/// What becomes of the product.
#[derive(Clone, Copy)]
pub(crate) enum Combine {
    Replace,
    Add,
    Subtract,
}

/// A matrix by rows, in single precision.
#[derive(Debug, Clone)]
pub(crate) struct Sparse {
    /// Row i is `starts[i]..starts[i + 1]` \[row + 1\].
    pub starts: Vec<usize>,
    /// Column of each entry.
    pub columns: Vec<u32>,
    /// Value of each entry.
    pub values: Vec<f32>,
}

impl Sparse {
    /// From the entries (column, value) of each row.
    pub fn from_rows(rows: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Sparse {
        let mut matrix = Sparse { starts: vec![0], columns: Vec::new(), values: Vec::new() };
        for row in rows {
            matrix.columns.extend(row.iter().map(|entry| entry.0));
            matrix.values.extend(row.iter().map(|entry| entry.1 as f32));
            matrix.starts.push(matrix.columns.len());
        }
        matrix
    }

    /// The transposed matrix of a matrix with `count` columns.
    pub fn transposed(&self, count: usize) -> Sparse {
        let mut starts = vec![0; count + 1];
        self.columns.iter().for_each(|&column| starts[column as usize + 1] += 1);
        for column in 0..count {
            starts[column + 1] += starts[column];
        }
        let mut next = starts.clone();
        let mut columns = vec![0; self.columns.len()];
        let mut values = vec![0.0; self.values.len()];
        for (row, ends) in self.starts.windows(2).enumerate() {
            for entry in ends[0]..ends[1] {
                let place = &mut next[self.columns[entry] as usize];
                columns[*place] = row as u32;
                values[*place] = self.values[entry];
                *place += 1;
            }
        }
        Sparse { starts, columns, values }
    }

    /// Product with a nodal field, which the entries of `result` take as `how` says.
    pub fn product(&self, field: &[Padded], result: &mut [Padded], how: Combine) {
        let level = Level::new();
        let rows = |(task, result): (usize, &mut [Padded])| {
            dispatch!(level, simd => self.rows(simd, task * ROWS_PER_TASK, field, result, how));
        };
        if result.len() <= ROWS_PER_TASK {
            rows((0, result))
        } else {
            result.par_chunks_mut(ROWS_PER_TASK).enumerate().for_each(rows)
        }
    }

    /// The rows from `first` on.
    #[inline(always)]
    fn rows<S: Simd>(
        &self,
        simd: S,
        first: usize,
        field: &[Padded],
        result: &mut [Padded],
        how: Combine,
    ) {
        for (ends, result) in self.starts[first..].windows(2).zip(result) {
            let (columns, values) =
                (&self.columns[ends[0]..ends[1]], &self.values[ends[0]..ends[1]]);
            let sum = row_product(simd, columns, values, field);
            *result = match how {
                Combine::Replace => sum,
                Combine::Add => f64x4::from_slice(simd, result) + sum,
                Combine::Subtract => f64x4::from_slice(simd, result) - sum,
            }
            .into();
        }
    }
}

/// Σ_j values_j field_j in four sums side by side, none of which waits for another.
#[inline(always)]
fn row_product<S: Simd>(simd: S, columns: &[u32], values: &[f32], field: &[Padded]) -> f64x4<S> {
    let term = |sum: f64x4<S>, column: u32, value: f32| {
        let factors = f64x4::from_slice(simd, &field[column as usize]);
        f64x4::splat(simd, f64::from(value)).mul_add(factors, sum)
    };
    let mut sums = [f64x4::splat(simd, 0.0); 4];
    let (columns, last_columns) = columns.as_chunks::<4>();
    let (values, last_values) = values.as_chunks::<4>();
    for (columns, values) in columns.iter().zip(values) {
        for k in 0..4 {
            sums[k] = term(sums[k], columns[k], values[k]);
        }
    }
    for (&column, &value) in last_columns.iter().zip(last_values) {
        sums[0] = term(sums[0], column, value);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Pads the vectors of a field of `components`, in space or in a plane.
pub(crate) fn pad(field: &[f64], components: usize, padded: &mut Vec<Padded>) {
    padded.resize(field.len() / components, [0.0; 4]);
    for (vector, packed) in padded.iter_mut().zip(field.chunks_exact(components)) {
        vector[..components].copy_from_slice(packed);
    }
}

/// Takes the padding away.
pub(crate) fn unpad(padded: &[Padded], components: usize, field: &mut Vec<f64>) {
    field.clear();
    field.extend(padded.iter().flat_map(|vector| &vector[..components]));
}
