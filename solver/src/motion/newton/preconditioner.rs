//! An approximate inverse of the tangent operator whose quality does not depend on the
//! number of nodes.
#![allow(non_snake_case)]

use super::coarse_space::{CoarseSpace, Held};
use super::nodal_values::NodalValues;
use crate::algebra::sparse::{packed, padded};
use crate::model::Model;

/// Flexibility of parameters without values over that of values \[–\].
const HIDDEN: f64 = 50.0;

/// B = T D⁻¹ Tᵀ + 50 Q D⁻¹ Qᵀ + P A₀⁻¹ Pᵀ: from forces on nodal parameters to those on nodal
/// values, there the inverse of the diagonal, and back; the second term is for parameters
/// without values, the last one for smooth displacements (method book, eq. 21.5).
pub(super) struct Preconditioner {
    values: NodalValues,
    coarse: CoarseSpace,
    /// D⁻¹ \[m/N\].
    flexibility: Vec<f64>,
}

impl Preconditioner {
    /// `None` without the shape functions at the nodes.
    pub fn new(model: &Model) -> Option<Preconditioner> {
        let values = NodalValues::new(model.nodal_rows.as_ref()?);
        let stiffness = values.mean(&model.stiffness);
        Some(Preconditioner {
            values,
            coarse: CoarseSpace::new(model),
            flexibility: stiffness.iter().map(|k| 1.0 / k).collect(),
        })
    }

    /// Takes account of what is held, and of `shift` times the diagonal added to K.
    pub fn hold(&mut self, model: &Model, held: &[Held], shift: f64) {
        self.coarse.factor(model, held, shift);
    }

    /// B r \[m\]; its two parts at the same time.
    pub fn apply(&mut self, components: usize, r: &[f64]) -> Vec<f64> {
        let Preconditioner { values, coarse, flexibility } = self;
        let r = padded(r, components);
        let inverses = |a: usize| [flexibility[a], HIDDEN * flexibility[a]];
        let (mut moved, smooth) =
            rayon::join(|| values.apply(&r, inverses), || coarse.apply(components, &r));
        for (moved, smooth) in moved.iter_mut().flatten().zip(smooth.as_flattened()) {
            *moved += smooth;
        }
        packed(&moved, components)
    }
}
