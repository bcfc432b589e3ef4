//! A law of the caller's own, given by its strain energy alone.
#![allow(non_snake_case)]

use crate::algebra::real::{Dual, Real};
use crate::algebra::tensor::{Matrix3, Tensor, map};
use crate::material::constants::{ElasticConstants, MaterialError};
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};
use std::fmt::Debug;

/// A number with its derivatives in two directions and the mixed second one: what an energy is
/// computed with, so that stress and tangent follow exactly (method book, eq. 3.19).
pub type Number = Dual<Dual<f64>>;

/// A strain energy per reference volume, by which a body of the caller's own material is solved.
pub trait StrainEnergy: Debug + Send + Sync {
    /// ψ(C) \[Pa\] of the right Cauchy–Green tensor C = FᵀF \[–\], 0 and stationary at C = I. It
    /// must depend on the tensor as a whole: both of two equal entries beside the diagonal count.
    fn energy(&self, C: &[[Number; 3]; 3]) -> Number;
}

/// A law given by a [`StrainEnergy`]. A point costs six evaluations of the energy, one after the
/// other: ten to a hundred times as much as a law of this crate.
#[derive(Debug, Clone, Copy)]
pub struct OwnLaw {
    energy: &'static dyn StrainEnergy,
    constants: ElasticConstants,
}

impl PartialEq for OwnLaw {
    fn eq(&self, other: &OwnLaw) -> bool {
        std::ptr::addr_eq(self.energy, other.energy)
    }
}

/// Stress at rest over the largest modulus that is round-off \[–\].
const AT_REST: f64 = 1e-9;
/// Entries of a symmetric tensor.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

impl OwnLaw {
    /// Keeps the energy for the rest of the program, and takes the moduli at rest from it; refused
    /// where it has a stress at rest, or moduli that are not positive. Of an anisotropic law the
    /// shear modulus is that of the stiffest direction, which is what bounds the time step.
    pub fn new(energy: impl StrainEnergy + 'static) -> Result<OwnLaw, MaterialError> {
        let energy: &'static dyn StrainEnergy = Box::leak(Box::new(energy));
        let rest = map(|i, j| constant(if i == j { 1.0 } else { 0.0 }));
        let stress = |entry: usize| {
            let mut C = rest;
            let (i, j) = ENTRIES[entry];
            C[i][j].slope = 1.0;
            C[j][i].slope = 1.0;
            second_piola_kirchhoff(energy, &C)
        };
        let stresses = [0, 1, 2, 3, 4, 5].map(stress);
        // E = 1/2 in the direction, for entries beside the diagonal in both.
        let normal = |i: usize, j: usize| 2.0 * stresses[i][j][j].slope;
        let shear = |entry: usize| {
            let (i, j) = ENTRIES[entry];
            stresses[entry][i][j].slope
        };
        let all = (0..9).map(|n| normal(n / 3, n % 3));
        let bulk_modulus = all.sum::<f64>() / 9.0;
        let steepest = (0..3).map(|k| normal(k, k)).fold(f64::NEG_INFINITY, f64::max);
        let shear_modulus = (3..6).map(shear).fold(0.75 * (steepest - bulk_modulus), f64::max);
        let constants = ElasticConstants::from_shear_bulk(shear_modulus, bulk_modulus)?;
        let largest = ENTRIES.iter().map(|&(i, j)| stresses[0][i][j].value.abs());
        let largest = largest.fold(0.0, f64::max);
        if largest.is_nan() || largest > AT_REST * steepest {
            return Err(MaterialError::StressAtRest { stress: largest });
        }
        Ok(OwnLaw { energy, constants })
    }
}

/// A number that does not change.
fn constant(value: f64) -> Dual<f64> {
    Dual { value, slope: 0.0 }
}

