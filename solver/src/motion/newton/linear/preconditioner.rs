//! An approximate inverse of the tangent operator whose quality does not depend on the
//! number of nodes.
#![allow(non_snake_case)]

use super::coarse_space::{CoarseSpace, Held, Stiffness};
use super::nodal_values::NodalValues;
use crate::algebra::sparse::{Padded, pad, unpad};
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
    /// What it is applied to, its smooth part, and what the other part needs; kept, for memory
    /// that is new each time costs as much as a product.
    padded: Vec<Padded>,
    smooth: Vec<Padded>,
    parts: [Vec<Padded>; 3],
}

impl Preconditioner {
    /// `None` without the shape functions at the nodes.
    pub fn new(model: &Model, at_rest: &Stiffness) -> Option<Preconditioner> {
        let values = NodalValues::new(model.nodal_rows.as_ref()?);
        let stiffness = values.mean(&at_rest.diagonal);
        Some(Preconditioner {
            values,
            coarse: CoarseSpace::new(model, at_rest),
            flexibility: stiffness.iter().map(|k| 1.0 / k).collect(),
            padded: Vec::new(),
            smooth: Vec::new(),
            parts: Default::default(),
        })
    }

    /// Takes account of what is held, and of `shift` times the diagonal added to K.
    pub fn hold(&mut self, at_rest: &Stiffness, held: &[Held], shift: f64) {
        self.coarse.factor(at_rest, held, shift);
    }

    /// B r \[m\] into `product`; the two parts of B at the same time.
    pub fn apply(&mut self, components: usize, r: &[f64], product: &mut Vec<f64>) {
        let Preconditioner { values, coarse, flexibility, padded, smooth, parts } = self;
        pad(r, components, padded);
        let inverses = |a: usize| [flexibility[a], HIDDEN * flexibility[a]];
        rayon::join(
            || values.apply(padded, inverses, parts),
            || coarse.apply(components, padded, smooth),
        );
        let [.., moved] = parts;
        for (moved, smooth) in moved.iter_mut().flatten().zip(smooth.as_flattened()) {
            *moved += smooth;
        }
        unpad(moved, components, product);
    }
}
