//! The files of this folder for programs: cases, what finite-element codes answer on them, and
//! the label maps that they name.
//!
//! Statics rather than constants, so that a program has each of them once.

/// Includes the files of cases by name.
macro_rules! bundled {
    ($($name:literal)*) => {
        /// (name, text) of every case in `cases`.
        pub static CASES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../cases/", $name, ".toml")))),*];

        /// (case, text) of every reference in `data`.
        pub static REFERENCES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../data/", $name, ".json")))),*];
    };
}

bundled! {
    "bonded_block"
    "brain_cube_compression"
    "brain_cube_shear"
    "brain_gravity"
    "brain_shift"
    "brain_slice"
    "cook_membrane"
    "cube_compression"
    "cube_shear"
    "cut_ball"
    "falling_beam"
    "indented_block"
    "parted_arms"
    "soft_inclusion"
    "sphere_gravity"
    "turek_hron_csm1"
    "turek_hron_csm2"
    "turek_hron_csm3"
    "twisted_cylinder"
    "uniaxial_bar"
}

/// A body with fibres, and what FEniCSx answers on it.
#[derive(Debug)]
pub struct WithFibres {
    /// Name of its files.
    pub name: &'static str,
    /// Text of the case file.
    pub case: &'static str,
    /// Answers on meshes of falling size.
    pub reference: &'static str,
}

/// Includes the files of a body with fibres.
macro_rules! with_fibres {
    ($($name:literal)*) => {
        /// The bodies in `fibres`.
        pub static FIBRES: &[WithFibres] = &[$(WithFibres {
            name: $name,
            case: include_str!(concat!("../fibres/", $name, ".toml")),
            reference: include_str!(concat!("../fibres/", $name, ".json")),
        }),*];
    };
}

with_fibres! {
    "artery_strip"
    "land_1"
    "muscle_bar"
    "muscle_block"
}

/// (file, bytes) of the label maps in `brain`.
pub static LABEL_MAPS: &[(&str, &[u8])] = &[
    ("brain.nrrd", include_bytes!("../brain/brain.nrrd")),
    ("slice.nrrd", include_bytes!("../brain/slice.nrrd")),
];

/// Displacements of the bonded block on the finest mesh, `race/bonded_block.json`.
pub static FINEST_BLOCK: &str = include_str!("../race/bonded_block.json");

/// Times of the finite-element codes, `race/timings.json`.
pub static RACE_TIMINGS: &str = include_str!("../race/timings.json");

/// Body forces that SymPy derived for the manufactured solutions, `manufactured/body_force.json`.
pub static MANUFACTURED_BODY_FORCES: &str = include_str!("../manufactured/body_force.json");
