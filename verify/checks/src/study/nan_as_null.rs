//! JSON has no NaN: it is written as `null`, and `null` is read as NaN.

use serde::{Deserialize, Deserializer};

/// A number or `null`.
#[derive(Deserialize)]
#[serde(transparent)]
struct Nullable(Option<f64>);

impl Nullable {
    fn number(self) -> f64 {
        self.0.unwrap_or(f64::NAN)
    }
}

pub fn number<'d, D: Deserializer<'d>>(reader: D) -> Result<f64, D::Error> {
    Ok(Nullable::deserialize(reader)?.number())
}

pub fn numbers<'d, D: Deserializer<'d>>(reader: D) -> Result<Vec<f64>, D::Error> {
    Ok(Vec::<Nullable>::deserialize(reader)?.into_iter().map(Nullable::number).collect())
}

pub(crate) fn points<'d, D: Deserializer<'d>>(reader: D) -> Result<Vec<(f64, f64)>, D::Error> {
    let points = Vec::<(Nullable, Nullable)>::deserialize(reader)?;
    Ok(points.into_iter().map(|(x, y)| (x.number(), y.number())).collect())
}

pub(crate) fn lines<'d, D: Deserializer<'d>>(reader: D) -> Result<Vec<Vec<[f64; 2]>>, D::Error> {
    let lines = Vec::<Vec<[Nullable; 2]>>::deserialize(reader)?;
    let line =
        |points: Vec<[Nullable; 2]>| points.into_iter().map(|p| p.map(Nullable::number)).collect();
    Ok(lines.into_iter().map(line).collect())
}
