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
    "inflated_tube"
    "parted_arms"
    "rubber_block"
    "smooth_compressible"
    "smooth_nearly_incompressible"
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

/// A problem that others have published, with its numbers.
#[derive(Debug)]
pub struct Published {
    /// Name of its folder.
    pub name: &'static str,
    /// (name, text) of its case files; others are bundled cases or bodies with fibres.
    pub cases: &'static [(&'static str, &'static str)],
    /// Text of its `numbers.toml`.
    pub numbers: &'static str,
}

/// Includes the files of published problems.
macro_rules! published {
    ($($name:literal: $($case:literal)*;)*) => {
        /// The problems in `published`.
        pub static PUBLISHED: &[Published] = &[$(Published {
            name: $name,
            cases: &[$((
                $case,
                include_str!(concat!("../published/", $name, "/", $case, ".toml")),
            )),*],
            numbers: include_str!(concat!("../published/", $name, "/numbers.toml")),
        }),*];
    };
}

published! {
    "bending_column": "case";
    "block_on_sphere": "case";
    "bouncing_ball": "case";
    "cantilever_vibration": "load_50" "load_80";
    "cook_membrane":;
    "curved_cantilever": "case";
    "elastica": "load_1" "load_10" "load_5";
    "euler_column": "above" "below" "far_above";
    "free_cube": "nu_030" "nu_049" "nu_0499";
    "indented_layer": "case";
    "l_block": "case";
    "land_1":;
    "land_2": "case";
    "land_3": "case";
    "plate_strip": "case";
    "reese_block": "load_20" "load_40" "load_60" "load_80";
    "rubber_seal": "half_stroke" "whole_stroke";
    "spinning_cube": "case";
    "thick_cylinder": "demiray" "neo_hookean" "yeoh";
    "thick_sphere": "demiray" "mooney_rivlin" "neo_hookean";
    "turek_hron":;
    "twisted_beam": "along_y" "along_z";
    "twisting_column": "case";
    "uniaxial_energy": "case";
}

/// (file, text) of what their cases name.
pub static PUBLISHED_FILES: &[(&str, &str)] = &[
    ("twisted_beam.obj", include_str!("../published/twisted_beam/twisted_beam.obj")),
    ("fibres.csv", include_str!("../published/land_3/fibres.csv")),
];

/// (file, bytes) of the label maps in `brain`.
pub static LABEL_MAPS: &[(&str, &[u8])] = &[
    ("brain.nrrd", include_bytes!("../brain/brain.nrrd")),
    ("slice.nrrd", include_bytes!("../brain/slice.nrrd")),
];

/// Displacements of the bonded block on the finest mesh, `finest/bonded_block.json`.
pub static FINEST_BLOCK: &str = include_str!("../finest/bonded_block.json");

/// Who races on which problems, `race.toml`.
pub static RACE: &str = include_str!("../race.toml");

/// Body forces that SymPy derived for the manufactured solutions, `manufactured/body_force.json`.
pub static MANUFACTURED_BODY_FORCES: &str = include_str!("../manufactured/body_force.json");

/// Text of the identities of the problems of the benchmark.
pub static BENCHMARK: &str = include_str!("../benchmark.toml");
