//! Sparse matrices that act alike on every component of a nodal field.

use rayon::prelude::*;

/// Rows that are multiplied one after the other.
const ROWS_PER_TASK: usize = 512;

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

    /// The product with every component of `field`, combined with the entries of
    /// `result`: `combine(entry, product)`.
    pub fn product<const D: usize>(
        &self,
        field: &[[f64; D]],
        result: &mut [[f64; D]],
        combine: impl Fn(&mut f64, f64) + Sync,
    ) {
        let row = |(i, result): (usize, &mut [f64; D])| {
            let mut sum = [0.0; D];
            for entry in self.starts[i]..self.starts[i + 1] {
                let value = f64::from(self.values[entry]);
                let factors = &field[self.columns[entry] as usize];
                sum.iter_mut().zip(factors).for_each(|(sum, x)| *sum += value * x);
            }
            result.iter_mut().zip(sum).for_each(|(entry, sum)| combine(entry, sum));
        };
        match result.len() <= ROWS_PER_TASK {
            true => result.iter_mut().enumerate().for_each(row),
            false => {
                result.par_iter_mut().with_min_len(ROWS_PER_TASK).enumerate().for_each(row);
            }
        }
    }
}
