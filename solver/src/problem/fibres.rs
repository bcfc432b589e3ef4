//! Directions of fibres.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::geometry::Field;
use crate::problem::amplitude::Amplitude;

/// Directions of fibres and sheets of a region, as functions of the reference position \[m\]. They
/// need not have length 1, nor be normal to each other.
#[derive(Debug, Clone)]
pub struct Fibres {
    /// Along the fibres \[–\].
    pub fibre: Field,
    /// Within the sheets that the fibres lie in \[–\]; none where the law has no sheets.
    pub sheet: Option<Field>,
}

/// What muscle pulls with along its fibres, whatever its strain: T_a f ⊗ f is added to the second
/// Piola–Kirchhoff stress, with the fibre direction f at rest (Land et al., Proc. R. Soc. A
/// 471:20150641, 2015, section 2.2; method book, eq. 3.26).
#[derive(Debug, Clone)]
pub struct ActiveStress {
    /// T_a at amplitude 1 \[Pa\].
    pub tension: f64,
    /// The factor over time.
    pub amplitude: Amplitude,
}

/// A place where a material has no direction.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "there is no direction of {what} at ({}, {}, {}) m: it must be a vector longer than 0, of data within their reach, and that of sheets not along the fibres",
    .position.x, .position.y, .position.z
)]
pub struct NoDirection {
    /// Of what.
    pub what: &'static str,
    /// Reference position \[m\].
    pub position: Vector3,
}

/// The smallest part of a direction across the fibres that tells where the sheets are \[–\].
const ACROSS: f64 = 1e-6;

impl Fibres {
    /// The fibre frame Q at a reference position: its columns are the fibre direction, the direction
    /// of the sheets normal to it, and the normal to both (method book, eq. 3.22). Without sheets
    /// any two normals to the fibres do.
    ///
    /// # Errors
    /// [`NoDirection`] where a direction is 0 or no number, or sheets lie along the fibres.
    pub fn frame(&self, X: &Vector3) -> Result<Matrix3, NoDirection> {
        let refused = |what| NoDirection { what, position: *X };
        let unit = |direction: Vector3| {
            let length = direction.norm();
            (length > 0.0 && length.is_finite()).then(|| direction / length)
        };
        let fibre = unit(self.fibre.at(X)).ok_or_else(|| refused("fibres"))?;
        let across = |direction: &Vector3| direction - fibre * fibre.dot(direction);
        let sheet = match &self.sheet {
            Some(field) => {
                let given = unit(field.at(X)).ok_or_else(|| refused("sheets"))?;
                Some(across(&given)).filter(|sheet| sheet.norm() > ACROSS).and_then(unit)
            }
            None => unit(across(&Vector3::ith(fibre.abs().imin(), 1.0))),
        };
        let sheet = sheet.ok_or_else(|| refused("sheets beside the fibres"))?;
        Ok(Matrix3::from_columns(&[fibre, sheet, fibre.cross(&sheet)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(fibre: Vector3, sheet: Option<Vector3>) -> Result<Matrix3, NoDirection> {
        let fibres = Fibres { fibre: fibre.into(), sheet: sheet.map(Field::from) };
        fibres.frame(&Vector3::new(0.1, 0.2, 0.3))
    }

    #[test]
    fn a_frame_is_a_rotation_with_the_fibres_first_and_the_sheets_in_its_first_plane() {
        let (fibre, sheet) = (Vector3::new(2.0, -1.0, 0.5), Vector3::new(0.3, 4.0, -1.0));
        for sheet in [None, Some(sheet)] {
            let Q = frame(fibre, sheet).unwrap();
            assert!((Q.transpose() * Q - Matrix3::identity()).norm() < 1e-14);
            assert!((Q.determinant() - 1.0).abs() < 1e-14);
            assert!((Q.column(0) - fibre.normalize()).norm() < 1e-15);
            if let Some(sheet) = sheet {
                assert!(Q.column(2).dot(&sheet).abs() < 1e-14);
                assert!(Q.column(1).dot(&sheet) > 0.0);
            }
        }
    }

    #[test]
    fn what_is_no_direction_is_refused_with_the_place() {
        let x = Vector3::x();
        let message = |made: Result<Matrix3, NoDirection>| made.unwrap_err().to_string();
        assert!(message(frame(Vector3::zeros(), None)).contains("fibres"));
        assert!(message(frame(Vector3::repeat(f64::NAN), None)).contains("0.1"));
        assert!(message(frame(x, Some(Vector3::zeros()))).contains("sheets"));
        assert!(message(frame(x, Some(x * 3.0))).contains("sheets beside the fibres"));
    }
}
