//! Compressible Mooney–Rivlin rubber, as in LS-DYNA.
#![allow(non_snake_case)]

use crate::algebra::real::Real;
use crate::algebra::tensor::{Matrix3, Tensor, map, right_cauchy_green, times_symmetric};
use crate::material::constants::{ElasticConstants, MaterialError, positive};
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};

/// ψ = A(I − 3) + B(II − 3) + C(III⁻² − 1) + D(III − 1)² \[Pa\] with the
/// invariants of FᵀF (Horton 2007, section 3.3; method book, eq. 3.6).
///
/// C = A/2 + B, not A/B as printed there: the stress must vanish at rest.
/// D = [A(5ν − 2) + B(11ν − 5)]/[2(1 − 2ν)]; shear modulus 2(A + B).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MooneyRivlin {
    a: f64,
    b: f64,
    poisson_ratio: f64,
    c: f64,
    d: f64,
}

impl MooneyRivlin {
    /// From A > 0, B ≥ 0 \[Pa\] and ν; refused where D < 0 (ν < 0.4 at B = 0),
    /// since the law then loses its resistance to growth in volume.
    pub fn new(a: f64, b: f64, poisson_ratio: f64) -> Result<Self, MaterialError> {
        positive("A", a)?;
        if !(b >= 0.0 && b.is_finite()) {
            return Err(MaterialError::NotPositive { name: "B", value: b });
        }
        if !(poisson_ratio > -1.0 && poisson_ratio < 0.5) {
            return Err(MaterialError::PoissonRatio { value: poisson_ratio });
        }
        let d = (a * (5.0 * poisson_ratio - 2.0) + b * (11.0 * poisson_ratio - 5.0))
            / (2.0 * (1.0 - 2.0 * poisson_ratio));
        if d < 0.0 {
            let smallest = (2.0 * a + 5.0 * b) / (5.0 * a + 11.0 * b);
            return Err(MaterialError::UnstableRubber { a, b, poisson_ratio, d, smallest });
        }
        Ok(MooneyRivlin { a, b, poisson_ratio, c: 0.5 * a + b, d })
    }
}

impl ConstitutiveLaw for MooneyRivlin {
    fn strain_energy(&self, F: &Matrix3) -> f64 {
        let C = F.transpose() * F;
        let (first, third) = (C.trace(), C.determinant());
        let second = 0.5 * (first * first - C.dot(&C));
        self.a * (first - 3.0)
            + self.b * (second - 3.0)
            + self.c * (third.powi(-2) - 1.0)
            + self.d * (third - 1.0).powi(2)
    }

    /// P = 2A F + 2B (I F − F C) + [−4C J⁻⁵ + 4D J(J² − 1)] cof F.
    #[inline(always)]
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R> {
        let Deformation { F, cof, J } = state;
        let J2 = *J * *J;
        let volumetric = (J2 - 1.0) * *J * (4.0 * self.d) - *J / (J2 * J2 * J2) * (4.0 * self.c);
        let P = map(
            #[inline(always)]
            |i, j| cof[i][j].times_plus(volumetric, F[i][j] * (2.0 * self.a)),
        );
        if self.b == 0.0 {
            return P;
        }
        let C = right_cauchy_green(F);
        let (trace, FC) = (C[0][0] + C[1][1] + C[2][2], times_symmetric(F, &C));
        map(
            #[inline(always)]
            |i, j| P[i][j] + (F[i][j] * trace - FC[i][j]) * (2.0 * self.b),
        )
    }

    /// U = C(J⁻⁴ − 1) + D(J² − 1)² + 4C ln J: the last term removes the slope
    /// at rest, which balances that of the invariants (method book, eq. 3.9).
    fn bulk_energy(&self, J: f64) -> f64 {
        let J2 = J * J;
        self.c * (1.0 / (J2 * J2) - 1.0 + 4.0 * J.ln()) + self.d * (J2 - 1.0).powi(2)
    }

    #[inline(always)]
    fn bulk_slope<R: Real>(&self, J: R) -> R {
        let J2 = J * J;
        (J2 * J2 - 1.0) / (J2 * J2 * J) * (4.0 * self.c) + (J2 - 1.0) * J * (4.0 * self.d)
    }

    fn constants(&self) -> ElasticConstants {
        let shear_modulus = 2.0 * (self.a + self.b);
        let nu = self.poisson_ratio;
        ElasticConstants {
            shear_modulus,
            bulk_modulus: 2.0 * shear_modulus * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)),
        }
    }
}
