//! Vectors as results show them.

use mtled::algebra::tensor::Vector3;
use mtled_checks::report::four_digits;

/// As JSON.
pub(crate) fn array(v: &Vector3) -> [f64; 3] {
    [v.x, v.y, v.z]
}

/// For people.
pub(crate) fn triple(v: &Vector3) -> String {
    [v.x, v.y, v.z].map(four_digits).join(", ")
}
