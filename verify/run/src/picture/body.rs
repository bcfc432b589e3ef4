//! A body with its fields, from which pictures are drawn.
#![allow(non_snake_case)]

use crate::display::Mesh;
use mtled::algebra::tensor::Vector3;

/// A field at the vertices of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    pub name: String,
    pub components: usize,
    /// \[vertex\]\[component\]
    pub values: Vec<f64>,
}

/// A mesh with the displacement and other fields at its vertices.
#[derive(Debug, Clone)]
pub struct Body {
    pub mesh: Mesh,
    pub fields: Vec<Field>,
}

/// The field that is drawn unless another is chosen.
const DISPLACEMENT: &str = "displacement";

impl Body {
    /// A field by its name.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Displacement \[vertex\] \[m\]; none where there is no such field.
    pub(crate) fn displacement(&self) -> Vec<Vector3> {
        match self.field(DISPLACEMENT).filter(|field| field.components == 3) {
            Some(field) => field.values.chunks(3).map(Vector3::from_column_slice).collect(),
            None => vec![Vector3::zeros(); self.mesh.vertices.len()],
        }
    }
}

impl Field {
    /// One number per vertex: the size of a vector, the largest of principal values.
    pub(crate) fn scalars(&self) -> Vec<f64> {
        let principal = self.name.starts_with("principal");
        let scalar = |values: &[f64]| match values {
            [value] => *value,
            [first, ..] if principal => *first,
            values => values.iter().map(|v| v * v).sum::<f64>().sqrt(),
        };
        self.values.chunks(self.components).map(scalar).collect()
    }

    /// What the colours mean.
    pub fn label(&self) -> String {
        let words = self.name.replace('_', " ").replace("von mises", "von Mises");
        let words = words.replace("green lagrange", "Green–Lagrange");
        if self.name.starts_with("principal") { format!("largest {words}") } else { words }
    }

    /// Its unit; empty for pure numbers and what is not known.
    pub(crate) fn unit(&self) -> &'static str {
        match self.name.as_str() {
            DISPLACEMENT | "displacement_error_bar" | "contact_gap" | "nodal_spacing" => "m",
            "von_mises_stress" | "pressure" | "cauchy_stress" | "contact_pressure" => "Pa",
            _ => "",
        }
    }

    /// Whether its colours start at zero.
    pub(crate) fn begins_at_zero(&self) -> bool {
        matches!(
            self.name.as_str(),
            DISPLACEMENT | "displacement_error_bar" | "von_mises_stress" | "contact_pressure"
        )
    }
}
