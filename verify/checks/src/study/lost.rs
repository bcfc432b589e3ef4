//! JSON knows no NaN: what was lost is written as `null` and read as NaN.

use serde::{Deserialize, Deserializer};

/// A number or `null`.
#[derive(Deserialize)]
#[serde(transparent)]
struct Lost(Option<f64>);

impl Lost {
    fn number(self) -> f64 {
        self.0.unwrap_or(f64::NAN)
    }
}

pub fn number<'d, D: Deserializer<'d>>(reader: D) -> Result<f64, D::Error> {
    Ok(Lost::deserialize(reader)?.number())
}

pub fn numbers<'d, D: Deserializer<'d>>(reader: D) -> Result<Vec<f64>, D::Error> {
    Ok(Vec::<Lost>::deserialize(reader)?.into_iter().map(Lost::number).collect())
}

pub fn points<'d, D: Deserializer<'d>>(reader: D) -> Result<Vec<(f64, f64)>, D::Error> {
    let points = Vec::<(Lost, Lost)>::deserialize(reader)?;
    Ok(points.into_iter().map(|(x, y)| (x.number(), y.number())).collect())
}

pub fn lines<'d, D: Deserializer<'d>>(reader: D) -> Result<Vec<Vec<[f64; 2]>>, D::Error> {
    let lines = Vec::<Vec<[Lost; 2]>>::deserialize(reader)?;
    let line = |points: Vec<[Lost; 2]>| points.into_iter().map(|p| p.map(Lost::number)).collect();
    Ok(lines.into_iter().map(line).collect())
}
