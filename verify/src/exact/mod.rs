//! Closed forms and published values, typed from the book.

pub mod bar;
pub mod beam;
pub mod biaxial;
pub mod cook;
pub mod hertz;
mod jet;
pub mod manufactured;
pub mod shear;
pub mod shell;
pub mod torsion;
pub mod turek_hron;
pub mod uniaxial;

/// A value that somebody else computed and how far it can be trusted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Published {
    /// In `unit`.
    pub value: f64,
    /// Half-width of the interval that holds the truth as far as known, in `unit`.
    pub uncertainty: f64,
    pub unit: &'static str,
    pub source: &'static str,
}

/// Root of an increasing function between `low` and `high`, to the last bit.
fn bisect(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if function(middle) < 0.0 { low = middle } else { high = middle }
    }
}

/// The stretch at which `free`, a lateral stress as a function of the lateral
/// stretch, vanishes: sought from 1 towards the side that lowers it, within a
/// factor of four.
fn free_stretch(free: impl Fn(f64) -> f64) -> Option<f64> {
    if free(1.0) == 0.0 {
        return Some(1.0);
    }
    let factor = if free(1.0) > 0.0 { 1.0 / 1.05 } else { 1.05 };
    let mut inside = 1.0;
    for _ in 0..28 {
        let outside = inside * factor;
        if free(outside) * free(1.0) <= 0.0 {
            return Some(bisect(inside.min(outside), inside.max(outside), free));
        }
        inside = outside;
    }
    None
}
