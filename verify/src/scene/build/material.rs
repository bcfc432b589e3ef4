//! Materials and regions of a case file → those of the solver.

use crate::scene::build::builder::Builder;
use crate::scene::format::{CaseFormat, LawFormat, MaterialFormat};
use mtled::geometry::Selector;
use mtled::material::{
    ElasticConstants, Law, LinearElastic, Material, MaterialError, MooneyRivlin,
    NeoHookeanIsochoric, NeoHookeanLogJ, Ogden, OgdenTerm, OgdenTerms, StVenantKirchhoff,
    VolumetricTerm,
};
use mtled::problem::Region;
use std::collections::BTreeMap;

const PAIRS: &str = "young_modulus and poisson_ratio, lame_modulus and shear_modulus, \
                     or shear_modulus and bulk_modulus";

/// Constants that ogden takes one of.
const OF_OGDEN: [&str; 2] = ["poisson_ratio", "bulk_modulus"];

impl Builder<'_> {
    /// Regions with their materials; one region for a body of one material.
    pub fn regions(&mut self, format: &CaseFormat) -> Vec<Region> {
        let materials: BTreeMap<&str, Option<Material>> = (format.material.iter())
            .map(|(name, material)| (name.as_str(), self.material(name, material)))
            .collect();
        if materials.is_empty() {
            self.mistake("material", "is empty; the body needs a [material.NAME]");
        }
        if format.region.is_empty() {
            if materials.len() > 1 {
                let message = "has several entries; say with [[region]] where each of them is";
                self.mistake("material", message);
            }
            let material = materials.values().next().copied().flatten();
            return Vec::from_iter(material.map(|material| Region {
                name: "body".to_string(),
                part: Selector::All,
                material,
            }));
        }
        let rows = format.region.iter().enumerate();
        rows.filter_map(|(n, region)| {
            let key = format!("region[{n}]");
            let part = self.selector(&format!("{key}.where"), &region.part);
            let known: Vec<&str> = materials.keys().copied().collect();
            if !known.contains(&region.material.as_str()) {
                self.unknown_name(&format!("{key}.material"), "material", &region.material, &known);
            }
            let material = materials.get(region.material.as_str()).copied().flatten()?;
            Some(Region { name: region.name.clone(), part: part?, material })
        })
        .collect()
    }

    fn material(&mut self, name: &str, format: &MaterialFormat) -> Option<Material> {
        let key = format!("material.{name}");
        self.positive(&format!("{key}.density"), format.density);
        self.keys_of_law(&key, format);
        let law = match format.law {
            LawFormat::MooneyRivlin => Law::MooneyRivlin(self.rubber(&key, format)?),
            LawFormat::Ogden => Law::Ogden(self.ogden(&key, format)?),
            _ => law(format, self.constants(&key, format)?),
        };
        Some(Material { density: format.density, law })
    }

    /// Refuses keys that belong to another law.
    fn keys_of_law(&mut self, key: &str, format: &MaterialFormat) {
        let rubber = format.law == LawFormat::MooneyRivlin;
        for (name, value) in [("A", format.a), ("B", format.b)] {
            if value.is_some() && !rubber {
                self.mistake(&format!("{key}.{name}"), "belongs to law = \"mooney_rivlin\"");
            }
        }
        for (name, value) in constants_given(format) {
            if value.is_some() && rubber && name != "poisson_ratio" {
                let message =
                    "does not belong to mooney_rivlin, which takes A, B and poisson_ratio";
                self.mistake(&format!("{key}.{name}"), message);
            }
        }
        let split = matches!(format.law, LawFormat::NeoHookeanIsochoric | LawFormat::Ogden);
        if format.volumetric.is_some() && !split {
            let message = "belongs to law = \"neo_hookean_isochoric\" or \"ogden\"";
            self.mistake(&format!("{key}.volumetric"), message);
        }
        if format.terms.is_some() && format.law != LawFormat::Ogden {
            self.mistake(&format!("{key}.terms"), "belongs to law = \"ogden\"");
        }
    }

    fn ogden(&mut self, key: &str, format: &MaterialFormat) -> Option<Ogden> {
        let Some(rows) = &format.terms else {
            let message = "is missing; ogden needs terms such as [{ mu = 842.0, alpha = -4.7 }]";
            self.mistake(&format!("{key}.terms"), message);
            return None;
        };
        let terms: Vec<OgdenTerm> =
            rows.iter().map(|row| OgdenTerm { mu: row.mu, alpha: row.alpha }).collect();
        // One by one for the place of a mistake.
        for (n, term) in terms.iter().enumerate() {
            self.accept(&format!("{key}.terms[{n}]"), OgdenTerms::new(&[*term]))?;
        }
        let terms = self.accept(key, OgdenTerms::new(&terms))?;
        let given: Vec<(&str, f64)> = (constants_given(format).into_iter())
            .filter_map(|(name, value)| Some((name, value?)))
            .collect();
        let bulk_modulus = match given[..] {
            [("bulk_modulus", bulk_modulus)] => bulk_modulus,
            [("poisson_ratio", nu)] => {
                let mu = terms.shear_modulus();
                self.accept(key, ElasticConstants::from_shear_poisson(mu, nu))?.bulk_modulus
            }
            _ => {
                let wrong = given.iter().find(|(name, _)| !OF_OGDEN.contains(name));
                let (name, message) = match (wrong, given.is_empty()) {
                    (Some((name, _)), _) => (*name, "does not belong to ogden, which takes terms"),
                    (None, true) => ("poisson_ratio", "is missing; ogden takes terms"),
                    (None, false) => ("bulk_modulus", "cannot be used; ogden takes terms"),
                };
                let message = format!("{message} and either poisson_ratio or bulk_modulus");
                self.mistake(&format!("{key}.{name}"), message);
                return None;
            }
        };
        let volumetric = format.volumetric.map_or(VolumetricTerm::Quadratic, Into::into);
        self.accept(key, Ogden::new(terms, bulk_modulus, volumetric))
    }

    fn rubber(&mut self, key: &str, format: &MaterialFormat) -> Option<MooneyRivlin> {
        let needed = [("A", format.a), ("B", format.b), ("poisson_ratio", format.poisson_ratio)];
        for (name, value) in needed {
            if value.is_none() {
                self.mistake(&format!("{key}.{name}"), "is missing; mooney_rivlin needs it");
            }
        }
        let rubber = MooneyRivlin::new(format.a?, format.b?, format.poisson_ratio?);
        self.accept(key, rubber)
    }

    fn constants(&mut self, key: &str, format: &MaterialFormat) -> Option<ElasticConstants> {
        let given: Vec<(&str, f64)> = (constants_given(format).into_iter())
            .filter_map(|(name, value)| Some((name, value?)))
            .collect();
        let made = match given[..] {
            [("young_modulus", e), ("poisson_ratio", nu)] => {
                ElasticConstants::from_young_poisson(e, nu)
            }
            [("lame_modulus", lambda), ("shear_modulus", mu)] => {
                ElasticConstants::from_lame_shear(lambda, mu)
            }
            [("shear_modulus", mu), ("bulk_modulus", k)] => {
                ElasticConstants::from_shear_bulk(mu, k)
            }
            _ => {
                self.not_a_pair(key, &given);
                return None;
            }
        };
        self.accept(key, made)
    }

    fn not_a_pair(&mut self, key: &str, given: &[(&str, f64)]) {
        let names: Vec<&str> = given.iter().map(|(name, _)| *name).collect();
        match names.last() {
            None => self.mistake(key, format!("has no elastic constants; give {PAIRS}")),
            Some(last) => {
                let message = format!("{} cannot be used; give {PAIRS}", names.join(" with "));
                self.mistake(&format!("{key}.{last}"), message);
            }
        }
    }

    /// Turns a refusal of the solver into a mistake at the parameter.
    fn accept<T>(&mut self, key: &str, made: Result<T, MaterialError>) -> Option<T> {
        made.map_err(|error| {
            let name = match error {
                MaterialError::NotPositive { name, .. } => name,
                MaterialError::BulkModulus { .. } => "lame_modulus",
                MaterialError::OgdenTerms { .. } => "terms",
                MaterialError::OgdenExponent { .. } => "alpha",
                _ => "poisson_ratio",
            };
            let message = error.to_string();
            let message = message.strip_prefix(&format!("{name} ")).unwrap_or(&message).to_string();
            self.mistake(&format!("{key}.{name}"), message);
        })
        .ok()
    }
}

/// The elastic constants in the order of the pairs.
fn constants_given(format: &MaterialFormat) -> [(&'static str, Option<f64>); 5] {
    [
        ("young_modulus", format.young_modulus),
        ("poisson_ratio", format.poisson_ratio),
        ("lame_modulus", format.lame_modulus),
        ("shear_modulus", format.shear_modulus),
        ("bulk_modulus", format.bulk_modulus),
    ]
}

/// A law of two constants; mooney_rivlin and ogden are made elsewhere.
fn law(format: &MaterialFormat, constants: ElasticConstants) -> Law {
    match format.law {
        LawFormat::NeoHookeanIsochoric => {
            let volumetric = format.volumetric.map_or(VolumetricTerm::Quadratic, Into::into);
            Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(constants, volumetric))
        }
        LawFormat::StVenantKirchhoff => Law::StVenantKirchhoff(StVenantKirchhoff::new(constants)),
        LawFormat::LinearElastic => Law::LinearElastic(LinearElastic::new(constants)),
        LawFormat::NeoHookeanLogJ | LawFormat::MooneyRivlin | LawFormat::Ogden => {
            Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants))
        }
    }
}
