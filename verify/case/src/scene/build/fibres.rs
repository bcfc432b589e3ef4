//! Laws with constants of their own names, the directions of their fibres, and what acts beside
//! the law.

use crate::scene::build::builder::Builder;
use crate::scene::format::{DirectionFormat, MaterialFormat, PronyTermFormat};
use mtled::geometry::Field;
use mtled::material::{Law, NamedConstants, PronySeries, PronyTerm, VolumetricTerm};
use mtled::problem::{ActiveStress, Fibres};

impl Builder<'_> {
    /// A law of named constants, or `None` and a mistake.
    pub(crate) fn isochoric(
        &mut self,
        key: &str,
        format: &MaterialFormat,
        law: &NamedConstants,
        volumetric: VolumetricTerm,
    ) -> Option<Law> {
        let name = format.law.name();
        let before = self.count();
        let known: Vec<&str> = law.constants.iter().map(|constant| constant.name).collect();
        let names: Vec<String> =
            law.constants.iter().map(|own| format!("{} [{}]", own.name, own.unit)).collect();
        let Some(given) = &format.constants else {
            let message = format!("is missing; {name} needs {}", names.join(", "));
            self.mistake(&format!("{key}.constants"), message);
            return None;
        };
        for other in given.keys().filter(|other| !known.contains(&other.as_str())) {
            let own = format!("{key}.constants.{other}");
            self.unknown_name(&own, &format!("constant of {name}"), other, &known);
        }
        let values: Vec<f64> = (law.constants.iter())
            .map(|constant| {
                let value = given.get(constant.name).copied();
                value.or(constant.is_optional.then_some(0.0)).unwrap_or_else(|| {
                    let own = format!("{key}.constants.{}", constant.name);
                    self.mistake(&own, format!("is missing; {name} needs it"));
                    f64::NAN
                })
            })
            .collect();
        if self.count() > before {
            return None;
        }
        let shear = self.accept(&format!("{key}.constants"), (law.shear_modulus)(&values))?;
        let shear = (!law.has_fibres).then_some(shear);
        let bulk_modulus = self.bulk_modulus(key, (name, "constants"), format, shear)?;
        self.accept(key, (law.law)(&values, bulk_modulus, volumetric))
    }

    /// The fibres of a law or an active stress that has some.
    pub(crate) fn fibres(
        &mut self,
        key: &str,
        format: &MaterialFormat,
        law: &Law,
    ) -> Option<Fibres> {
        let pulls = format.active_stress.is_some();
        let of = if pulls && !law.has_fibres() { "active_stress" } else { "the law" };
        let any = law.has_fibres() || pulls;
        let fibre = (&format.fibres, any, "laws with fibres", of);
        let fibre = self.directions_for(&format!("{key}.fibres"), any, fibre);
        // Sheets turn the frame of any law with fibres.
        let sheet = (&format.sheets, law.has_sheets(), "laws with fibres in sheets", of);
        let sheet = self.directions_for(&format!("{key}.sheets"), any, sheet);
        Some(Fibres { fibre: fibre?, sheet })
    }

    /// Directions that a material with fibres may have, or must have where they are needed; `laws`
    /// are those that they belong to.
    fn directions_for(
        &mut self,
        key: &str,
        has_fibres: bool,
        (given, is_needed, laws, of): (&Option<DirectionFormat>, bool, &str, &str),
    ) -> Option<Field> {
        match given {
            Some(given) if has_fibres => return self.directions(key, given),
            Some(_) => self.mistake(key, format!("belongs to {laws}; remove it")),
            None if is_needed => {
                let example = "such as { direction = [1.0, 0.0, 0.0] }";
                self.mistake(key, format!("is missing; {of} needs it, {example}"));
            }
            None => {}
        }
        None
    }

    /// The viscosity of a material that has some.
    pub(crate) fn viscosity(
        &mut self,
        key: &str,
        format: &MaterialFormat,
        law: &Law,
    ) -> Option<PronySeries> {
        let rows = format.prony.as_ref()?;
        let key = format!("{key}.prony");
        if !law.is_split() {
            let name = format.law.name();
            let message = format!(
                "relaxes the isochoric stress, which {name} does not have: use \
                 neo_hookean_isochoric, ogden, or a law with constants"
            );
            self.mistake(&key, message);
            return None;
        }
        let term = |row: &PronyTermFormat| PronyTerm { g: row.g, tau: row.tau };
        let terms: Vec<PronyTerm> = rows.iter().map(term).collect();
        // One by one for the place of a mistake.
        for (n, term) in terms.iter().enumerate() {
            self.accept(&format!("{key}[{n}]"), term.check())?;
        }
        self.accept(key.trim_end_matches(".prony"), PronySeries::new(&terms))
    }

    /// What a material pulls with along its fibres.
    pub(crate) fn active_stress(
        &mut self,
        key: &str,
        format: &MaterialFormat,
    ) -> Option<ActiveStress> {
        let given = format.active_stress.as_ref()?;
        let key = format!("{key}.active_stress");
        let amplitude = self.amplitude(&format!("{key}.amplitude"), &given.amplitude);
        Some(ActiveStress { tension: given.tension, amplitude })
    }

    fn directions(&mut self, key: &str, format: &DirectionFormat) -> Option<Field> {
        let DirectionFormat { direction, formula, data } = format;
        match (direction, formula, data) {
            (Some(direction), None, None) => {
                Some(Field::Uniform(self.direction(&format!("{key}.direction"), direction)))
            }
            (None, Some(formula), None) => self.formula(&format!("{key}.formula"), formula),
            (None, None, Some(data)) => {
                let data = self.axes(&format!("{key}.data"), data)?;
                Some(Field::of(move |position| data.axis_at(position)))
            }
            _ => {
                self.mistake(key, "takes one of direction, formula and data");
                None
            }
        }
    }
}
