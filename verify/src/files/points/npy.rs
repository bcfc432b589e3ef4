//! Points from a NumPy array of shape (n, 2) or (n, 3).

use crate::files::Mistake;
use mtled::algebra::tensor::Vector3;
use npyz::{NpyFile, Order};

pub fn parse(bytes: &[u8]) -> Result<Vec<Vector3>, Mistake> {
    let damaged =
        |error: std::io::Error| Mistake::Undecodable { encoding: "NPY", reason: error.to_string() };
    let file = NpyFile::new(bytes).map_err(damaged)?;
    let (shape, kind) = (file.shape().to_vec(), file.dtype().descr());
    let (order, bad) = (file.order(), Mistake::BadArray { shape: shape.clone(), kind });
    let columns = match shape[..] {
        [_, columns @ (2 | 3)] => columns as usize,
        _ => return Err(bad),
    };
    let file = match file.try_data::<f64>() {
        Ok(values) => {
            let values = values.collect::<Result<Vec<f64>, _>>().map_err(damaged)?;
            return Ok(points(&values, columns, order));
        }
        Err(file) => file,
    };
    let values = file.try_data::<f32>().map_err(|_| bad)?;
    let values: Result<Vec<f64>, _> = values.map(|value| value.map(f64::from)).collect();
    Ok(points(&values.map_err(damaged)?, columns, order))
}

fn points(values: &[f64], columns: usize, order: Order) -> Vec<Vector3> {
    if order == Order::C {
        return super::from_rows(values, columns);
    }
    let count = values.len() / columns;
    let at = |row: usize, column: usize| {
        if column < columns { values[column * count + row] } else { 0.0 }
    };
    (0..count).map(|row| Vector3::new(at(row, 0), at(row, 1), at(row, 2))).collect()
}
