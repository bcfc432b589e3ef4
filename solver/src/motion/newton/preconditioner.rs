//! An approximate inverse of the tangent operator whose quality does not depend on the
//! number of nodes.
#![allow(non_snake_case)]

use super::coarse_space::{CoarseSpace, Held};
use super::nodal_values::NodalValues;
use crate::model::Model;

/// Flexibility of parameters without values over that of values \[–\].
const HIDDEN: f64 = 50.0;

/// B = T (D⁻¹ + P A₀⁻¹ Pᵀ) Tᵀ + 50 Q D⁻¹ Qᵀ: from forces on nodal parameters to those on
/// nodal values, there the inverse of the diagonal and of the stiffness of smooth
/// displacements, and back; the last term is for parameters without values (method book,
/// eq. 21.5).
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

    /// B r \[m\].
    pub fn apply(&mut self, components: usize, r: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; r.len()];
        match components {
            2 => self.apply_in::<2>(r, &mut result),
            _ => self.apply_in::<3>(r, &mut result),
        }
        result
    }

    fn apply_in<const D: usize>(&mut self, r: &[f64], result: &mut [f64]) {
        let (r, result) = (r.as_chunks::<D>().0, result.as_chunks_mut::<D>().0);
        let mut forces = vec![[0.0; D]; r.len()];
        let mut rest = vec![[0.0; D]; r.len()];
        self.values.to_values(r, &mut forces, &mut rest);
        let mut moved = forces.clone();
        for ((moved, rest), flexibility) in moved.iter_mut().zip(&mut rest).zip(&self.flexibility) {
            moved.iter_mut().for_each(|x| *x *= flexibility);
            rest.iter_mut().for_each(|x| *x *= HIDDEN * flexibility);
        }
        self.coarse.add(&forces, &mut moved);
        self.values.to_parameters(&moved, rest, result);
    }
}
