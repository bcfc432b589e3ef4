//! A value with an error bar from three meshes h₁ < h₂ < h₃ (fine first).
//!
//! Order, from norms of differences over the whole array:
//!   (h₃ᵖ − h₂ᵖ)/(h₂ᵖ − h₁ᵖ) = ‖f₃ − f₂‖/‖f₂ − f₁‖,
//! for one ratio r this is p = ln(‖f₃ − f₂‖/‖f₂ − f₁‖)/ln r.
//! Value, per component: f* = f₁ + (f₁ − f₂)/(rᵖ − 1) with r = h₂/h₁.
//! Error bar, per component: GCI |f₁| = F_s |f₂ − f₁|/(rᵖ − 1), F_s = 1.25.
//!
//! p counts where it lies in [0.5, 1.1 p_max]; above p_max it is used as p_max,
//! which makes the bar longer. What else can happen, with d₁ = f₂ − f₁ and
//! d₂ = f₃ − f₂:
//! - d₁ and d₂ point in different directions (cosine in (−0.5, 0.5)), as on
//!   lattices that cross elements anywhere: the norms still bound the error by
//!   the triangle inequality, but there is nothing to extrapolate. The value
//!   is f₁ and F_s = 3.
//! - p in (1.1 p_max, p_max + 1], errors of different orders cancel: nothing is
//!   extrapolated, F_s = 3 with p_max.
//! - p > p_max + 1, the coarse mesh is of no use: f₁ ± 3 |d₁|/(r − 1).
//! - p < 0.5, divergence or oscillation: f₁ ± 3 max(|d₁|, |d₂|)/(r − 1).
//!
//! Differences of rms below 10⁻⁸ of the size of such quantities are round-off
//! (nine digits are stored) and the tolerance of solvers: no order is claimed
//! for them. No bar is shorter than this floor.
//!
//! Roache 1994, J. Fluids Eng. 116, 405; NASA NPARC, Examining Spatial Grid
//! Convergence; the limits of p after Oberkampf and Roy, Verification and
//! Validation in Scientific Computing, 2010, section 8.6.

use mtled_checks::measure::{observed_order, richardson};
use std::fmt;

/// Relative size of differences that are round-off \[–\].
pub(crate) const NOISE: f64 = 1e-8;
/// F_s where three meshes show an order \[–\].
pub const SAFETY: f64 = 1.25;
/// F_s elsewhere \[–\].
pub(crate) const SAFETY_WITHOUT_ORDER: f64 = 3.0;
/// Lowest accepted order \[–\].
pub(crate) const LOWEST_ORDER: f64 = 0.5;
/// Orders above this multiple of the highest are not accepted \[–\].
const TOO_GOOD: f64 = 1.1;
/// Smallest cosine between successive differences of the same direction \[–\].
const SAME_WAY: f64 = 0.5;

/// Where an error bar comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Basis {
    /// Extrapolated with this order, observed and not above the highest.
    Order(f64),
    /// Differences fall with this order in the norm, in changing directions.
    InNorm(f64),
    /// No order was reached; the observed one, if there is one.
    NoOrder(Option<f64>),
    /// Differences are round-off.
    Noise,
}

/// The order, in brackets where it was not accepted.
impl fmt::Display for Basis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Basis::Order(order) => write!(f, "{order:.2}"),
            Basis::InNorm(order) => write!(f, "{order:.2} in the norm"),
            Basis::NoOrder(Some(order)) => write!(f, "({order:.2})"),
            Basis::NoOrder(None) => write!(f, "none"),
            Basis::Noise => write!(f, "round-off"),
        }
    }
}

/// Values with error bars.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Extrapolated, or of the finest mesh.
    pub values: Vec<f64>,
    /// Error bar of each value, in its unit.
    pub errors: Vec<f64>,
    /// What the error bars follow from.
    pub basis: Basis,
}

impl Estimate {
    /// The order that was observed, used or not.
    pub fn observed(&self) -> Option<f64> {
        match self.basis {
            Basis::Order(order) | Basis::InNorm(order) => Some(order),
            Basis::NoOrder(order) => order,
            Basis::Noise => None,
        }
    }
}

