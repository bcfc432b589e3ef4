//! The laws by the names that case files and other programs know them by.

use crate::material::constants::{ElasticConstants, MaterialError};
use crate::material::isochoric::{
    Constant, Demiray, Guccione, HolzapfelGasserOgden, HolzapfelOgden, Isochoric, ShapeEnergy, Yeoh,
};
use crate::material::law::Law;
use crate::material::linear_elastic::LinearElastic;
use crate::material::neo_hookean_isochoric::NeoHookeanIsochoric;
use crate::material::neo_hookean_log_j::NeoHookeanLogJ;
use crate::material::st_venant_kirchhoff::StVenantKirchhoff;
use crate::material::volumetric_term::VolumetricTerm;

/// A law by its name.
#[derive(Debug)]
pub struct NamedLaw {
    /// In case files.
    pub name: &'static str,
    /// ψ per reference volume \[Pa\]; `U(J)` stands for the volumetric energy.
    pub energy: &'static str,
    /// What it is made from.
    pub takes: Takes,
}

/// What a law is made from.
#[derive(Debug)]
pub enum Takes {
    /// A pair of elastic constants.
    Pair(fn(ElasticConstants) -> Law),
    /// A pair of elastic constants, and a volumetric energy.
    PairAndVolumetric(fn(ElasticConstants, VolumetricTerm) -> Law),
    /// A, B \[Pa\] and Poisson's ratio of [`MooneyRivlin`](crate::material::MooneyRivlin).
    Rubber,
    /// The terms of [`Ogden`](crate::material::Ogden), a bulk modulus, and a volumetric energy.
    Terms,
    /// Constants by their names, a bulk modulus, and a volumetric energy.
    Constants(NamedConstants),
}

/// A law of constants by their names.
#[derive(Debug)]
pub struct NamedConstants {
    /// In the order in which the functions below take their values.
    pub constants: &'static [Constant],
    /// Whether it depends on the directions of fibres.
    pub has_fibres: bool,
    /// [`ShapeEnergy::shear_modulus`] for these values.
    pub shear_modulus: fn(&[f64]) -> Result<f64, MaterialError>,
    /// The law of these values, a bulk modulus at rest \[Pa\] and a volumetric energy.
    pub law: fn(&[f64], f64, VolumetricTerm) -> Result<Law, MaterialError>,
}

/// The entry of a law ψ̄(C̄) + U(J), whose variant is called as its energy is.
macro_rules! isochoric {
    ($shape:ident) => {
        NamedLaw {
            name: $shape::NAME,
            energy: $shape::ENERGY,
            takes: Takes::Constants(NamedConstants {
                constants: $shape::CONSTANTS,
                has_fibres: $shape::HAS_FIBRES,
                shear_modulus: |values| Ok($shape::new(values)?.shear_modulus()),
                law: |values, bulk_modulus, volumetric| {
                    let shape = $shape::new(values)?;
                    Ok(Law::$shape(Isochoric::new(shape, bulk_modulus, volumetric)?))
                },
            }),
        }
    };
}

/// Every law that has a name.
pub const LAWS: &[NamedLaw] = &[
    NamedLaw {
        name: "mooney_rivlin",
        energy: "A(I−3) + B(II−3) + C(III⁻²−1) + D(III−1)²",
        takes: Takes::Rubber,
    },
    NamedLaw {
        name: "neo_hookean_log_j",
        energy: "μ/2 (I₁−3) − μ ln J + λ/2 (ln J)²",
        takes: Takes::Pair(|constants| Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants))),
    },
    NamedLaw {
        name: "neo_hookean_isochoric",
        energy: "μ/2 (J^(−2/3) I₁ − 3) + U(J)",
        takes: Takes::PairAndVolumetric(|constants, volumetric| {
            Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(constants, volumetric))
        }),
    },
    NamedLaw {
        name: "ogden",
        energy: "Σ 2μ/α² (λ̄₁^α + λ̄₂^α + λ̄₃^α − 3) + U(J), λ̄ = J^(−1/3) λ",
        takes: Takes::Terms,
    },
    isochoric!(Yeoh),
    isochoric!(Demiray),
    isochoric!(Guccione),
    isochoric!(HolzapfelGasserOgden),
    isochoric!(HolzapfelOgden),
    NamedLaw {
        name: "st_venant_kirchhoff",
        energy: "λ/2 (tr E)² + μ E:E",
        takes: Takes::Pair(|constants| Law::StVenantKirchhoff(StVenantKirchhoff::new(constants))),
    },
    NamedLaw {
        name: "linear_elastic",
        energy: "λ/2 (tr ε)² + μ ε:ε, small displacements only",
        takes: Takes::Pair(|constants| Law::LinearElastic(LinearElastic::new(constants))),
    },
];
