//! How far the solver may be from the references.

/// What is wanted: relative to the largest value of a kind \[–\].
pub const WANTED: f64 = 0.02;

/// Limits of one case.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Why some limits are above what is wanted.
    pub why: &'static str,
    /// What is compared, and the largest relative difference without the
    /// reference's error bar \[–\].
    pub rows: &'static [(&'static str, f64)],
}

const ALL_WELL: &str = "";
const INDENTER: &str = "the force is too low: only nodes inside the disc are held, which may act like a disc whose \
     radius is half a spacing smaller. 11 % too low here, 7 % with half the spacing; holding \
     nodes up to half a spacing outside makes it 11 % too high. Other graded clouds move probes to 2.4 %";
const FOOT: &str = "the ball sags too much: the edge of the cap falls between nodes, and the held foot may act as up to \
     a spacing too small. The centre of mass is 19, 14 and 8 % too low with 1, 0.75 and 0.5 times the \
     spacing; it also moves sideways on a lattice, which the reference does not. On 21 families of clouds up to 20, \
     23 and 22 % in probes, centre and energy";
const TIP: &str = "the tip of the flag hangs 2 % short on lattices that are jittered by 2 %, 1.95 % on straight ones: \
     the flag is four spacings thick";
const RINGING: &str = "the reaction of an undamped body rings with the scheme";

const TABLE: &[(&str, Limits)] = &[
    (
        "bonded_block",
        Limits {
            why: ALL_WELL,
            rows: &[("displacement", WANTED), ("force", WANTED), ("strain_energy", WANTED)],
        },
    ),
    (
        "brain_cube_compression",
        Limits {
            why: ALL_WELL,
            rows: &[("displacement", WANTED), ("force", WANTED), ("strain_energy", WANTED)],
        },
    ),
    (
        "brain_cube_shear",
        Limits {
            why: ALL_WELL,
            rows: &[("displacement", WANTED), ("force", WANTED), ("strain_energy", WANTED)],
        },
    ),
    ("brain_slice", Limits { why: ALL_WELL, rows: &[("centre_of_mass", WANTED)] }),
    (
        "cook_membrane",
        Limits {
            why: ALL_WELL,
            rows: &[
                ("displacement", WANTED),
                ("force", WANTED),
                ("moment", WANTED),
                ("strain_energy", WANTED),
            ],
        },
    ),
    (
        "cube_compression",
        Limits {
            why: ALL_WELL,
            rows: &[("displacement", WANTED), ("force", WANTED), ("strain_energy", WANTED)],
        },
    ),
    (
        "cube_shear",
        Limits {
            why: ALL_WELL,
            rows: &[("displacement", WANTED), ("force", WANTED), ("strain_energy", WANTED)],
        },
    ),
    (
        "falling_beam",
        Limits {
            why: RINGING,
            rows: &[
                ("displacement", WANTED),
                ("centre_of_mass", WANTED),
                ("force", 0.026),
                ("strain_energy", WANTED),
            ],
        },
    ),
    (
        "indented_block",
        Limits {
            why: INDENTER,
            rows: &[("displacement", 0.022), ("force", 0.11), ("strain_energy", 0.108)],
        },
    ),
    (
        "soft_inclusion",
        Limits {
            why: ALL_WELL,
            rows: &[
                ("displacement", WANTED),
                ("centre_of_mass", WANTED),
                ("force", WANTED),
                ("strain_energy", WANTED),
            ],
        },
    ),
    (
        "sphere_gravity",
        Limits {
            why: FOOT,
            rows: &[
                ("displacement", 0.205),
                ("centre_of_mass", 0.235),
                ("force", WANTED),
                ("strain_energy", 0.215),
            ],
        },
    ),
    (
        "turek_hron_csm1",
        Limits {
            why: ALL_WELL,
            rows: &[
                ("displacement", WANTED),
                ("force", WANTED),
                ("moment", WANTED),
                ("strain_energy", WANTED),
            ],
        },
    ),
    (
        "turek_hron_csm2",
        Limits {
            why: TIP,
            rows: &[
                ("displacement", 0.021),
                ("force", WANTED),
                ("moment", WANTED),
                ("strain_energy", WANTED),
            ],
        },
    ),
    (
        "turek_hron_csm3",
        Limits { why: ALL_WELL, rows: &[("displacement", WANTED), ("strain_energy", WANTED)] },
    ),
    (
        "twisted_cylinder",
        Limits {
            why: ALL_WELL,
            rows: &[
                ("displacement", WANTED),
                ("force", WANTED),
                ("moment", WANTED),
                ("strain_energy", WANTED),
            ],
        },
    ),
    (
        "uniaxial_bar",
        Limits {
            why: ALL_WELL,
            rows: &[("displacement", WANTED), ("force", WANTED), ("strain_energy", WANTED)],
        },
    ),
];

/// The limits of a case.
pub fn limits(case: &str) -> Option<Limits> {
    TABLE.iter().find(|(name, _)| *name == case).map(|(_, limits)| *limits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundled::CASES;

    #[test]
    fn every_case_has_limits_and_every_wide_one_a_reason() {
        for (name, _) in CASES {
            let Limits { why, rows } = limits(name).expect(name);
            let wide = rows.iter().any(|(_, limit)| *limit > WANTED);
            assert!(!rows.is_empty() && wide != why.is_empty(), "{name}");
        }
        assert_eq!(TABLE.len(), CASES.len());
    }
}
