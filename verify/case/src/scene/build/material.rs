//! Materials and regions of a case file → those of the solver.

use crate::scene::build::builder::Builder;
use crate::scene::format::{CaseFormat, MaterialFormat};
use mtled::geometry::Selector;
use mtled::material::{
    ElasticConstants, Law, Material, MaterialError, MooneyRivlin, Ogden, OgdenTerm, OgdenTerms,
    Takes, VolumetricTerm,
};
use mtled::problem::Region;
use std::collections::BTreeMap;

const PAIRS: &str = "young_modulus and poisson_ratio, lame_modulus and shear_modulus, \
                     or shear_modulus and bulk_modulus";

impl Builder<'_> {
    /// Regions with their materials; one region for a body of one material.
    pub(crate) fn regions(&mut self, format: &CaseFormat) -> Vec<Region> {
        let materials: BTreeMap<&str, Option<Region>> = (format.material.iter())
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
            return materials.into_values().next().flatten().into_iter().collect();
        }
        let rows = format.region.iter().enumerate();
        rows.filter_map(|(n, region)| {
            let key = format!("region[{n}]");
            let part = self.selector(&format!("{key}.where"), &region.part);
            let known: Vec<&str> = materials.keys().copied().collect();
            if !known.contains(&region.material.as_str()) {
                self.unknown_name(&format!("{key}.material"), "material", &region.material, &known);
            }
            let known = materials.get(region.material.as_str()).cloned().flatten();
            Some(Region { name: region.name.clone(), part: part?, ..known? })
        })
        .collect()
    }

    /// A body of one material.
    fn material(&mut self, name: &str, format: &MaterialFormat) -> Option<Region> {
        let key = format!("material.{name}");
        self.positive(&format!("{key}.density"), format.density);
        self.keys_of_law(&key, format);
        let volumetric = format.volumetric.map(Into::into).unwrap_or_default();
        let law = match &format.law.0.takes {
            Takes::Rubber => Law::MooneyRivlin(self.rubber(&key, format)?),
            Takes::Pair(law) => law(self.constants(&key, format)?),
            Takes::PairAndVolumetric(law) => law(self.constants(&key, format)?, volumetric),
            Takes::Terms => Law::Ogden(self.ogden(&key, format, volumetric)?),
            Takes::Constants(named) => self.isochoric(&key, format, named, volumetric)?,
        };
        let before = self.count();
        let fibres = self.fibres(&key, format, &law);
        let viscosity = self.viscosity(&key, format, &law);
        let active = self.active_stress(&key, format);
        let material = Material { density: format.density, law };
        let body = Region::new("body", Selector::All, material);
        (self.count() == before).then_some(Region { fibres, viscosity, active, ..body })
    }

    /// Refuses keys that belong to another law.
    fn keys_of_law(&mut self, key: &str, format: &MaterialFormat) {
        let takes = &format.law.0.takes;
        let rubber = matches!(takes, Takes::Rubber);
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
        let named = matches!(takes, Takes::Constants(_));
        let split = named || matches!(takes, Takes::PairAndVolumetric(_) | Takes::Terms);
        if format.volumetric.is_some() && !split {
            let message =
                "belongs to law = \"neo_hookean_isochoric\" or \"ogden\", or one with constants";
            self.mistake(&format!("{key}.volumetric"), message);
        }
        if format.terms.is_some() && !matches!(takes, Takes::Terms) {
            self.mistake(&format!("{key}.terms"), "belongs to law = \"ogden\"");
        }
        if format.constants.is_some() && !named {
            let message = "belongs to yeoh, demiray and laws with fibres";
            self.mistake(&format!("{key}.constants"), message);
        }
    }

    fn ogden(
        &mut self,
        key: &str,
        format: &MaterialFormat,
        volumetric: VolumetricTerm,
    ) -> Option<Ogden> {
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
        let shear = Some(terms.shear_modulus());
        let bulk_modulus = self.bulk_modulus(key, ("ogden", "terms"), format, shear)?;
        self.accept(key, Ogden::new(terms, bulk_modulus, volumetric))
    }

    /// The bulk modulus \[Pa\] of a law by its name and what it takes besides; from Poisson's ratio
    /// where there is a shear modulus \[Pa\].
    pub(super) fn bulk_modulus(
        &mut self,
        key: &str,
        (law, takes): (&str, &str),
        format: &MaterialFormat,
        shear: Option<f64>,
    ) -> Option<f64> {
        let given: Vec<(&str, f64)> = (constants_given(format).into_iter())
            .filter_map(|(name, value)| Some((name, value?)))
            .collect();
        match (&given[..], shear) {
            ([("bulk_modulus", bulk_modulus)], _) => return Some(*bulk_modulus),
            ([("poisson_ratio", nu)], Some(shear)) => {
                let constants = ElasticConstants::from_shear_poisson(shear, *nu);
                return Some(self.accept(key, constants)?.bulk_modulus);
            }
            _ => {}
        }
        let fits =
            |name: &str| name == "bulk_modulus" || name == "poisson_ratio" && shear.is_some();
        let wrong = given.iter().find(|(name, _)| !fits(name));
        let kinds =
            if shear.is_some() { "either poisson_ratio or bulk_modulus" } else { "bulk_modulus" };
        let missing = kinds.split(' ').nth(1).unwrap_or(kinds);
        let (name, message) = match (wrong, given.is_empty()) {
            (Some((name, _)), _) => {
                (*name, format!("does not belong to {law}, which takes {takes}"))
            }
            (None, true) => (missing, format!("is missing; {law} takes {takes}")),
            (None, false) => ("bulk_modulus", format!("cannot be used; {law} takes {takes}")),
        };
        self.mistake(&format!("{key}.{name}"), format!("{message} and {kinds}"));
        None
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
    pub(super) fn accept<T>(&mut self, key: &str, made: Result<T, MaterialError>) -> Option<T> {
        made.map_err(|error| {
            let name = match error {
                MaterialError::NotPositive { name, .. } | MaterialError::Negative { name, .. } => {
                    name
                }
                MaterialError::Dispersion { .. } => "kappa",
                MaterialError::Angle { .. } => "angle",
                MaterialError::UnstableYeoh { .. } => "C1",
                MaterialError::BulkModulus { .. } => "lame_modulus",
                MaterialError::OgdenTerms { .. } => "terms",
                MaterialError::OgdenExponent { .. } => "alpha",
                MaterialError::PronyTerms { .. } | MaterialError::PronySum { .. } => "prony",
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
