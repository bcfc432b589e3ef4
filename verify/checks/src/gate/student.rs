//! Student's distribution.

/// t with P(|T| ≤ t) = 1 − `tail`, for T of Student's distribution with
/// `freedom` ≥ 1 degrees of freedom, by bisection in atan(t/√ν).
pub(crate) fn two_sided_quantile(tail: f64, freedom: usize) -> f64 {
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
    // Each step gains a bit of 53.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if within(middle, freedom) < 1.0 - tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    high.tan() * (freedom as f64).sqrt()
}

/// P(|T| ≤ √ν tan θ), a finite sum for whole ν: Abramowitz and Stegun 26.7.3,
/// 26.7.4.
fn within(angle: f64, freedom: usize) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    let odd = freedom % 2 == 1;
    let mut term = if odd { cosine } else { 1.0 };
    let mut sum = if freedom == 1 { 0.0 } else { term };
    let mut power = if odd { 3 } else { 2 };
    while power + 2 <= freedom {
        term *= cosine * cosine * (power - 1) as f64 / power as f64;
        sum += term;
        power += 2;
    }
    if odd { (angle + sine * sum) * std::f64::consts::FRAC_2_PI } else { sine * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_printed_tables() {
        let printed = [
            (0.05, 1, 12.7062),
            (0.05, 2, 4.3027),
            (0.05, 3, 3.1824),
            (0.05, 19, 2.0930),
            (0.001, 10, 4.5869),
            (0.001, 4, 8.6103),
            (0.01, 120, 2.6174),
        ];
        for (tail, freedom, expected) in printed {
            let found = two_sided_quantile(tail, freedom);
            assert!((found - expected).abs() < 6e-5, "{tail} {freedom}: {found}");
        }
    }

    #[test]
    fn tails_of_many_checks_at_once_survive_round_off() {
        // For ν = 2 the quantile has a closed form.
        let tail: f64 = 1e-2 / 455.0;
        let inside = 1.0 - tail;
        let exact = inside * (2.0 / (1.0 - inside * inside)).sqrt();
        let found = two_sided_quantile(tail, 2);
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    }
}
