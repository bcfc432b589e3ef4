//! Scales, ticks and their labels.

use super::super::number::power_of_ten;
use crate::study::Axis;

/// Maps values to pixels along one axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    log: bool,
    /// Ends in the mapped coordinate (log₁₀ on a log axis).
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

/// A labelled tick at a value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub value: f64,
    pub label: String,
    /// Where labels would overlap, those of the lowest rank are drawn.
    pub rank: u8,
}

/// Ticks of an axis and the power of ten taken out of their labels.
#[derive(Debug, Clone, Default)]
pub(super) struct Ticks {
    pub major: Vec<Tick>,
    pub minor: Vec<f64>,
    exponent: i32,
}

impl Scale {
    /// Covers all usable values with some air, drawn from pixel `from` to `to`.
    pub(crate) fn covering(
        values: impl Iterator<Item = f64>,
        log: bool,
        from: f64,
        to: f64,
    ) -> Scale {
        let usable = |v: &f64| v.is_finite() && (!log || *v > 0.0);
        let mapped = values.filter(usable).map(|v| if log { v.log10() } else { v });
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in mapped {
            (low, high) = (low.min(v), high.max(v));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        // Half of the largest double, so that no difference overflows.
        (low, high) = (low.max(-4e307), high.min(4e307));
        let size = low.abs().max(high.abs());
        if high - low <= 1e-9 * size || high == low {
            let air = if log || size == 0.0 { 0.5 } else { 0.5 * size };
            (low, high) = (low - air, high + air);
        } else {
            let air = 0.06 * (high - low);
            (low, high) = (low - air, high + air);
        }
        Scale { log, low, high, from, to }
    }

    /// Rows of the numbers 0, 1, 2 … from pixel `from` down to `to`.
    pub(crate) fn of_rows(count: usize, from: f64, to: f64) -> Scale {
        Scale { log: false, low: -0.5, high: count as f64 - 0.5, from, to }
    }

    /// Pixel of a value, None where it has none.
    pub(crate) fn position(&self, value: f64) -> Option<f64> {
        if !value.is_finite() || (self.log && value <= 0.0) {
            return None;
        }
        let mapped = if self.log { value.log10() } else { value };
        let part = (mapped - self.low) / (self.high - self.low);
        part.is_finite().then_some(self.from + part * (self.to - self.from))
    }

    /// Value at a pixel.
    pub(crate) fn value(&self, pixel: f64) -> f64 {
        let part = (pixel - self.from) / (self.to - self.from);
        let mapped = self.low + part * (self.high - self.low);
        if self.log { 10_f64.powf(mapped) } else { mapped }
    }

    pub(crate) fn ticks(&self) -> Ticks {
        if self.log { self.log_ticks() } else { self.linear_ticks(self.low, self.high) }
    }

    fn linear_ticks(&self, low: f64, high: f64) -> Ticks {
        let step = nice_step((high - low) / 6.5);
        let first = (low / step).ceil();
        let count = (high / step).floor() - first;
        let values: Vec<f64> =
            (0..=(count.clamp(0.0, 20.0) as i32)).map(|i| (first + f64::from(i)) * step).collect();
        let size = low.abs().max(high.abs());
        let thousands = (size.log10() / 3.0).floor() as i32 * 3;
        let exponent = if (1e-2..1e5).contains(&size) { 0 } else { thousands };
        // In two halves: 10^-320 alone would be rounded to almost nothing.
        let (half, rest) = (exponent / 2, exponent - exponent / 2);
        let scaled = |v: f64| v / 10_f64.powi(half) / 10_f64.powi(rest);
        let decimals = (-(scaled(step).log10() + 1e-9).floor()).clamp(0.0, 9.0) as usize;
        let major = values
            .into_iter()
            .map(|value| Tick { value, label: fixed(scaled(value), decimals), rank: 0 })
            .collect();
        Ticks { major, minor: Vec::new(), exponent }
    }

    /// Decades, thinned to at most seven; finer multiples where decades are few.
    fn log_ticks(&self) -> Ticks {
        let decades = (self.low.floor() as i32)..=(self.high.ceil() as i32);
        let inside = |v: &f64| {
            let mapped = v.log10();
            mapped >= self.low - 1e-12 && mapped <= self.high + 1e-12
        };
        let multiples = |factors: &[i32]| -> Vec<(i32, i32)> {
            let all = decades.clone().flat_map(|d| factors.iter().map(move |&f| (f, d)));
            all.filter(|&(f, d)| inside(&multiple(f, d))).collect()
        };
        let every = multiples(&[1, 2, 3, 4, 5, 6, 7, 8, 9]);
        let whole = multiples(&[1]);
        let some = multiples(&[1, 2, 5]);
        let decades_only = whole.len() >= 3;
        let chosen = match (decades_only, some.len(), every.len()) {
            (true, _, _) => whole.clone(),
            (_, 3.., _) => some,
            (_, _, 3..) => every.clone(),
            _ => return self.linear_ticks(10_f64.powf(self.low), 10_f64.powf(self.high)),
        };
        let stride = whole.len().div_ceil(7).max(1) as i32;
        let labelled = chosen.into_iter().filter(|&(_, d)| d.rem_euclid(stride) == 0);
        let rank = |factor: i32| [1, 2, 5].iter().position(|&f| f == factor).unwrap_or(3) as u8;
        let major = labelled.map(|(f, d)| Tick {
            value: multiple(f, d),
            label: power(f, d, decades_only),
            rank: rank(f),
        });
        let minor = if stride == 1 { every } else { whole };
        let minor = minor.into_iter().map(|(f, d)| multiple(f, d)).collect();
        Ticks { major: major.collect(), minor, exponent: 0 }
    }
}

impl Ticks {
    /// A tick at each of 0, 1, 2 …
    pub(crate) fn named(names: &[String]) -> Ticks {
        let tick = |(row, name): (usize, &String)| Tick {
            value: row as f64,
            label: name.clone(),
            rank: 0,
        };
        Ticks { major: names.iter().enumerate().map(tick).collect(), ..Ticks::default() }
    }

