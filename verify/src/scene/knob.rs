//! What may be changed about a case, by name.

use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};

/// What may be changed about a recipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Knob {
    /// Node spacing \[m\]; every other length of the recipe is scaled with it.
    Spacing,
    /// Influence radius over node spacing \[–\].
    Dilation,
    /// Cells along a node spacing \[–\]; smaller cells keep their ratio.
    CellsPerSpacing,
    GaussPoints,
    Basis,
    WeightFunction,
    Mass,
    Enforcement,
    Gradients,
    /// Of consistent gradients, over the defect of plain ones \[–\].
    GradientTolerance,
    VolumetricProjection,
    /// Largest random move over the spacing \[–\]; a lattice becomes jittered.
    Jitter,
    /// Another cloud of the same spacing: added to the seed of a jittered or
    /// graded cloud; a lattice is jittered by a tenth. 0 changes nothing.
    Cloud,
    /// Step over the critical one \[–\].
    SafetyFactor,
    /// How a static solution is found.
    Solver,
    /// Of a static solution \[–\].
    Tolerance,
    /// Everything that moves the body, over what the case says \[–\]: prescribed
    /// displacements and angles, tractions, body forces, initial velocities. It
    /// changes the problem, not the recipe.
    Load,
}

/// Every knob, its name on the command line and in plans, and its key.
pub const KNOBS: &[(Knob, &str, &[&str])] = &[
    (Knob::Spacing, "spacing", &["discretisation", "spacing"]),
    (Knob::Dilation, "dilation", &["discretisation", "dilation"]),
    (Knob::CellsPerSpacing, "cells_per_spacing", &["discretisation", "grid", "cells_per_spacing"]),
    (Knob::GaussPoints, "gauss_points", &["discretisation", "grid", "gauss_points"]),
    (Knob::Basis, "basis", &["discretisation", "basis"]),
    (Knob::WeightFunction, "weight_function", &["discretisation", "weight_function"]),
    (Knob::Mass, "mass", &["discretisation", "mass"]),
    (Knob::Enforcement, "enforcement", &["discretisation", "enforcement"]),
    (Knob::Gradients, "gradients", &["discretisation", "gradients"]),
    (Knob::GradientTolerance, "gradient_tolerance", &["discretisation", "gradient_tolerance"]),
    (
        Knob::VolumetricProjection,
        "volumetric_projection",
        &["discretisation", "volumetric_projection"],
    ),
    (Knob::Jitter, "jitter", &["discretisation", "jitter"]),
    (Knob::Cloud, "cloud", &["discretisation", "seed"]),
    (Knob::SafetyFactor, "safety_factor", &["time", "safety_factor"]),
    (Knob::Solver, "solver", &["time", "solver"]),
    (Knob::Tolerance, "tolerance", &["time", "tolerance"]),
    (Knob::Load, "load", &[]),
];

impl Knob {
    pub fn name(self) -> &'static str {
        KNOBS.iter().find(|row| row.0 == self).map_or("", |row| row.1)
    }

    /// Its key in a case file, from the outermost table.
    pub(super) fn path(self) -> &'static [&'static str] {
        KNOBS.iter().find(|row| row.0 == self).map_or(&[], |row| row.2)
    }
}

/// A number or a word.
#[derive(Debug, Clone, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Level {
    Number(f64),
    Word(String),
}

impl Display for Level {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Level::Number(number) => write!(out, "{number}"),
            Level::Word(word) => write!(out, "{word}"),
        }
    }
}

/// One change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    pub knob: Knob,
    pub level: Level,
}

impl Setting {
    pub fn number(knob: Knob, value: f64) -> Setting {
        Setting { knob, level: Level::Number(value) }
    }

    pub fn word(knob: Knob, word: &str) -> Setting {
        Setting { knob, level: Level::Word(word.to_string()) }
    }
}

impl Display for Setting {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "{} {}", self.knob.name(), self.level)
    }
}
