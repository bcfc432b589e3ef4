//! Pairs of elastic constants at rest and the conditions that they must meet.

/// Shear modulus μ and bulk modulus K at rest \[Pa\], both positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticConstants {
    /// μ \[Pa\]
    pub shear_modulus: f64,
    /// K \[Pa\]
    pub bulk_modulus: f64,
}

/// Why a set of material parameters is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name every field")]
pub enum MaterialError {
    #[error("{name} is {value}; it must be positive and finite")]
    NotPositive { name: &'static str, value: f64 },
    #[error(
        "poisson_ratio is {value}; it must lie in -1 < ν < 0.5 (0.499 for nearly incompressible tissue)"
    )]
    PoissonRatio { value: f64 },
    #[error(
        "lame_modulus {lame_modulus} Pa with shear_modulus {shear_modulus} Pa gives a bulk modulus of {bulk_modulus} Pa; it must be positive"
    )]
    BulkModulus { lame_modulus: f64, shear_modulus: f64, bulk_modulus: f64 },
    #[error(
        "the Mooney-Rivlin rubber with A = {a} Pa, B = {b} Pa, ν = {poisson_ratio} has D = {d} Pa < 0 and loses its stiffness in tension; use ν ≥ {smallest:.4} or a neo-Hookean law"
    )]
    UnstableRubber { a: f64, b: f64, poisson_ratio: f64, d: f64, smallest: f64 },
    #[error("{given} constants are given; the law takes {taken}")]
    Constants { given: usize, taken: usize },
    #[error("{name} is {value}; it must not be negative")]
    Negative { name: &'static str, value: f64 },
    #[error("kappa is {value}; it must lie in 0 ≤ κ ≤ 1/3, from aligned fibres to none")]
    Dispersion { value: f64 },
    #[error("angle is {value}; it must be finite")]
    Angle { value: f64 },
    #[error(
        "Yeoh's law with C1 = {c1} Pa, C2 = {c2} Pa, C3 = {c3} Pa loses its stiffness at large stretches; C1 + 2 C2 x + 3 C3 x² must be positive for all x ≥ 0: C3 ≥ 0, and C2 > -√(3 C1 C3)"
    )]
    UnstableYeoh { c1: f64, c2: f64, c3: f64 },
    #[error("terms has {count} entries; Ogden's law takes one to three")]
    OgdenTerms { count: usize },
    #[error("alpha is {value}; it must be finite and not 0")]
    OgdenExponent { value: f64 },
    #[error("prony has {count} terms; it takes one to {most}")]
    PronyTerms { count: usize, most: usize },
    #[error(
        "the parts g of prony sum to {sum}; they must sum to less than 1, or nothing is left in the end"
    )]
    PronySum { sum: f64 },
    #[error("the strain energy has a stress of {stress:e} Pa at rest; it must be stationary there")]
    StressAtRest { stress: f64 },
}

impl ElasticConstants {
    /// From Young's modulus E \[Pa\] and Poisson's ratio ν \[–\]:
    /// μ = E/2(1 + ν), K = E/3(1 − 2ν) (method book, eq. 3.1).
    pub fn from_young_poisson(
        young_modulus: f64,
        poisson_ratio: f64,
    ) -> Result<Self, MaterialError> {
        positive("young_modulus", young_modulus)?;
        if !(poisson_ratio > -1.0 && poisson_ratio < 0.5) {
            return Err(MaterialError::PoissonRatio { value: poisson_ratio });
        }
        Ok(ElasticConstants {
            shear_modulus: young_modulus / (2.0 * (1.0 + poisson_ratio)),
            bulk_modulus: young_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio)),
        })
    }

    /// From the first Lamé modulus λ and μ \[Pa\]: K = λ + 2μ/3.
    pub fn from_lame_shear(lame_modulus: f64, shear_modulus: f64) -> Result<Self, MaterialError> {
        positive("shear_modulus", shear_modulus)?;
        let bulk_modulus = lame_modulus + 2.0 / 3.0 * shear_modulus;
        if !(bulk_modulus > 0.0 && bulk_modulus.is_finite()) {
            return Err(MaterialError::BulkModulus { lame_modulus, shear_modulus, bulk_modulus });
        }
        Ok(ElasticConstants { shear_modulus, bulk_modulus })
    }

    /// From μ and K \[Pa\].
    pub fn from_shear_bulk(shear_modulus: f64, bulk_modulus: f64) -> Result<Self, MaterialError> {
        positive("shear_modulus", shear_modulus)?;
        positive("bulk_modulus", bulk_modulus)?;
        Ok(ElasticConstants { shear_modulus, bulk_modulus })
    }

    /// From μ \[Pa\] and ν: K = 2μ(1 + ν)/3(1 − 2ν).
    pub fn from_shear_poisson(
        shear_modulus: f64,
        poisson_ratio: f64,
    ) -> Result<Self, MaterialError> {
        let unit = Self::from_young_poisson(1.0, poisson_ratio)?;
        positive("shear_modulus", shear_modulus)?;
        let bulk_modulus = unit.bulk_modulus / unit.shear_modulus * shear_modulus;
        Ok(ElasticConstants { shear_modulus, bulk_modulus })
    }

    /// First Lamé modulus λ = K − 2μ/3 \[Pa\].
    pub fn lame_modulus(&self) -> f64 {
        self.bulk_modulus - 2.0 / 3.0 * self.shear_modulus
    }

    /// Young's modulus E = 9Kμ/(3K + μ) \[Pa\].
    pub fn young_modulus(&self) -> f64 {
        let (mu, k) = (self.shear_modulus, self.bulk_modulus);
        9.0 * k * mu / (3.0 * k + mu)
    }

    /// Poisson's ratio ν = (3K − 2μ)/2(3K + μ) \[–\].
    pub fn poisson_ratio(&self) -> f64 {
        let (mu, k) = (self.shear_modulus, self.bulk_modulus);
        (3.0 * k - 2.0 * mu) / (2.0 * (3.0 * k + mu))
    }
}

/// Refuses a parameter that is not a positive number.
pub(super) fn positive(name: &'static str, value: f64) -> Result<(), MaterialError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(MaterialError::NotPositive { name, value })
    }
}
