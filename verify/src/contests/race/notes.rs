//! Notes on how the race was run.

use super::field::{Field, RaceSettings};
use super::finite_elements::FiniteElementCodes;
use super::race_run::FINITE_ELEMENT_CODES;
use crate::machine::provenance;
use mtled_checks::report::four_digits;

const TIMING: &str = "Every run has its own process with one thread. CPU time is that of the process and its \
    children: of mtled from its start to the solution; of the others without the start of the interpreter, \
    its imports and the generation of kernels, which are listed separately. Sampling the solution on the \
    lattice is not counted. Peak memory is that of the whole process.";

const FAIRNESS: &str = "All codes mesh the whole body evenly and use no symmetry. The finite-element codes \
    apply the load in the fewest steps that converge (attempts that fail are not counted) and stop at a \
    residual of 1e-4; FEniCSx compiles its kernels with -O3 -march=native -ffast-math. P and Q are \
    tetrahedra and hexahedra of an order; Q1/P0 and Q2/P1 have pressure and volume ratio as separate \
    discontinuous fields.";

const INTERPOLATION: &str = "Costs at equal error are interpolated logarithmically between the two \
    neighbouring runs of a family, from coarse to fine, where the error first falls below the given one; \
    \"<\" marks an upper bound, since the coarsest run is more accurate already. Nothing is extrapolated.";

pub fn notes(settings: &RaceSettings, codes: &FiniteElementCodes, fields: &[Field]) -> Vec<String> {
    let provenance = provenance();
    let mut notes = vec![
        format!(
            "{}, {}; medians of {} rounds of all codes.",
            provenance.processor, provenance.date, settings.repetitions
        ),
        TIMING.to_string(),
        FAIRNESS.to_string(),
        INTERPOLATION.to_string(),
    ];
    notes.extend(fields.iter().filter(|field| field.uncertainty > 0.0).map(uncertainty));
    for known in codes.descriptions() {
        notes.push(format!("{} {}: {}.", known.code.title(), known.version, known.solver));
    }
    notes.extend(absence(codes));
    notes
}

fn uncertainty(field: &Field) -> String {
    format!(
        "{}: errors are distances from a solution of FEniCSx with 24 quadratic three-field hexahedra \
         along an edge, on a lattice of 11³ points. Since the bonded edges are singular, no element \
         converges faster than with the first power of its size; the estimated error of that solution \
         itself is {} {} rms.",
        field.challenge.title(),
        four_digits(field.uncertainty),
        field.challenge.unit()
    )
}

fn absence(codes: &FiniteElementCodes) -> Option<String> {
    let absent: Vec<&str> = FINITE_ELEMENT_CODES
        .iter()
        .filter(|code| !codes.is_installed(**code))
        .map(|code| code.title())
        .collect();
    (!absent.is_empty()).then(|| {
        format!(
            "Not run here: {}. Their timings were stored on {} on {}, perhaps another machine: \
             ratios of times are a guide only.",
            absent.join(", "),
            codes.stored.date,
            codes.stored.processor
        )
    })
}
