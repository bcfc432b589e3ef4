//! Laws with constants of their own names, and the directions of their fibres.

use crate::scene::build::builder::Builder;
use crate::scene::format::{DirectionFormat, MaterialFormat};
use mtled::geometry::Field;
use mtled::material::{Isochoric, Law, ShapeEnergy};
use mtled::problem::Fibres;

impl Builder<'_> {
    /// A law of named constants, or `None` and a mistake; `name` is its own.
    pub fn isochoric<W: ShapeEnergy>(
        &mut self,
        key: &str,
        name: &str,
        format: &MaterialFormat,
    ) -> Option<Isochoric<W>> {
        let before = self.count();
        let known: Vec<&str> = W::CONSTANTS.iter().map(|constant| constant.name).collect();
        let names: Vec<String> =
            W::CONSTANTS.iter().map(|own| format!("{} [{}]", own.name, own.unit)).collect();
        let Some(given) = &format.constants else {
            let message = format!("is missing; {name} needs {}", names.join(", "));
            self.mistake(&format!("{key}.constants"), message);
            return None;
        };
        for other in given.keys().filter(|other| !known.contains(&other.as_str())) {
            let own = format!("{key}.constants.{other}");
            self.unknown_name(&own, &format!("constant of {name}"), other, &known);
        }
        let values: Vec<f64> = (W::CONSTANTS.iter())
            .map(|constant| {
                let value = given.get(constant.name).copied();
                value.or(constant.default.map(f64::from)).unwrap_or_else(|| {
                    let own = format!("{key}.constants.{}", constant.name);
                    self.mistake(&own, format!("is missing; {name} needs it"));
                    f64::NAN
                })
            })
            .collect();
        if self.count() > before {
            return None;
        }
        let shape = self.accept(&format!("{key}.constants"), W::new(&values))?;
        let shear = (!W::HAS_FIBRES).then(|| shape.shear_modulus());
        let bulk_modulus = self.bulk_modulus(key, (name, "constants"), format, shear)?;
        let volumetric = format.volumetric.map(Into::into).unwrap_or_default();
        self.accept(key, Isochoric::new(shape, bulk_modulus, volumetric))
    }

    /// The fibres of a law that has some.
    pub fn fibres(&mut self, key: &str, format: &MaterialFormat, law: &Law) -> Option<Fibres> {
        let needed = [
            ("fibres", &format.fibres, law.has_fibres(), "laws with fibres"),
            ("sheets", &format.sheets, law.has_sheets(), "laws with fibres in sheets"),
        ];
        let mut fields = Vec::new();
        for (name, given, is_needed, laws) in needed {
            let key = format!("{key}.{name}");
            match given {
                // Sheets turn the frame of any law with fibres.
                Some(given) if law.has_fibres() => fields.extend(self.directions(&key, given)),
                Some(_) => self.mistake(&key, format!("belongs to {laws}; remove it")),
                None if is_needed => {
                    let message =
                        "is missing; the law needs it, such as { direction = [1.0, 0.0, 0.0] }";
                    self.mistake(&key, message);
                }
                None => {}
            }
        }
        let mut fields = fields.into_iter();
        law.has_fibres().then(|| Some(Fibres { fibre: fields.next()?, sheet: fields.next() }))?
    }

    fn directions(&mut self, key: &str, format: &DirectionFormat) -> Option<Field> {
        let DirectionFormat { direction, formula, data } = format;
        match (direction, formula, data) {
            (Some(direction), None, None) => {
                Some(Field::Uniform(self.direction(&format!("{key}.direction"), direction)))
            }
            (None, Some(formula), None) => self.formula(&format!("{key}.formula"), formula),
            (None, None, Some(data)) => {
                let data = self.scattered(&format!("{key}.data"), data)?;
                Some(Field::of(move |position| data.axis_at(position)))
            }
            _ => {
                self.mistake(key, "takes one of direction, formula and data");
                None
            }
        }
    }
}