fn numbers(entry: impl Fn(usize, usize) -> Number) -> [[Number; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// S = 2 ∂ψ/∂C \[Pa\], with its derivative in the direction that C changes in.
fn second_piola_kirchhoff(energy: &dyn StrainEnergy, C: &Tensor<Dual<f64>>) -> Tensor<Dual<f64>> {
    let mut S = *C;
    for (i, j) in ENTRIES {
        let one = |k: usize, l: usize| {
            let changes = (k, l) == (i, j) || (l, k) == (i, j);
            Dual { value: C[k][l], slope: constant(f64::from(u8::from(changes))) }
        };
        let slope = energy.energy(&numbers(one)).slope;
        // Beside the diagonal both entries have changed.
        let own = if i == j { slope * 2.0 } else { slope };
        (S[i][j], S[j][i]) = (own, own);
    }
    S
}

impl ConstitutiveLaw for OwnLaw {
    fn strain_energy(&self, F: &Matrix3) -> f64 {
        let C = F.transpose() * F;
        let fixed = numbers(|i, j| C[(i, j)].into());
        self.energy.energy(&fixed).value.value
    }

    /// P = F S, point after point.
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R> {
        let stress = |F: &Tensor<Dual<f64>>| {
            let C = map(|i, j| (0..3).map(|k| F[k][i] * F[k][j]).fold(constant(0.0), |a, b| a + b));
            let S = second_piola_kirchhoff(self.energy, &C);
            map(|i, j| (0..3).map(|k| F[i][k] * S[k][j]).fold(constant(0.0), |a, b| a + b))
        };
        R::one_by_one(&state.F, &stress)
    }

    fn constants(&self) -> ElasticConstants {
        self.constants
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Law, MooneyRivlin, NeoHookeanLogJ};
    use proptest::prelude::*;

    /// The energy of NeoHookeanLogJ, with an error of choice.
    #[derive(Debug)]
    struct LogJ {
        shear: f64,
        lame: f64,
        prestress: f64,
    }

    /// det C.
    pub fn determinant(C: &[[Number; 3]; 3]) -> Number {
        let minor = |a: usize, b: usize| C[1][a] * C[2][b] - C[1][b] * C[2][a];
        C[0][0] * minor(1, 2) - C[0][1] * minor(0, 2) + C[0][2] * minor(0, 1)
    }

    impl StrainEnergy for LogJ {
        fn energy(&self, C: &[[Number; 3]; 3]) -> Number {
            let log = determinant(C).ln() * 0.5;
            let first = C[0][0] + C[1][1] + C[2][2] - 3.0;
            first * (0.5 * self.shear) - log * (self.shear - self.prestress)
                + log * log * (0.5 * self.lame)
        }
    }

    /// That of MooneyRivlin.
    #[derive(Debug)]
    struct Rubber([f64; 4]);

    impl StrainEnergy for Rubber {
        fn energy(&self, C: &[[Number; 3]; 3]) -> Number {
            let [a, b, c, d] = self.0;
            let first = C[0][0] + C[1][1] + C[2][2];
            let squares = C.iter().flatten().map(|entry| *entry * *entry);
            let squares = squares.reduce(|a, b| a + b).unwrap_or(first);
            let second = (first * first - squares) * 0.5;
            let third = determinant(C);
            let inverse = Number::from(1.0) / (third * third);
            let swollen = third - 1.0;
            (first - 3.0) * a + (second - 3.0) * b + (inverse - 1.0) * c + swollen * swollen * d
        }
    }

    fn pairs() -> [(Law, Law); 2] {
        let constants = ElasticConstants::from_young_poisson(3000.0, 0.3).unwrap();
        let (shear, lame) = (constants.shear_modulus, constants.lame_modulus());
        let own = OwnLaw::new(LogJ { shear, lame, prestress: 0.0 }).unwrap();
        let (a, b, nu) = (800.0, 252.0, 0.47);
        let d = (a * (5.0 * nu - 2.0) + b * (11.0 * nu - 5.0)) / (2.0 * (1.0 - 2.0 * nu));
        let rubber = OwnLaw::new(Rubber([a, b, 0.5 * a + b, d])).unwrap();
        [
            (Law::Own(own), Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants))),
            (Law::Own(rubber), Law::MooneyRivlin(MooneyRivlin::new(a, b, nu).unwrap())),
        ]
    }

    #[test]
    fn the_moduli_at_rest_follow_from_the_energy() {
        for (own, known) in pairs() {
            let (own, known) = (own.constants(), known.constants());
            approx::assert_relative_eq!(
                own.shear_modulus,
                known.shear_modulus,
                max_relative = 1e-12
            );
            approx::assert_relative_eq!(own.bulk_modulus, known.bulk_modulus, max_relative = 1e-12);
        }
    }

    #[test]
    fn an_energy_with_a_stress_at_rest_is_refused() {
        let refused = OwnLaw::new(LogJ { shear: 1000.0, lame: 2000.0, prestress: 1.0 });
        assert!(matches!(refused, Err(MaterialError::StressAtRest { stress }) if stress > 0.9));
        let refused = OwnLaw::new(LogJ { shear: -1000.0, lame: 2000.0, prestress: 0.0 });
        assert!(matches!(refused, Err(MaterialError::NotPositive { .. })));
    }

    proptest! {
        #[test]
        fn stress_and_tangent_are_those_of_the_same_law_written_out(
            entries in prop::array::uniform9(-0.2..0.2f64),
            slopes in prop::array::uniform9(-1.0..1.0f64),
        ) {
            let F = map(|i, j| {
                let value = entries[3 * i + j] + if i == j { 1.0 } else { 0.0 };
                Dual { value, slope: slopes[3 * i + j] }
            });
            for (own, known) in pairs() {
                let state = Deformation::new(F);
                let P = crate::material::with_law!(&own, law => law.first_piola_kirchhoff(&state));
                let Q = crate::material::with_law!(&known, law => law.first_piola_kirchhoff(&state));
                let scale = known.constants().bulk_modulus;
                for (p, q) in P.iter().flatten().zip(Q.iter().flatten()) {
                    prop_assert!((p.value - q.value).abs() < 1e-11 * scale, "{p:?} {q:?}");
                    prop_assert!((p.slope - q.slope).abs() < 1e-10 * scale, "{p:?} {q:?}");
                }
            }
        }
    }
}
