//! A scene as plain data: lengths over its size, stresses over its stiffness.

mod draw;
mod draw_more;
mod more;
mod part;
mod smaller;

pub(crate) use more::{Bed, Drift, Filling, Memory, Piece, Rubs, Wall};
pub(crate) use part::Part;

use serde::{Deserialize, Serialize};

/// A small scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Longest edge of the box around the body \[m\].
    pub size: f64,
    /// Young's modulus at rest \[Pa\].
    pub young_modulus: f64,
    /// \[–\]
    pub poisson_ratio: f64,
    /// \[kg/m³\]
    pub density: f64,
    /// Stress–strain law.
    pub law: Law,
    /// Solid.
    pub form: Form,
    /// Edges of the box around the body over the size \[–\].
    pub edges: [f64; 3],
    /// Slab of plane strain over the size \[–\]; in space without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
    /// Nodal spacings along the size.
    pub spacings: u32,
    /// Where the nodes come from.
    pub cloud: Cloud,
    /// Of random positions.
    pub seed: u32,
    /// Shape functions.
    pub basis: Basis,
    /// Gradients.
    pub gradients: Gradients,
    /// Whether prescribed values are taken by nodal parameters instead of the field.
    pub direct: bool,
    /// Whether the mass of a point is divided evenly instead of by shape functions.
    pub even_mass: bool,
    /// Whether J is projected where the material is nearly incompressible.
    pub projected: bool,
    /// How it comes to its end.
    pub way: Way,
    /// Another material in a part of the body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inclusion: Option<Inclusion>,
    /// What it comes to rest on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<Wall>,
    /// Prescribed displacements.
    #[serde(default)]
    pub holds: Vec<Hold>,
    /// Loads.
    #[serde(default)]
    pub pushes: Vec<Push>,
    /// Springs on a part of the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bed: Option<Bed>,
    /// What fills the hole of a hollow body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filling: Option<Filling>,
    /// How the isochoric stress relaxes, of a law that splits it off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<Memory>,
    /// What fibres pull with, over the stiffness \[–\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tension: Option<f64>,
}

/// A stress–strain law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// Log-J neo-Hookean.
    LogJ,
    /// Neo-Hookean with the isochoric split.
    Isochoric,
    /// Mooney–Rivlin.
    MooneyRivlin,
    /// Ogden with one term, α = −4.7.
    Ogden,
    /// Linear in the Green–Lagrange strain.
    StVenantKirchhoff,
    /// Hooke's law.
    Linear,
    /// Guccione's, its fibres turning from place to place.
    Muscle,
    /// Holzapfel and Ogden's, whose fibres carry nothing in compression.
    Sheets,
}

impl Law {
    /// Whether it has fibres.
    pub(crate) fn has_fibres(self) -> bool {
        matches!(self, Law::Muscle | Law::Sheets)
    }

    /// Whether its isochoric stress stands apart, so that it can relax.
    pub(crate) fn is_split(self) -> bool {
        matches!(self, Law::Isochoric | Law::Ogden | Law::Muscle | Law::Sheets)
    }
}

/// A solid in the box of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// The box itself.
    Box,
    /// The largest ball at its middle; in a plane a disc.
    Ball,
    /// The ellipsoid that touches its faces; in a plane an ellipse.
    Ellipsoid,
    /// An upright cylinder.
    Cylinder,
    /// An L along z.
    Corner,
    /// The lower half of the box with a ball on it.
    Dome,
    /// The box with an upright bore.
    Bored,
    /// The box, cut off by a ball.
    Rounded,
    /// A wedge of triangles.
    Wedge,
    /// The box of voxels.
    Voxels,
    /// The box with a ball cut out of its middle; in a plane a disc.
    Hollow,
    /// The box with a box of half its edges cut out of its middle.
    Chamber,
}

impl Form {
    /// Whether its surface encloses a hole.
    pub(crate) fn has_hole(self) -> bool {
        matches!(self, Form::Hollow | Form::Chamber)
    }
}

