//! Landmarks moved by a displacement field.

use super::field::DisplacementField;
use anyhow::Result;
use mtled::algebra::tensor::Vector3;
use mtled_checks::escape::csv_text;
use mtled_io::files::points::Landmark;
use serde::Serialize;

/// A landmark before and after, RAS \[mm\].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MovedLandmark {
    /// Its name.
    pub name: String,
    /// Before the deformation \[mm\].
    pub position_mm: [f64; 3],
    /// After it \[mm\].
    pub moved_mm: [f64; 3],
    /// How far outside of the body it was; there it moves with the nearest point of the body,
    /// the less the farther \[mm\].
    pub outside_mm: f64,
    /// Where it was found after the deformation \[mm\].
    pub found_mm: Option<[f64; 3]>,
    /// Target registration error without the displacement \[mm\].
    pub error_before_mm: Option<f64>,
    /// Target registration error with it \[mm\].
    pub error_after_mm: Option<f64>,
}

/// Landmarks with their places after the deformation.
pub fn move_landmarks(field: &DisplacementField, landmarks: &[Landmark]) -> Vec<MovedLandmark> {
    let millimetres = |v: &Vector3| <[f64; 3]>::from(v * 1e3);
    let moved = |landmark: &Landmark| {
        let before = &landmark.position;
        let after = before + field.at(before);
        let error = |place: &Vector3| landmark.found.map(|found| 1e3 * (found - place).norm());
        MovedLandmark {
            name: landmark.name.clone(),
            position_mm: millimetres(before),
            moved_mm: millimetres(&after),
            outside_mm: 1e3 * field.distance_outside(before),
            found_mm: landmark.found.as_ref().map(millimetres),
            error_before_mm: error(before),
            error_after_mm: error(&after),
        }
    };
    landmarks.iter().map(moved).collect()
}

/// A row per landmark; cells are empty where it was not found again.
pub fn to_csv(landmarks: &[MovedLandmark]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let axes = |name: &str| ["x", "y", "z"].map(|axis| format!("{name}{axis}_mm"));
    let mut header = vec!["name".to_string()];
    header.extend(["", "moved_", "found_"].into_iter().flat_map(axes));
    header.extend(["outside_mm", "error_before_mm", "error_after_mm"].map(String::from));
    writer.write_record(&header)?;
    let text = |number: Option<f64>| number.map_or(String::new(), |number| number.to_string());
    for landmark in landmarks {
        let mut row = vec![csv_text(&landmark.name)];
        let places = [Some(landmark.position_mm), Some(landmark.moved_mm), landmark.found_mm];
        for place in places {
            row.extend([0, 1, 2].map(|axis| text(place.map(|place| place[axis]))));
        }
        row.push(text(Some(landmark.outside_mm)));
        row.extend([text(landmark.error_before_mm), text(landmark.error_after_mm)]);
        writer.write_record(&row)?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
