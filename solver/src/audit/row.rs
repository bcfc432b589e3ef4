//! The rows of the table.

use crate::algebra::tensor::Vector3;

/// A number or a vector in the unit of its row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Figure {
    /// One number.
    Number(f64),
    /// Three components.
    Vector(Vector3),
}

/// What was asked for, what was done, and by how much the two may differ.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What is compared.
    pub kind: Kind,
    /// Name of the condition, load or region; empty for the whole body.
    pub of: String,
    /// By the statement of the problem, from its shapes.
    pub asked: Figure,
    /// By the discretised body, its loads and the solution.
    pub done: Figure,
    /// Size of the difference, in the unit of the row.
    pub difference: f64,
    /// The largest difference that is no reason to doubt the run.
    pub limit: f64,
}

impl Row {
    /// Whether the difference is a reason to doubt the run; one that is no number is.
    pub fn exceeds(&self) -> bool {
        self.difference.is_nan() || self.difference > self.limit
    }

    pub(super) fn numbers(kind: Kind, of: &str, asked: f64, done: f64, limit: f64) -> Row {
        let difference = (done - asked).abs();
        let [asked, done] = [asked, done].map(Figure::Number);
        Row { kind, of: of.into(), asked, done, difference, limit }
    }

    pub(super) fn vectors(kind: Kind, of: &str, asked: Vector3, done: Vector3, limit: f64) -> Row {
        let difference = (done - asked).norm();
        let [asked, done] = [asked, done].map(Figure::Vector);
        Row { kind, of: of.into(), asked, done, difference, limit }
    }
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident: $name:literal, $label:literal, $unit:literal, $advice:literal;)*) => {
        /// What a row compares.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Kind {
            $($(#[$doc])* $kind,)*
        }

        impl Kind {
            /// Every kind.
            pub const ALL: &[Kind] = &[$(Kind::$kind),*];

            /// In files.
            pub fn name(self) -> &'static str {
                match self { $(Kind::$kind => $name,)* }
            }

            /// For people.
            pub fn label(self) -> &'static str {
                match self { $(Kind::$kind => $label,)* }
            }

            /// Of asked, done, difference and limit.
            pub fn unit(self) -> &'static str {
                match self { $(Kind::$kind => $unit,)* }
            }

            /// What it means where the limit is exceeded, and what to do.
            pub fn advice(self) -> &'static str {
                match self { $(Kind::$kind => $advice,)* }
            }
        }
    };
}

kinds! {
    /// Displacement of a node, where it differs most from what a condition prescribes.
    PrescribedAtNodes: "prescribed_at_nodes", "displacement at the nodes of", "m",
        "the displacement that was prescribed was not reached: apply the load in a longer time, or solve by relaxation";
    /// Displacement between the nodes of a held face, where it differs most.
    PrescribedBetween: "prescribed_between_nodes", "displacement between the nodes of", "m",
        "the held face does not move as prescribed between its nodes: use a finer cloud there";
    /// Force of a load.
    LoadForce: "load_force", "force of", "N",
        "what reached the nodes is not the load that was stated: use a finer cloud at the part that it acts on";
    /// Moment of a load about the centre of what it acts on.
    LoadMoment: "load_moment", "moment of", "N m",
        "the load does not act where it was stated: use a finer cloud at the part that it acts on";
    /// Volume of a cavity at rest.
    CavityVolume: "cavity_volume", "volume of cavity", "m³",
        "the surface of the cavity encloses another volume than the shapes: use a finer cloud there, or give a point of the plane of its opening";
    /// Loads, reactions and contact in sum.
    Forces: "forces", "loads, reactions and contact", "N",
        "the forces on the body do not add up to zero, so that some of them are wrong: lower the tolerance";
    /// Their moments about the centre of the body.
    Moments: "moments", "moments of loads, reactions and contact", "N m",
        "the moments on the body do not add up to zero, so that some forces act at a wrong place: lower the tolerance";
    /// Work of the internal forces along the displacement.
    InternalWork: "internal_work", "work of the internal forces", "J",
        "the internal forces are not the derivative of the strain energy, so that the material is not the one that was asked for: report this as a fault of the program";
    /// Volume of a region.
    Volume: "volume", "volume of", "m³",
        "the quadrature points have another volume than the shape: use smaller cells, and look whether parts of the body are stated twice";
    /// Mass at the nodes.
    Mass: "mass", "mass of", "kg",
        "the nodes carry another mass than the shape has: use smaller cells, and look whether parts of the body are stated twice";
    /// Mass at the nodes.
    NodalMass: "nodal_mass", "mass at the nodes", "kg",
        "the nodes have not the mass of the quadrature points: report this as a fault of the program";
    /// Centre of a region.
    Centre: "centre", "centre of", "m",
        "the quadrature points lie elsewhere than the shape: use smaller cells";
    /// Energy that appeared or vanished.
    Energy: "energy", "energy that is unaccounted for", "J",
        "energy was made or lost by the integration in time: use a smaller step";
    /// Work of conditions and obstacles that do not move.
    ContactWork: "contact_work", "work of what does not move", "J",
        "obstacles and held nodes that do not move have taken or given energy: use a finer cloud where the body touches";
    /// Depth of the boundary in an obstacle, between nodes too, or of an obstacle in the body.
    Depth: "obstacle_depth", "depth in", "m",
        "the body has entered the obstacle between its nodes, or closed around it: use a finer cloud, at most as coarse as the obstacle is large";
    /// Part of the edges of the body along which there are no nodes.
    Edges: "edges", "edges without nodes", "1",
        "edges of the body run between nodes and are rounded off: use a finer cloud";
    /// Nodal spacings across the thickest place of a region that is softer or harder than others.
    Layer: "layer", "spacings across", "1",
        "a layer of so few spacings carries load as if it were as hard as what is next to it: use a finer cloud";
    /// Part of the boundary that is seen across a gap.
    Gap: "gap", "boundary glued across gaps", "1",
        "supports reach across gaps of the body, whose sides are glued together: use a spacing of at most half the gap";
    /// J of the patch of quadrature points whose volume has changed most.
    PatchVolume: "patch_volume", "J of the worst patch of", "1",
        "a nearly incompressible part has lost or gained volume: use a finer cloud, or a smaller load";
}
