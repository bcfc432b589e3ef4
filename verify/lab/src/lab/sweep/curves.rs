//! Curves over a setting with the scatter over clouds.

use mtled_checks::study::{Series, curve};

/// A curve; at each abscissa the values of all clouds.
#[derive(Debug)]
pub(crate) struct Curve {
    pub name: String,
    pub points: Vec<(f64, Vec<f64>)>,
}

/// Sorts samples (curve, x, y) into curves in the order of their first samples. The x of
/// several clouds may differ in the last digits.
pub(crate) fn curves(samples: impl Iterator<Item = (String, f64, f64)>) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for (name, x, y) in samples {
        let index = curves.iter().position(|curve| curve.name == name).unwrap_or_else(|| {
            curves.push(Curve { name, points: Vec::new() });
            curves.len() - 1
        });
        let points = &mut curves[index].points;
        match points.iter_mut().find(|point| point.0 == x || (point.0 / x - 1.0).abs() < 1e-6) {
            Some(point) => point.1.push(y),
            None => points.push((x, vec![y])),
        }
    }
    curves
}

impl Curve {
    /// The middles of the ranges over the clouds; error bars reach to their ends.
    pub(crate) fn series(&self) -> Series {
        let middles = self.points.iter().map(|(x, values)| (*x, range(values).0)).collect();
        let error_bars = self.points.iter().map(|(_, values)| range(values).1).collect();
        Series { error_bars, ..curve(&self.name, middles) }
    }
}

/// Middle and half-length of a range.
fn range(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (0.5 * (low + high), 0.5 * (high - low))
}
