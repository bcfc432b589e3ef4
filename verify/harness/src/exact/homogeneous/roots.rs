//! Roots of functions of one variable.

/// Root of an increasing function between `low` and `high`, to the last bit.
pub(crate) fn bisect(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if function(middle) < 0.0 { low = middle } else { high = middle }
    }
}

/// The lateral stretch at which the lateral stress `free` vanishes: searched for from 1
/// in the direction of decreasing |stress|, within a factor of four.
pub(crate) fn free_stretch(free: impl Fn(f64) -> f64) -> Option<f64> {
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
