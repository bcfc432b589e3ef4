//! Fields packed into one vector \[component of node\].

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// y += a x.
pub(crate) fn axpy(y: &mut [f64], a: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

/// Largest absolute value of the entries; 0 if there are none.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0f64, |a, x| a.max(x.abs()))
}