/// Where nodes come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cloud {
    /// A lattice.
    Lattice,
    /// One with random shifts.
    Jittered,
    /// Closer in one corner.
    Graded,
}

/// Basis of the shape functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// 1, x, y, z.
    Linear,
    /// Of second order, with a penalty.
    Quadratic,
}

/// Gradients.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Gradients {
    /// Derivatives of the shape functions.
    Plain,
    /// Consistent with the divergence theorem.
    Consistent,
    /// For linear stresses too.
    SecondOrder,
}

/// How a scene comes to its end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Way {
    /// Newton's method.
    Newton,
    /// In motion.
    Motion {
        /// Over the time that a wave takes along the size \[–\].
        end: f64,
        /// Damping times that time \[–\].
        damping: f64,
    },
}

/// Another material in a part of the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Inclusion {
    /// 0, 1, 2 for x, y, z.
    pub axis: u8,
    /// Its stiffness over that of the rest \[–\].
    pub stiffness: f64,
    /// Which part.
    #[serde(default)]
    pub piece: Piece,
}

/// A prescribed displacement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hold {
    /// Where.
    pub part: Part,
    /// Whether inner nodes are held too.
    pub inner: bool,
    /// What is prescribed.
    pub to: Place,
    /// Fraction of the end of a motion after which it is released.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub release: Option<f64>,
}

/// What is prescribed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Where it is.
    Still,
    /// One component is zero.
    Roller(u8),
    /// A displacement over the size \[–\].
    By([f64; 3]),
    /// A rotation about an axis through the middle of the box \[rad\].
    Turned(u8, f64),
    /// A displacement by a formula, this much at its largest, over the size \[–\].
    Bent(f64),
}

/// A load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Push {
    /// A body force on the whole body, times density and size over stiffness \[–\].
    Gravity([f64; 3]),
    /// The same on a part.
    Pull(Part, [f64; 3]),
    /// A dead traction over the stiffness \[–\].
    Traction(Part, [f64; 3]),
    /// A pressure over the stiffness \[–\].
    Pressure(Part, f64),
    /// A velocity at the start, over that of waves \[–\].
    Throw(Part, [f64; 3]),
}

impl Scene {
    /// Displacement components.
    pub(crate) fn components(&self) -> usize {
        if self.thickness.is_some() { 2 } else { 3 }
    }

    /// Time that a wave takes along the size \[s\].
    pub(crate) fn wave_time(&self) -> f64 {
        self.size / (self.young_modulus / self.density).sqrt()
    }

    /// Whether it is a static problem.
    pub(crate) fn is_static(&self) -> bool {
        self.way == Way::Newton
    }

    /// Fraction of the bulk energy that is projected on patches is not zero.
    pub(crate) fn has_patches(&self) -> bool {
        self.projected && self.poisson_ratio > 0.3 && self.law != Law::Linear
    }

    /// Whether what it comes to rest at depends on its way there, and not on the end alone.
    pub(crate) fn depends_on_way(&self) -> bool {
        self.memory.is_some() || self.obstacle.is_some_and(|wall| wall.rubs != Rubs::Free)
    }

    /// Whether a load goes with the panels of its surface.
    pub(crate) fn loads_surface(&self) -> bool {
        let on_panels = |push: &Push| matches!(push, Push::Traction(..) | Push::Pressure(..));
        self.bed.is_some() || self.filling.is_some() || self.pushes.iter().any(on_panels)
    }

    /// Whether what holds it and loads it is there from the start to the end.
    pub(crate) fn has_releases(&self) -> bool {
        self.holds.iter().any(|hold| hold.release.is_some())
    }

    /// The scene as text.
    pub fn text(&self) -> anyhow::Result<String> {
        Ok(toml_edit::ser::to_string_pretty(self)?)
    }

    /// From its text.
    pub fn from_text(text: &str) -> anyhow::Result<Scene> {
        Ok(toml_edit::de::from_str(text)?)
    }
}

#[cfg(test)]
mod tests;
