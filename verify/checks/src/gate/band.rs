//! Which values count as the same, and why.

use super::student::two_sided_quantile;
use crate::study::{Band, BandSource, Bound, Check, Kind, Scale, Scatter};

/// Chance that a run of unchanged code over other clouds fails \[–\]; it is
/// divided evenly among the checks that scatter (Bonferroni 1936).
pub(crate) const FALSE_ALARMS: f64 = 0.01;

/// √ε \[–\]: half of the digits are lost to round-off.
pub(crate) const HALF_THE_DIGITS: f64 = 1.490_116_119_384_765_6e-8;

/// ∛ε \[–\]: bounds up to this allow for round-off, finite differences and tolerances of
/// iterations, but not for an error of a discretisation.
const ARITHMETIC: f64 = 6.055_454_452_393_343e-6;

/// Probability of a false alarm for each of `count` checks \[–\].
pub(crate) fn tail(count: usize) -> f64 {
    FALSE_ALARMS / count.max(1) as f64
}

/// The band of a check without scatter, or whose scatter is not known.
pub(crate) fn without_scatter(check: &Check) -> Band {
    if let Some(band) = arithmetic(check) {
        return band;
    }
    let half_width = round_off(check.value, &check.unit);
    let band = theory(check.value - half_width, check.value + half_width);
    within_bound(widened(band, check), check.bound)
}

/// The whole range of the bound of a theorem, where it allows for round-off only.
fn arithmetic(check: &Check) -> Option<Band> {
    if check.kind != Kind::Exact || check.unit != "1" {
        return None;
    }
    match check.bound {
        Bound::AtMost(limit) if (0.0..=ARITHMETIC).contains(&limit) => {
            Some(theory(check.value.min(0.0), limit))
        }
        Bound::Between(low, high) if high - low <= 2.0 * ARITHMETIC * high.abs() => {
            Some(theory(low, high))
        }
        _ => None,
    }
}

/// Round-off of a figure. Pure numbers are relative to one, except for counts, which
/// are whole.
pub(crate) fn round_off(value: f64, unit: &str) -> f64 {
    let relative = unit == "1" && value.fract() != 0.0;
    HALF_THE_DIGITS * if relative { value.abs().max(1.0) } else { value.abs() }
}

fn theory(low: f64, high: f64) -> Band {
    Band { low, high, source: BandSource::Theory, scatter: None }
}

/// At least the error bar of the reference to either side.
fn widened(band: Band, check: &Check) -> Band {
    let Some(bar) = check.reference_error else { return band };
    let (low, high) = (check.value - bar, check.value + bar);
    if low >= band.low && high <= band.high {
        return band;
    }
    let (low, high) = (low.min(band.low), high.max(band.high));
    Band { low, high, source: BandSource::Reference, ..band }
}

/// No further than the bound.
fn within_bound(band: Band, bound: Bound) -> Band {
    let (low, high) = match bound {
        Bound::AtMost(limit) => (band.low, band.high.min(limit)),
        Bound::AtLeast(limit) => (band.low.max(limit), band.high),
        Bound::Between(low, high) => (band.low.max(low), band.high.min(high)),
        Bound::Baseline(_) => (band.low, band.high),
    };
    Band { low, high, ..band }
}

/// Mean and scatter of figures of several clouds, on the scale on which they are less
/// skewed. None where the figure is the same on every cloud.
pub(crate) fn mean_and_scatter(samples: &[f64], unit: &str) -> Option<(f64, Scatter)> {
    if samples.len() < 2 || samples.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let least = |value: f64| round_off(value, unit);
    let (low, high) =
        samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    if high - low <= least(high).max(least(low)) {
        return None;
    }
    let scale = scale_of(samples);
    let moved: Vec<f64> = samples.iter().map(|value| on(scale, *value)).collect();
    let count = moved.len() as f64;
    let mean = moved.iter().sum::<f64>() / count;
    let squares: f64 = moved.iter().map(|value| (value - mean).powi(2)).sum();
    let deviation = (squares / (count - 1.0)).sqrt();
    Some((mean, Scatter { scale, deviation, samples: samples.len() }))
}

/// Errors that are products of factors are skewed and their logarithms are not; for
/// magnitudes of differences that pass through zero it is the other way round.
fn scale_of(samples: &[f64]) -> Scale {
    if samples.iter().any(|value| *value <= 0.0) {
        return Scale::Linear;
    }
    let logarithms: Vec<f64> = samples.iter().map(|value| value.ln()).collect();
    if skewness(&logarithms).abs() <= skewness(samples).abs() {
        Scale::Logarithmic
    } else {
        Scale::Linear
    }
}

/// Third central moment over the cube of the standard deviation \[–\].
fn skewness(samples: &[f64]) -> f64 {
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let moment =
        |order: i32| samples.iter().map(|value| (value - mean).powi(order)).sum::<f64>() / count;
    moment(3) / moment(2).powf(1.5)
}

/// Prediction interval of one more run, left with probability `tail`:
/// x̄ ± t(n − 1, tail) s √(1 + 1/n).
pub(crate) fn around_mean(check: &Check, mean: f64, scatter: Scatter, tail: f64) -> Band {
    let n = scatter.samples as f64;
    scattered(check, mean, scatter, tail, (1.0 + 1.0 / n).sqrt())
}

