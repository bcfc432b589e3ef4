//! What a reader must know of the race.

use super::finite_elements::{RIVALS, Rivals};
use super::{Field, Race};
use crate::machine::provenance;
use mtled_checks::report::four_digits;

const TIMING: &str = "Every run is a process of its own with one thread. CPU time is that of the process \
    and its children: of mtled all of the process up to the solution; of the others without the start of \
    the interpreter and its imports and without the generation of kernels, which are listed beside it. \
    Reading the lattice off the solution is counted nowhere. Peak memory is that of the whole process.";

const FAIRNESS: &str = "All codes mesh the whole body evenly and use no symmetry. The finite-element codes \
    apply the load in the fewest steps that converge (attempts that fail are not counted) and stop at a \
    residual of 1e-4; FEniCSx compiles its kernels with -O3 -march=native -ffast-math. P and Q are \
    tetrahedra and hexahedra of an order; Q1/P0 and Q2/P1 have pressure and dilatation as discontinuous \
    fields of their own.";

const INTERPOLATION: &str = "Costs at equal error are interpolated, log-log, between neighbours of a \
    family where it first gets that good from coarse to fine; \"<\" marks an error that the coarsest run \
    already undercuts. Nothing is extrapolated.";

pub fn notes(race: &Race, rivals: &Rivals, fields: &[Field]) -> Vec<String> {
    let here = provenance();
    let mut notes = vec![
        format!(
            "{}, {}; {} rounds in which all codes take turns, medians.",
            here.processor, here.date, race.repetitions
        ),
        TIMING.to_string(),
        FAIRNESS.to_string(),
        INTERPOLATION.to_string(),
    ];
    notes.extend(fields.iter().filter(|field| field.uncertainty > 0.0).map(uncertainty));
    for known in rivals.descriptions() {
        notes.push(format!("{} {}: {}.", known.code.title(), known.version, known.solver));
    }
    notes.extend(absence(rivals));
    notes
}

fn uncertainty(field: &Field) -> String {
    format!(
        "{}: errors are distances from a solution of FEniCSx with 24 quadratic three-field hexahedra \
         along an edge, on a lattice of 11³ points. Since the bonded edges are singular no element \
         converges faster than with the first power of its size, and that solution itself may be off by \
         {} {} rms.",
        field.challenge.title(),
        four_digits(field.uncertainty),
        field.challenge.unit()
    )
}

fn absence(rivals: &Rivals) -> Option<String> {
    let absent: Vec<&str> =
        RIVALS.iter().filter(|code| !rivals.is_here(**code)).map(|code| code.title()).collect();
    (!absent.is_empty()).then(|| {
        format!(
            "Not run here: {}. Their timings are stored ones, from {} on {}: another day and perhaps \
             another machine, so that ratios of times are a guide only.",
            absent.join(", "),
            rivals.stored.date,
            rivals.stored.processor
        )
    })
}
