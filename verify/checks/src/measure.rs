//! Norms, observed orders and grid convergence of plain numbers.

/// max|computed − reference| / max|reference| over all components \[–\]; NaN if
/// any difference is NaN.
pub fn relative_max(computed: &[f64], reference: &[f64]) -> f64 {
    let (mut difference, mut size) = (0.0, 0.0);
    for (a, b) in pairs(computed, reference) {
        difference = larger(difference, (a - b).abs());
        size = larger(size, b.abs());
    }
    difference / size
}

fn pairs<'a, T>(computed: &'a [T], reference: &'a [T]) -> impl Iterator<Item = (&'a T, &'a T)> {
    assert_eq!(computed.len(), reference.len(), "samples of different lengths");
    computed.iter().zip(reference)
}

/// Like `f64::max`, but NaN wins: a missing sample must not look like a small one.
pub fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}

/// Order p observed from `values` on the `sizes` h₁ < h₂ < h₃ (fine first),
/// from (f₃ − f₂)/(f₂ − f₁) = (h₃ᵖ − h₂ᵖ)/(h₂ᵖ − h₁ᵖ); for one ratio r this is
/// p = ln((f₃ − f₂)/(f₂ − f₁))/ln r (Roache 1994, J. Fluids Eng. 116, 405).
///
/// None where the differences change sign or do not exceed `noise_floor` (in
/// the unit of the values), where sizes are not increasing, or |p| > 20.
pub fn observed_order(values: [f64; 3], sizes: [f64; 3], noise_floor: f64) -> Option<f64> {
    let (near, far) = (values[1] - values[0], values[2] - values[1]);
    let increasing = 0.0 < sizes[0] && sizes[0] < sizes[1] && sizes[1] < sizes[2];
    let above_noise = near.abs() > noise_floor && far.abs() > noise_floor;
    let ratio = far / near;
    if !(increasing && above_noise && ratio > 0.0 && ratio.is_finite()) {
        return None;
    }
    let (inner, outer) = ((sizes[1] / sizes[0]).ln(), (sizes[2] / sizes[1]).ln());
    // The quotient of differences grows with p, so bisection is safe.
    let quotient = |p: f64| growth(outer, p) / growth(-inner, p);
    let (mut low, mut high) = (-20.0, 20.0);
    if !(quotient(low) < ratio && ratio < quotient(high)) {
        return None;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if quotient(middle) < ratio { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}

/// |e^(a p) − 1| / |p|, continuous at p = 0.
fn growth(a: f64, p: f64) -> f64 {
    if p == 0.0 { a.abs() } else { ((a * p).exp_m1() / p).abs() }
}

/// Richardson's extrapolation f* = f₁ + (f₁ − f₂)/(rᵖ − 1) from the fine and
/// the medium value (Roache 1994), in the unit of the values.
pub fn richardson(fine: f64, medium: f64, ratio: f64, order: f64) -> f64 {
    fine + (fine - medium) / (ratio.powf(order) - 1.0)
}

/// Grid convergence index F_s |(f₂ − f₁)/f₁| / (rᵖ − 1) \[–\] (Roache 1994);
/// the safety factor is 1.25 with three or more good grids, 3 otherwise.
pub fn grid_convergence_index(
    fine: f64,
    medium: f64,
    ratio: f64,
    order: f64,
    safety_factor: f64,
) -> f64 {
    safety_factor * ((medium - fine) / fine).abs() / (ratio.powf(order) - 1.0)
}

/// GCI₂₃/(rᵖ GCI₁₂) \[–\], near 1 in the asymptotic range (NASA NPARC, Examining
/// Spatial Grid Convergence).
pub fn asymptotic_ratio(fine_index: f64, coarse_index: f64, ratio: f64, order: f64) -> f64 {
    coarse_index / (ratio.powf(order) * fine_index)
}

/// Line ln y = `intercept` + `slope` ln x through samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogLogFit {
    /// d ln y / d ln x.
    pub slope: f64,
    /// ln y at x = 1.
    pub intercept: f64,
    /// Of the slope; infinite with two samples.
    pub standard_deviation: f64,
}

/// Least-squares line through (ln x, ln y); the deviation is
/// √(Σr²/(n − 2)/Σ(ln x − mean)²) (Draper and Smith 1998, chapter 1). None with
/// fewer than two different x or any sample that is not positive and finite.
pub fn log_log_fit(samples: &[(f64, f64)]) -> Option<LogLogFit> {
    let usable = |v: f64| v > 0.0 && v.is_finite();
    if samples.len() < 2 || !samples.iter().all(|&(x, y)| usable(x) && usable(y)) {
        return None;
    }
    let count = samples.len() as f64;
    let logs: Vec<(f64, f64)> = samples.iter().map(|&(x, y)| (x.ln(), y.ln())).collect();
    let mean_x = logs.iter().map(|l| l.0).sum::<f64>() / count;
    let mean_y = logs.iter().map(|l| l.1).sum::<f64>() / count;
    let variation: f64 = logs.iter().map(|l| (l.0 - mean_x).powi(2)).sum();
    if variation <= f64::EPSILON {
        return None;
    }
    let slope = logs.iter().map(|l| (l.0 - mean_x) * (l.1 - mean_y)).sum::<f64>() / variation;
    let intercept = mean_y - slope * mean_x;
    let residual: f64 = logs.iter().map(|l| (l.1 - intercept - slope * l.0).powi(2)).sum();
    let standard_deviation = if samples.len() > 2 {
        (residual / (count - 2.0) / variation).sqrt()
    } else {
        f64::INFINITY
    };
    Some(LogLogFit { slope, intercept, standard_deviation })
}

/// Middle value, the mean of the two middle ones for an even count. None for
/// no samples or a NaN among them.
pub fn median(samples: &[f64]) -> Option<f64> {
    if samples.is_empty() || samples.iter().any(|s| s.is_nan()) {
        return None;
    }
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    Some(if sorted.len() % 2 == 1 { sorted[half] } else { 0.5 * (sorted[half - 1] + sorted[half]) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// NASA NPARC, Examining Spatial Grid Convergence: pressure recovery.
    const NPARC: [f64; 3] = [0.97050, 0.96854, 0.96178];

    #[test]
    fn the_nparc_example_is_reproduced() {
        let p = observed_order(NPARC, [1.0, 2.0, 4.0], 0.0).unwrap();
        assert_relative_eq!(p, 1.78617, epsilon = 5e-6);
        assert_relative_eq!(richardson(NPARC[0], NPARC[1], 2.0, p), 0.971300, epsilon = 5e-7);
        let fine = grid_convergence_index(NPARC[0], NPARC[1], 2.0, p, 1.25);
        let coarse = grid_convergence_index(NPARC[1], NPARC[2], 2.0, p, 1.25);
        // Published with single precision behind the fourth digit: 0.103083 % exactly.
        assert_relative_eq!(fine, 0.103080e-2, epsilon = 5e-8);
        assert_relative_eq!(coarse, 0.356249e-2, epsilon = 5e-9);
        assert_relative_eq!(asymptotic_ratio(fine, coarse, 2.0, p), 1.00202, epsilon = 5e-6);
    }

    #[test]
    fn the_order_of_a_power_law_is_found_with_unequal_ratios() {
        for order in [-1.0, 0.5, 1.0, 2.0, 4.3] {
            let sizes = [0.1, 0.17, 0.31];
            let values = sizes.map(|h: f64| 3.0 - 0.7 * h.powf(order));
            let found = observed_order(values, sizes, 0.0).unwrap();
            assert_relative_eq!(found, order, epsilon = 1e-9);
        }
    }

    #[test]
    fn no_order_is_claimed_without_monotone_differences_above_the_noise() {
        let sizes = [1.0, 2.0, 4.0];
        assert_eq!(observed_order([1.0, 1.1, 1.05], sizes, 0.0), None);
        assert_eq!(observed_order([1.0, 1.0, 1.05], sizes, 0.0), None);
        assert_eq!(observed_order(NPARC, sizes, 0.002), None);
        assert_eq!(observed_order(NPARC, [1.0, 2.0, 2.0], 0.0), None);
        assert_eq!(observed_order([1.0, f64::NAN, 2.0], sizes, 0.0), None);
    }

    #[test]
    fn the_largest_difference_of_a_scaled_field_is_the_scale_and_nan_is_not_hidden() {
        let reference = [3.0, -4.0, 1.0];
        assert_relative_eq!(
            relative_max(&reference.map(|r| 1.1 * r), &reference),
            0.1,
            epsilon = 1e-14
        );
        assert!(relative_max(&[f64::NAN, 1.0], &[1.0, 1.0]).is_nan());
    }

    #[test]
    fn a_log_log_fit_finds_the_power_and_its_scatter() {
        let exact: Vec<_> = [0.1, 0.2, 0.4, 0.8].map(|h: f64| (h, 5.0 * h.powi(2))).to_vec();
        let fit = log_log_fit(&exact).unwrap();
        assert_relative_eq!(fit.slope, 2.0, epsilon = 1e-12);
        assert_relative_eq!(fit.intercept, 5.0_f64.ln(), epsilon = 1e-12);
        assert!(fit.standard_deviation < 1e-12);
        // Hand-computed: ln y off by −a, +2a, −a at ln x = −1, 0, 1 gives 0 ± a√3.
        let scattered: Vec<_> = [(-1.0, -0.1), (0.0, 0.2), (1.0, -0.1)]
            .map(|(x, y): (f64, f64)| (x.exp(), y.exp()))
            .to_vec();
        let fit = log_log_fit(&scattered).unwrap();
        assert_relative_eq!(fit.slope, 0.0, epsilon = 1e-12);
        assert_relative_eq!(fit.standard_deviation, 0.03_f64.sqrt(), epsilon = 1e-12);
        assert!(log_log_fit(&exact[..2]).unwrap().standard_deviation.is_infinite());
        assert_eq!(log_log_fit(&[(1.0, 1.0), (1.0, 2.0)]), None);
        assert_eq!(log_log_fit(&[(1.0, 1.0), (2.0, 0.0)]), None);
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[1.0, f64::NAN]), None);
    }
}