/// Prediction interval around one known run, left with probability `tail`:
/// x ± t(n − 1, tail) s √2.
pub(crate) fn around_value(check: &Check, scatter: Scatter, tail: f64) -> Band {
    match scatter.scale {
        Scale::Logarithmic if check.value <= 0.0 => without_scatter(check),
        scale => scattered(check, on(scale, check.value), scatter, tail, std::f64::consts::SQRT_2),
    }
}

fn scattered(check: &Check, centre: f64, scatter: Scatter, tail: f64, factor: f64) -> Band {
    if let Some(band) = arithmetic(check) {
        return band;
    }
    let width = two_sided_quantile(tail, scatter.samples - 1) * scatter.deviation * factor;
    let back = |value: f64| match scatter.scale {
        Scale::Linear => value,
        Scale::Logarithmic => value.exp(),
    };
    // The run that the baseline is made of is inside.
    let low = back(centre - width).min(check.value);
    let high = back(centre + width).max(check.value);
    let band = Band { low, high, source: BandSource::Scatter, scatter: Some(scatter) };
    within_bound(widened(band, check), check.bound)
}

fn on(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear => value,
        Scale::Logarithmic => value.ln(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(kind: Kind, value: f64, bound: Bound) -> Check {
        Check::new("a/b", "", kind, value, bound, "1", "")
    }

    #[test]
    fn a_theorem_met_to_round_off_may_use_all_of_its_bound() {
        let band = without_scatter(&check(Kind::Exact, 3e-16, Bound::AtMost(1e-12)));
        assert_eq!((band.low, band.high, band.source), (0.0, 1e-12, BandSource::Theory));
    }

    #[test]
    fn a_discretisation_error_may_not_use_its_bound_even_where_the_solution_is_exact() {
        let band = without_scatter(&check(Kind::Exact, 1e-3, Bound::AtMost(1e-2)));
        assert!(band.high < 1.000_02e-3 && band.high > 1e-3, "{band:?}");
    }

    #[test]
    fn a_count_without_scatter_may_not_change_by_one() {
        let band = without_scatter(&check(Kind::Regression, 651.0, Bound::AtMost(665.0)));
        assert!(band.low > 650.0 && band.high < 652.0, "{band:?}");
    }

    #[test]
    fn a_difference_is_not_judged_below_the_error_bar_of_its_reference() {
        let mut difference = check(Kind::Reference, 0.0078125, Bound::AtMost(0.03));
        difference.reference_error = Some(0.015625);
        let band = without_scatter(&difference);
        assert_eq!(
            (band.low, band.high, band.source),
            (-0.0078125, 0.0234375, BandSource::Reference)
        );
        let scatter = Scatter { scale: Scale::Logarithmic, deviation: 1e-3, samples: 20 };
        assert_eq!(around_value(&difference, scatter, 0.01).source, BandSource::Reference);
    }

    #[test]
    fn the_prediction_interval_is_that_of_the_textbook() {
        // x̄ = 0, s = √2.5, n = 5, t(4, 5 %) = 2.776.
        let (mean, scatter) = mean_and_scatter(&[-2.0, -1.0, 0.0, 1.0, 2.0], "1").unwrap();
        assert_eq!((mean, scatter.scale, scatter.samples), (0.0, Scale::Linear, 5));
        let one = check(Kind::Regression, 0.5, Bound::Between(-9.0, 9.0));
        let band = around_mean(&one, mean, scatter, 0.05);
        let half_width = 2.776_445 * 2.5f64.sqrt() * 1.2f64.sqrt();
        assert!((band.high - half_width).abs() < 1e-5 && band.low == -band.high, "{band:?}");
    }

    #[test]
    fn the_scale_is_the_one_on_which_figures_are_less_skewed() {
        let products: Vec<f64> = (-10..=10).map(|i| (0.3 * f64::from(i)).exp()).collect();
        assert_eq!(mean_and_scatter(&products, "1").unwrap().1.scale, Scale::Logarithmic);
        let differences: Vec<f64> = (-10..=10).map(|i| (0.1 * f64::from(i) + 0.03).abs()).collect();
        assert_eq!(mean_and_scatter(&differences, "1").unwrap().1.scale, Scale::Linear);
    }

    #[test]
    fn a_band_ends_at_the_bound() {
        let scatter = Scatter { scale: Scale::Logarithmic, deviation: 1.0, samples: 20 };
        let band = around_value(&check(Kind::Regression, 0.01, Bound::AtMost(0.05)), scatter, 0.01);
        assert_eq!(band.high, 0.05);
        assert!(band.low < 0.01);
    }

    #[test]
    fn figures_that_are_the_same_on_every_cloud_have_no_scatter() {
        assert!(mean_and_scatter(&[14.0; 20], "1").is_none());
        assert!(mean_and_scatter(&[0.3, 0.3 + 1e-12, 0.3], "1").is_none());
        assert!(mean_and_scatter(&[14.0, 15.0, 14.0], "1").is_some());
    }
}
