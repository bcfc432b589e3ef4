//! What colours mean: the ends of a scale, and its unit with a prefix.

use super::body::Field;

/// Values outside of these parts of all have the colours of the ends \[–\].
const TAILS: f64 = 0.005;

/// Ends of a scale of colours, with the unit that they are written in.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    pub label: String,
    /// In the unit of the field.
    pub low: f64,
    pub high: f64,
    /// What is written, and by what values are multiplied for it.
    pub unit: String,
    pub factor: f64,
    /// Whether some values lie beyond the ends.
    pub cut: bool,
}

impl Scale {
    /// The scale of the values of a field.
    pub(crate) fn of(field: &Field, values: &[f64]) -> Scale {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |part: f64| {
            let place = part * sorted.len().saturating_sub(1) as f64;
            sorted.get(place.round() as usize).copied().unwrap_or(0.0)
        };
        let whole = field.unit() == "m";
        let (mut low, mut high) =
            if whole { (at(0.0), at(1.0)) } else { (at(TAILS), at(1.0 - TAILS)) };
        if field.begins_at_zero() {
            low = 0.0;
        }
        // A constant has a scale too.
        let size = low.abs().max(high.abs());
        if high - low <= 1e-6 * size || high <= low {
            let half = if size > 0.0 { 0.5 * size } else { 0.5 };
            (low, high) =
                if field.begins_at_zero() { (0.0, 2.0 * half) } else { (low - half, high + half) };
        }
        let cut = at(0.0) < low - 1e-6 * size || at(1.0) > high + 1e-6 * size;
        let (unit, factor) = prefixed(field.unit(), low.abs().max(high.abs()));
        Scale { label: field.label(), low, high, unit, factor, cut }
    }

    /// Where a value lies on the scale, from 0 to 1 between its ends.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Round values between the ends, in the unit that is written.
    pub(crate) fn ticks(&self) -> Vec<f64> {
        let (low, high) = (self.low * self.factor, self.high * self.factor);
        let rough = (high - low) / 5.0;
        let power = 10f64.powf(rough.log10().floor());
        let steps = [1.0, 2.0, 2.5, 5.0, 10.0].map(|step| step * power);
        let step = steps.into_iter().find(|step| *step >= 0.999 * rough).unwrap_or(rough);
        let first = (low / step - 1e-9).ceil();
        (0..12)
            .map(|n| (first + f64::from(n)) * step)
            .take_while(|t| *t <= high + 1e-9 * step)
            .collect()
    }
}

/// A unit with the prefix that suits a value, and the factor to it.
fn prefixed(unit: &str, size: f64) -> (String, f64) {
    let prefixes: &[(f64, &str)] = match unit {
        "m" => &[(1.0, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")],
        "Pa" => &[(1e-9, "GPa"), (1e-6, "MPa"), (1e-3, "kPa"), (1.0, "Pa"), (1e3, "mPa")],
        _ => return (unit.to_string(), 1.0),
    };
    // Metres from a tenth on, all other units from one.
    let enough = |factor: f64, name: &str| size * factor >= if name == "m" { 0.1 } else { 1.0 };
    let chosen = prefixes.iter().find(|(factor, name)| enough(*factor, name));
    let (factor, name) = chosen.or(prefixes.last()).copied().unwrap_or((1.0, ""));
    (name.to_string(), factor)
}
