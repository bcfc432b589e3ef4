//! The unknowns of Newton's method beside the displacements.

mod patches;

pub(crate) use patches::{Pressures, are_unknowns, can_be_unknowns, most};

use crate::model::Model;
use crate::model::following::OwnFluid;
use crate::motion::newton::linear::Correction;

/// The unknowns of an iteration beside the displacements.
#[derive(Clone)]
pub(crate) struct Unknowns {
    /// Of the patches, where they are unknowns.
    pub patches: Option<Pressures>,
    /// Of the cavities, where any has a fluid.
    pub fluids: Option<Vec<OwnFluid>>,
}

impl Unknowns {
    pub fn take(&mut self) -> Unknowns {
        Unknowns { patches: self.patches.take(), fluids: self.fluids.take() }
    }

    /// Moves by a part of a correction.
    pub fn moved(&self, model: &Model, part: f64, correction: &Correction) -> Unknowns {
        let mut moved = self.clone();
        if let (Some(now), Some(from)) = (&mut moved.patches, &self.patches) {
            now.own = from.moved(model, part, &correction.pressures);
        }
        for (fluid, change) in moved.fluids.iter_mut().flatten().zip(&correction.fluids) {
            fluid.pressure += part * change;
        }
        moved
    }
}
