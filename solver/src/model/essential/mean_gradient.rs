//! The mean gradient of a displacement field that is prescribed on the whole
//! boundary.
#![allow(non_snake_case)]

use super::rows::ConstraintRow;
use crate::algebra::pseudo_inverse::pseudo_inverse;
use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::Discretisation;
use crate::discretisation::moments::homogeneous;
use crate::problem::{EssentialCondition, Field, Prescribed};
use nalgebra::{Matrix4, Vector4};

/// Directions with less than this fraction of all moments are empty \[–\].
const EMPTY: f64 = 1e-12;

/// Where one field ū is prescribed on the whole boundary, changes the prescribed
/// displacements as little as possible in the form a_c·β, with the vector areas a_c
/// of the nodes, until their mean gradient is that of the field,
/// Σ_c ū_c a_c = ∮ ū N dA (method book, eq. 15.5). Otherwise a nearly incompressible
/// body without a free face is compressed by the error of its volume. Affine fields
/// have no error and are subtracted first.
pub(super) fn fit_mean_gradient(
    rows: &mut [ConstraintRow],
    component: usize,
    conditions: &[EssentialCondition],
    discretisation: &Discretisation,
) {
    let surface = &discretisation.surface;
    let Some(field) = field_on_boundary(rows, conditions, &surface.prescribed_areas) else {
        return;
    };
    let areas: Vec<Vector3> =
        rows.iter().map(|row| area_of(row, &surface.prescribed_areas)).collect();
    let positions = &discretisation.cloud.positions;
    let at = |row: &ConstraintRow| positions[row.node as usize];
    let samples =
        |(row, area): (&ConstraintRow, &Vector3)| (at(row), area.norm(), row.displacement);
    let Some(affine) = affine_fit(rows.iter().zip(&areas).map(samples).collect()) else { return };
    let mut defect = Vector3::zeros();
    for panel in &surface.panels {
        let rest = field.at(&panel.centre)[component] - affine(&panel.centre);
        defect += panel.area * rest * panel.normal;
    }
    let mut gram = Matrix3::zeros();
    for (row, area) in rows.iter().zip(&areas) {
        defect -= (row.displacement - affine(&at(row))) * area;
        gram += area * area.transpose();
    }
    let beta = pseudo_inverse(gram, EMPTY * gram.trace()) * defect;
    rows.iter_mut().zip(&areas).for_each(|(row, area)| row.displacement += beta.dot(area));
}

/// The field that alone prescribes all `rows`, if these include all nodes with areas.
fn field_on_boundary<'a>(
    rows: &[ConstraintRow],
    conditions: &'a [EssentialCondition],
    areas: &[(u32, Vector3)],
) -> Option<&'a Field> {
    let condition = rows.first()?.condition;
    let Prescribed::Field(field) = &conditions[condition as usize].prescribed else { return None };
    let alone = rows.iter().all(|row| row.condition == condition);
    let constrained =
        |(node, _): &(u32, Vector3)| rows.binary_search_by_key(node, |row| row.node).is_ok();
    (alone && !areas.is_empty() && areas.iter().all(constrained)).then_some(field)
}

fn area_of(row: &ConstraintRow, areas: &[(u32, Vector3)]) -> Vector3 {
    let index = areas.binary_search_by_key(&row.node, |(node, _)| *node);
    index.map_or(Vector3::zeros(), |index| areas[index].1)
}

/// The affine function nearest to samples (X, size, value), by least squares weighted
/// with the sizes.
fn affine_fit(samples: Vec<(Vector3, f64, f64)>) -> Option<impl Fn(&Vector3) -> f64> {
    let origin = samples.first()?.0;
    let distance = |(X, ..): &(Vector3, f64, f64)| (X - origin).norm();
    let length = samples.iter().map(distance).fold(f64::MIN_POSITIVE, f64::max);
    let p = move |X: &Vector3| homogeneous(&((X - origin) / length));
    let (mut gram, mut moments) = (Matrix4::zeros(), Vector4::zeros());
    for (X, size, value) in &samples {
        gram += *size * p(X) * p(X).transpose();
        moments += *size * *value * p(X);
    }
    let coefficients = pseudo_inverse(gram, EMPTY * gram.trace()) * moments;
    Some(move |X: &Vector3| coefficients.dot(&p(X)))
}