/// Extrapolates `fields` on the mesh `sizes`, both from fine to coarse.
/// `highest` is the order that theory allows, `scale` the size of quantities of
/// this kind, in their unit.
pub fn estimate(fields: [&[f64]; 3], sizes: [f64; 3], highest: f64, scale: f64) -> Estimate {
    let [fine, medium, coarse] = fields;
    let near: Vec<f64> = medium.iter().zip(fine).map(|(m, f)| m - f).collect();
    let far: Vec<f64> = coarse.iter().zip(medium).map(|(c, m)| c - m).collect();
    let floor = NOISE * scale;
    let ratio = sizes[1] / sizes[0];
    if rms(&near) <= floor && rms(&far) <= floor {
        return without_order(fine, &near, &far, ratio, floor, Basis::Noise);
    }
    let observed = order(&near, &far, sizes, floor);
    let same_way = cosine(&near, &far);
    match observed {
        Some(p) if (LOWEST_ORDER..=highest + 1.0).contains(&p) && same_way > -SAME_WAY => {
            let basis = match (same_way >= SAME_WAY, p <= TOO_GOOD * highest) {
                (true, true) => Basis::Order(p),
                (false, true) => Basis::InNorm(p),
                (_, false) => Basis::NoOrder(observed),
            };
            with_order(fine, medium, ratio, p.min(highest), floor, basis)
        }
        Some(p) if p > highest + 1.0 => {
            without_order(fine, &near, &near, ratio, floor, Basis::NoOrder(observed))
        }
        observed => without_order(fine, &near, &far, ratio, floor, Basis::NoOrder(observed)),
    }
}

/// f* with F_s = 1.25 if the basis is an order, else f₁ with F_s = 3.
fn with_order(
    fine: &[f64],
    medium: &[f64],
    ratio: f64,
    order: f64,
    floor: f64,
    basis: Basis,
) -> Estimate {
    let extrapolate = matches!(basis, Basis::Order(_));
    let safety = if extrapolate { SAFETY } else { SAFETY_WITHOUT_ORDER };
    let factor = safety / (ratio.powf(order) - 1.0);
    let pairs = || fine.iter().zip(medium);
    let values = if extrapolate {
        pairs().map(|(&f, &m)| richardson(f, m, ratio, order)).collect()
    } else {
        fine.to_vec()
    };
    let errors = pairs().map(|(f, m)| (factor * (m - f).abs()).max(floor)).collect();
    Estimate { values, errors, basis }
}

/// The order of the norms of differences.
fn order(near: &[f64], far: &[f64], sizes: [f64; 3], floor: f64) -> Option<f64> {
    let (near, far) = (rms(near), rms(far));
    observed_order([0.0, near, near + far], sizes, floor)
}

fn without_order(
    fine: &[f64],
    near: &[f64],
    far: &[f64],
    ratio: f64,
    floor: f64,
    basis: Basis,
) -> Estimate {
    let factor = SAFETY_WITHOUT_ORDER / (ratio - 1.0);
    let bar = |(a, b): (&f64, &f64)| (factor * a.abs().max(b.abs())).max(floor);
    Estimate { values: fine.to_vec(), errors: near.iter().zip(far).map(bar).collect(), basis }
}

/// Root of the mean square.
pub(crate) fn rms(numbers: &[f64]) -> f64 {
    (numbers.iter().map(|n| n * n).sum::<f64>() / numbers.len().max(1) as f64).sqrt()
}

fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    product / (rms(a) * rms(b) * a.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use mtled_checks::measure::{asymptotic_ratio, grid_convergence_index};
    use proptest::prelude::*;

    /// NASA NPARC: pressure recovery on three grids, ratio 2.
    const NPARC: [f64; 3] = [0.97050, 0.96854, 0.96178];

    fn digits(value: f64, count: usize) -> String {
        format!("{value:.count$}")
    }

    /// Order, extrapolated value, GCI₁₂ and GCI₂₃ in per cent.
    fn nparc(f: [f64; 3]) -> [f64; 4] {
        let found = estimate([&f[..1], &f[1..2], &f[2..]], [1.0, 2.0, 4.0], 2.0, 1.0);
        let Basis::Order(p) = found.basis else { panic!("{found:?}") };
        let coarse = grid_convergence_index(f[1], f[2], 2.0, p, SAFETY);
        assert_relative_eq!(
            found.errors[0] / f[0],
            grid_convergence_index(f[0], f[1], 2.0, p, SAFETY),
            epsilon = 1e-15
        );
        [p, found.values[0], 100.0 * found.errors[0] / f[0], 100.0 * coarse]
    }

    #[test]
    fn the_nparc_self_test_is_reproduced_to_all_printed_digits() {
        let [p, value, _, coarse] = nparc(NPARC);
        assert_eq!(digits(p, 5), "1.78617");
        assert_eq!(digits(value, 6), "0.971300");
        assert_eq!(digits(coarse, 6), "0.356249");
        // The index of the finest pair was printed by a program that held the
        // three values in single precision: 0.103083 % without that.
        let single = nparc(NPARC.map(|f| f64::from(f as f32)));
        assert_eq!(digits(single[2], 6), "0.103080");
        let [p, _, fine, coarse] = nparc(NPARC);
        assert_eq!(digits(fine, 6), "0.103083");
        assert_eq!(digits(asymptotic_ratio(fine, coarse, 2.0, p), 5), "1.00202");
    }

    proptest! {
        #[test]
        fn a_power_law_is_recovered_within_its_bar(
            limits in prop::collection::vec(-10.0..10.0f64, 1..6),
            factor in 0.1..5.0f64,
            order in 0.6..3.5f64,
            ratios in (1.3..2.5f64, 1.3..2.5f64),
        ) {
            let sizes = [0.01, 0.01 * ratios.0, 0.01 * ratios.0 * ratios.1];
            let slopes = (0..limits.len()).map(|n| factor * (1.0 + n as f64));
            let field = |h: f64| -> Vec<f64> {
                limits.iter().zip(slopes.clone()).map(|(f, a)| f + a * h.powf(order)).collect()
            };
            let fields = sizes.map(field);
            let found = estimate([&fields[0], &fields[1], &fields[2]], sizes, 3.5, 10.0);
            if let Basis::Order(p) = found.basis {
                prop_assert!((p - order).abs() < 1e-3, "{p} instead of {order}");
                for (value, limit) in found.values.iter().zip(&limits) {
                    prop_assert!((value - limit).abs() < 1e-8, "{value} instead of {limit}");
                }
            }
            for ((value, bar), limit) in found.values.iter().zip(&found.errors).zip(&limits) {
                prop_assert!((value - limit).abs() <= *bar);
            }
        }
    }

    #[test]
    fn without_an_order_the_bar_is_long_and_the_value_the_finest() {
        let sizes = [1.0, 2.0, 4.0];
        for (what, values, counted) in [
            ("oscillation", [1.0, 1.1, 1.05], 0.1),
            ("divergence", [1.0, 1.2, 1.3], 0.2),
            ("slow", [1.0, 1.2, 1.41], 0.21),
            ("too fast for the element", [1.0, 1.001, 1.2], 0.001),
        ] {
            let found = estimate([&values[..1], &values[1..2], &values[2..]], sizes, 3.0, 1.0);
            assert!(matches!(found.basis, Basis::NoOrder(_)), "{what}: {found:?}");
            assert_eq!(found.values, [1.0], "{what}");
            assert_relative_eq!(found.errors[0], 3.0 * counted, epsilon = 1e-12);
        }
    }

    #[test]
    fn differences_in_changing_directions_are_bounded_and_not_extrapolated() {
        let fields = [[1.0, 1.0], [1.01, 1.0], [1.01, 1.04]];
        let found = estimate([&fields[0], &fields[1], &fields[2]], [1.0, 2.0, 4.0], 3.0, 1.0);
        let Basis::InNorm(order) = found.basis else { panic!("{found:?}") };
        assert_relative_eq!(order, 2.0, epsilon = 1e-12);
        assert_eq!(found.values, fields[0]);
        assert_relative_eq!(found.errors[0], 3.0 * 0.01 / 3.0, epsilon = 1e-12);
    }

    #[test]
    fn an_order_above_that_of_the_element_does_not_shorten_the_bar() {
        let sizes = [1.0, 2.0, 4.0];
        for (order, safety) in [(3.2, SAFETY), (3.5, SAFETY_WITHOUT_ORDER)] {
            let values = sizes.map(|h: f64| 1.0 + 0.001 * h.powf(order));
            let found = estimate([&values[..1], &values[1..2], &values[2..]], sizes, 3.0, 1.0);
            let bar = safety * (values[1] - values[0]) / 7.0;
            assert_relative_eq!(found.errors[0], bar, epsilon = 1e-12);
            assert_eq!(matches!(found.basis, Basis::Order(_)), safety == SAFETY, "{found:?}");
        }
    }

    #[test]
    fn round_off_claims_no_order() {
        let fields = [[1.0, 2.0], [1.0 + 1e-12, 2.0], [1.0, 2.0 - 2e-12]];
        let found = estimate([&fields[0], &fields[1], &fields[2]], [1.0, 2.0, 4.0], 3.0, 2.0);
        assert_eq!(found.basis, Basis::Noise);
        assert_eq!(found.errors, [2e-8, 2e-8]);
    }
}