    /// Ticks whose labels do not overlap one of lower rank or further left, with the
    /// middles of their labels; `extent` is the middle of a label and half of its size in
    /// pixels.
    pub(crate) fn labelled(
        &self,
        extent: impl Fn(&Tick) -> Option<(f64, f64)>,
    ) -> Vec<(&Tick, f64)> {
        let mut order: Vec<&Tick> = self.major.iter().collect();
        order.sort_by_key(|tick| tick.rank);
        let mut occupied: Vec<(f64, f64)> = Vec::new();
        let mut labelled = Vec::new();
        for tick in order {
            let Some((middle, half)) = extent(tick) else { continue };
            if occupied.iter().all(|other| (middle - other.0).abs() > half + other.1) {
                occupied.push((middle, half));
                labelled.push((tick, middle));
            }
        }
        labelled
    }
}

fn multiple(factor: i32, decade: i32) -> f64 {
    f64::from(factor) * 10_f64.powi(decade)
}

/// `10⁻²` among decades alone; else `0.02` near one and `2×10⁻⁵` far from it.
fn power(factor: i32, decade: i32, decades_only: bool) -> String {
    match (factor, decade) {
        (f, 0..=1) => format!("{}", f * 10_i32.pow(decade as u32)),
        (f, -3..=3) if !decades_only => fixed(multiple(f, decade), (-decade).max(0) as usize),
        (1, d) => power_of_ten(d),
        (f, d) => format!("{f}×{}", power_of_ten(d)),
    }
}

fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let zero = text.chars().all(|c| c == '0' || c == '.');
    if value < 0.0 && !zero { format!("−{text}") } else { text }
}

/// 1, 2 or 5 times a power of ten, at least `rough`.
pub(super) fn nice_step(rough: f64) -> f64 {
    let power = 10_f64.powf(rough.max(f64::MIN_POSITIVE).log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|f| f * power).into_iter().find(|s| *s >= rough).unwrap_or(power)
}

/// `label [10⁻³ m]`.
pub(super) fn axis_title(axis: &Axis, ticks: &Ticks) -> String {
    let pure = axis.unit.is_empty() || axis.unit == "1";
    let unit = if pure { "" } else { axis.unit.as_str() };
    match (ticks.exponent, unit) {
        (0, "") => axis.label.clone(),
        (0, unit) => format!("{} [{unit}]", axis.label),
        (e, "") => format!("{} [{}]", axis.label, power_of_ten(e)),
        (e, unit) => format!("{} [{} {unit}]", axis.label, power_of_ten(e)),
    }
}
