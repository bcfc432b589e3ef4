//! Ogden's law with one to three terms and one of two volumetric terms.
#![allow(non_snake_case)]

use crate::algebra::real::Real;
use crate::algebra::spectral::{Scalar, eigen};
use crate::algebra::tensor::{Matrix3, Tensor, map, right_cauchy_green, tensor, times_symmetric};
use crate::material::constants::{ElasticConstants, MaterialError, positive};
use crate::material::constitutive_law::{ConstitutiveLaw, Deformation};
use crate::material::volumetric_term::VolumetricTerm;

/// One term 2μ/α² (λ̄₁^α + λ̄₂^α + λ̄₃^α − 3) of [`Ogden`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OgdenTerm {
    /// Its part of the shear modulus at rest \[Pa\].
    pub mu: f64,
    /// \[–\], not 0; negative where tissue is stiffer in compression than in tension.
    pub alpha: f64,
}

/// Σ_i 2μ_i/α_i² (λ̄₁^α_i + λ̄₂^α_i + λ̄₃^α_i − 3), the part of [`Ogden`] that resists a
/// change of shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OgdenTerms {
    terms: [OgdenTerm; OgdenTerms::MOST],
    count: usize,
}

/// ψ = Σ_i 2μ_i/α_i² (λ̄₁^α_i + λ̄₂^α_i + λ̄₃^α_i − 3) + U(J) \[Pa\] with λ̄_k = J^(−1/3) λ_k
/// (Ogden 1972; method book, eq. 3.14). The factor 2/α² is that of Miller, Chinzei 2002; in
/// that of Ogden, μ_i/α_i, the shear modulus is Σ μ_i α_i/2, here it is Σ μ_i.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ogden {
    terms: OgdenTerms,
    bulk_modulus: f64,
    volumetric: VolumetricTerm,
}

impl OgdenTerms {
    /// Terms at most.
    pub const MOST: usize = 3;

    /// One to three terms with μ_i > 0, without which the law would lose its stiffness, and
    /// finite α_i that are not 0.
    pub fn new(terms: &[OgdenTerm]) -> Result<Self, MaterialError> {
        let count = terms.len();
        if count == 0 || count > OgdenTerms::MOST {
            return Err(MaterialError::OgdenTerms { count });
        }
        let mut padded = [OgdenTerm { mu: 0.0, alpha: 2.0 }; OgdenTerms::MOST];
        for (term, given) in padded.iter_mut().zip(terms) {
            positive("mu", given.mu)?;
            if given.alpha == 0.0 || !given.alpha.is_finite() {
                return Err(MaterialError::OgdenExponent { value: given.alpha });
            }
            *term = *given;
        }
        Ok(OgdenTerms { terms: padded, count })
    }

    /// Shear modulus at rest μ = Σ μ_i \[Pa\].
    pub fn shear_modulus(&self) -> f64 {
        self.given().iter().map(|term| term.mu).sum()
    }

    #[inline(always)]
    fn given(&self) -> &[OgdenTerm] {
        &self.terms[..self.count]
    }
}

/// The principal Kirchhoff stress h(c) = Σ_i 2μ_i/α_i (c^(α_i/2) − 1) \[Pa\] of the
/// eigenvalue c = λ̄² (method book, eq. 3.15). The constant changes the mean only, which
/// is removed, and keeps what is left exact at small strains.
impl Scalar for OgdenTerms {
    #[inline(always)]
    fn at(&self, c: f64) -> f64 {
        let logarithm = c.ln();
        let stress = |t: &OgdenTerm| 2.0 * t.mu / t.alpha * (0.5 * t.alpha * logarithm).exp_m1();
        self.given().iter().map(stress).sum()
    }

    #[inline(always)]
    fn divided_difference(&self, a: f64, b: f64) -> f64 {
        let (small, large) = if a < b { (a, b) } else { (b, a) };
        let ratio = (small - large) / large;
        // Of c^p: large^(p − 1) ((1 + r)^p − 1)/r, which is p large^(p − 1) for r → 0.
        let logarithm = ratio.ln_1p();
        let slope = |t: &OgdenTerm| {
            let power = 0.5 * t.alpha;
            let growth = if ratio == 0.0 { power } else { (power * logarithm).exp_m1() / ratio };
            2.0 * t.mu / t.alpha * large.powf(power - 1.0) * growth
        };
        self.given().iter().map(slope).sum()
    }
}

impl Ogden {
    /// From its terms, the bulk modulus at rest \[Pa\] and the volumetric energy.
    pub fn new(
        terms: OgdenTerms,
        bulk_modulus: f64,
        volumetric: VolumetricTerm,
    ) -> Result<Self, MaterialError> {
        positive("bulk_modulus", bulk_modulus)?;
        Ok(Ogden { terms, bulk_modulus, volumetric })
    }
}

impl ConstitutiveLaw for Ogden {
    fn strain_energy(&self, F: &Matrix3) -> f64 {
        let J = F.determinant();
        let (values, _) = eigen(&tensor(&(F.transpose() * F / J.cbrt().powi(2))));
        let logarithms = values.map(f64::ln);
        let term = |t: &OgdenTerm| {
            let powers = logarithms.map(|logarithm| (0.5 * t.alpha * logarithm).exp_m1());
            2.0 * t.mu / (t.alpha * t.alpha) * powers.iter().sum::<f64>()
        };
        self.terms.given().iter().map(term).sum::<f64>() + self.bulk_energy(J)
    }

    /// P = cof F [dev h(C̄)/J + U'(J) I], C̄ = J^(−2/3) C (method book, eq. 3.16).
    #[inline(always)]
    fn first_piola_kirchhoff<R: Real>(&self, state: &Deformation<R>) -> Tensor<R> {
        let Deformation { F, cof, J } = state;
        let (C, scale) = (right_cauchy_green(F), J.power_minus_two_thirds());
        let isochoric = map(
            #[inline(always)]
            |i, j| C[i][j] * scale,
        );
        let h = R::isotropic(&isochoric, &self.terms);
        let inverse = *J / (*J * *J);
        let mean = (h[0][0] + h[1][1] + h[2][2]) * (1.0 / 3.0);
        let volumetric = self.bulk_slope(*J) - mean * inverse;
        let inner = map(
            #[inline(always)]
            |i, j| if i == j { h[i][i].times_plus(inverse, volumetric) } else { h[i][j] * inverse },
        );
        times_symmetric(cof, &inner)
    }

    fn bulk_energy(&self, J: f64) -> f64 {
        self.volumetric.energy(self.bulk_modulus, J)
    }

    #[inline(always)]
    fn bulk_slope<R: Real>(&self, J: R) -> R {
        self.volumetric.slope(self.bulk_modulus, J)
    }

    fn constants(&self) -> ElasticConstants {
        ElasticConstants {
            shear_modulus: self.terms.shear_modulus(),
            bulk_modulus: self.bulk_modulus,
        }
    }
}
