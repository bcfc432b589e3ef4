//! What may be changed about a case by name: in plans, on the command line, in a search.

use crate::scene::format::{
    BasisFormat, EnforcementFormat, GradientsFormat, MassFormat, MaterialBordersFormat,
    SolverFormat, VolumetricProjectionFormat, WeightFunctionFormat,
};
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};

/// Which levels a knob can be set to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Levels {
    /// Any number.
    Number,
    /// A whole number.
    Count,
    /// One of these words.
    Word(&'static [&'static str]),
}

/// The entry of a knob.
struct Row {
    /// In plans and records.
    name: &'static str,
    /// On the command line, `None` if it is not offered there.
    flag: Option<&'static str>,
    /// Its key in a case file, from the outermost table.
    path: &'static [&'static str],
    levels: Levels,
    help: &'static str,
}

macro_rules! knobs {
    ($($knob:ident, $name:literal, $flag:expr, $path:expr, $levels:expr, $help:literal;)+) => {
        /// What may be changed about a case.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum Knob {
            $(#[doc = $help] #[serde(rename = $name)] $knob),+
        }

        impl Knob {
            /// Every knob.
            pub const ALL: &[Knob] = &[$(Knob::$knob),+];

            fn row(self) -> Row {
                match self {
                    $(Knob::$knob => Row {
                        name: $name, flag: $flag, path: &$path, levels: $levels, help: $help,
                    }),+
                }
            }
        }
    };
}

use Levels::{Count, Number, Word};

#[rustfmt::skip]
knobs! {
    Spacing, "spacing", Some("spacing"), ["discretisation", "spacing"], Number,
        "Node spacings in metres, or factors such as x0.8; every other length of the recipe is scaled too";
    Dilation, "dilation", Some("dilation"), ["discretisation", "dilation"], Number,
        "Influence radius over node spacing";
    CellsPerSpacing, "cells_per_spacing", Some("cells-per-spacing"),
        ["discretisation", "grid", "cells_per_spacing"], Number,
        "Cells along a node spacing; smaller cells keep their ratio";
    GaussPoints, "gauss_points", Some("gauss-points"),
        ["discretisation", "grid", "gauss_points"], Count,
        "Gauss points per cell and direction";
    Basis, "basis", Some("basis"), ["discretisation", "basis"], Word(BasisFormat::WORDS),
        "Polynomial basis";
    WeightFunction, "weight_function", Some("weight-function"),
        ["discretisation", "weight_function"], Word(WeightFunctionFormat::WORDS),
        "Weight function";
    Mass, "mass", Some("mass"), ["discretisation", "mass"], Word(MassFormat::WORDS),
        "Mass lumping";
    Enforcement, "enforcement", Some("enforcement"),
        ["discretisation", "enforcement"], Word(EnforcementFormat::WORDS),
        "Enforcement of prescribed displacements";
    Gradients, "gradients", Some("gradients"),
        ["discretisation", "gradients"], Word(GradientsFormat::WORDS),
        "Gradients of the shape functions";
    GradientTolerance, "gradient_tolerance", Some("gradient-tolerance"),
        ["discretisation", "gradient_tolerance"], Number,
        "Of consistent gradients, over the defect of plain ones";
    VolumetricProjection, "volumetric_projection", Some("volumetric-projection"),
        ["discretisation", "volumetric_projection"], Word(VolumetricProjectionFormat::WORDS),
        "Projection of the change of volume in the bulk energy";
    MaterialBorders, "material_borders", Some("material-borders"),
        ["discretisation", "material_borders"], Word(MaterialBordersFormat::WORDS),
        "Borders between materials of different stiffness";
    Jitter, "jitter", Some("jitter"), ["discretisation", "jitter"], Number,
        "Largest random move of nodes over their spacing; a lattice becomes jittered";
    Cloud, "cloud", None, ["discretisation", "seed"], Number,
        "Another cloud of the same spacing: added to the random seed of a jittered or graded cloud; \
         a lattice is jittered by a tenth; 0 changes nothing";
    SafetyFactor, "safety_factor", Some("safety-factor"), ["time", "safety_factor"], Number,
        "Time step over the critical one";
    Solver, "solver", Some("solver"), ["time", "solver"], Word(SolverFormat::WORDS),
        "Method for a static solution";
    Tolerance, "tolerance", Some("tolerance"), ["time", "tolerance"], Number,
        "Tolerance of a static solution";
    Load, "load", Some("load"), [], Number,
        "Factor on everything that moves the body: prescribed displacements and angles, \
         tractions, pressures, inflows, body forces, initial velocities; it changes the problem, not the recipe";
}

impl Knob {
    /// Its name in plans and records.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// The knob of this name.
    pub fn named(name: &str) -> Option<Knob> {
        Knob::ALL.iter().copied().find(|knob| knob.name() == name)
    }

    /// Its option on the command line without dashes in front, if it has one.
    pub fn flag(self) -> Option<&'static str> {
        self.row().flag
    }

    /// What it changes, in one sentence with the words that can be chosen.
    pub fn help(self) -> String {
        let Row { help, levels, .. } = self.row();
        match levels {
            Levels::Word(words) => format!("{help}: {}", words.join(", ")),
            Levels::Number | Levels::Count => help.to_string(),
        }
    }

    /// Which levels it takes.
    pub fn levels(self) -> Levels {
        self.row().levels
    }

    /// Its key in a case file, from the outermost table.
    pub(super) fn path(self) -> &'static [&'static str] {
        self.row().path
    }
}

/// A number or a word.
#[derive(Debug, Clone, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Level {
    /// A number, of the unit of its knob.
    Number(f64),
    /// A word, or a factor such as `x0.8`.
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
    /// What is changed.
    pub knob: Knob,
    /// What it is changed to.
    pub level: Level,
}

impl Setting {
    /// A knob set to a number.
    pub fn number(knob: Knob, value: f64) -> Setting {
        Setting { knob, level: Level::Number(value) }
    }

    /// A knob set to a word.
    pub fn word(knob: Knob, word: &str) -> Setting {
        Setting { knob, level: Level::Word(word.to_string()) }
    }
}

impl Display for Setting {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "{} {}", self.knob.name(), self.level)
    }
}
