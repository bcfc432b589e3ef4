//! Numbers as engineers read them.

use crate::study::Bound;

/// Four significant digits, outside 10⁻³ … 10⁵ in powers of a thousand
/// (`12.34×10⁻⁶`) and of ten where no prefix is in use (`3.210×10⁻¹⁴`); counts
/// below 10⁷ stay whole.
pub fn four_digits(value: f64) -> String {
    significant(value, false)
}

/// A bound with its relation, such as `≤ 0.02`.
pub fn bound_text(bound: &Bound) -> String {
    match *bound {
        Bound::AtMost(limit) => format!("≤ {}", significant(limit, true)),
        Bound::AtLeast(limit) => format!("≥ {}", significant(limit, true)),
        Bound::Between(low, high) => {
            format!("{} … {}", significant(low, true), significant(high, true))
        }
        Bound::Baseline(_) => "that of the baseline".into(),
    }
}

/// `trimmed` drops zeros after the decimal point, for limits that somebody chose.
fn significant(value: f64, trimmed: bool) -> String {
    if value.is_nan() {
        return "not a number".to_string();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞" } else { "−∞" }.to_string();
    }
    if value.fract() == 0.0 && value.abs() < 1e7 {
        return with_minus(format!("{}", value.abs()), value);
    }
    // Rounded first, so that 999.96 counts as 1000.
    let rounded = format!("{:.3e}", value.abs());
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let plain = (-3..5).contains(&exponent);
    let mantissa: f64 = mantissa.parse().unwrap_or(0.0);
    let prefixed = (-9..12).contains(&exponent) && !(trimmed && mantissa == 1.0);
    let shift = match (plain, prefixed) {
        (true, _) => exponent,
        (_, true) => exponent.rem_euclid(3),
        _ => 0,
    };
    let decimals = (3 - shift).max(0) as usize;
    let mut digits = format!("{:.*}", decimals, mantissa * 10_f64.powi(shift));
    if trimmed && digits.contains('.') {
        digits.truncate(digits.trim_end_matches('0').trim_end_matches('.').len());
    }
    if !plain {
        digits = times_power(&digits, exponent - shift);
    }
    with_minus(digits, value)
}

fn times_power(digits: &str, exponent: i32) -> String {
    if digits == "1" {
        power_of_ten(exponent)
    } else {
        format!("{digits}×{}", power_of_ten(exponent))
    }
}

fn with_minus(digits: String, value: f64) -> String {
    if value < 0.0 { format!("−{digits}") } else { digits }
}

/// `10⁻³`.
pub(super) fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let mut text = "10".to_string();
    for c in exponent.to_string().chars() {
        text.push(c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize]));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits_and_powers_of_a_thousand() {
        let cases = [
            (0.0, "0"),
            (27_783.0, "27783"),
            (-6154.0, "−6154"),
            (0.014_727_34, "0.01473"),
            (1.786_17, "1.786"),
            (999.96, "1000"),
            (43_210.7, "43210"),
            (-280_709.4, "−280.7×10³"),
            (1.234e-5, "12.34×10⁻⁶"),
            (9.999_96e-4, "0.001000"),
            (2.5e-15, "2.500×10⁻¹⁵"),
            (3.21e-14, "3.210×10⁻¹⁴"),
            (1e300, "1.000×10³⁰⁰"),
            (f64::NAN, "not a number"),
            (f64::NEG_INFINITY, "−∞"),
        ];
        for (value, expected) in cases {
            assert_eq!(four_digits(value), expected);
        }
    }

    #[test]
    fn bounds_have_no_trailing_zeros() {
        assert_eq!(bound_text(&Bound::AtMost(0.02)), "≤ 0.02");
        assert_eq!(bound_text(&Bound::AtMost(1e-12)), "≤ 10⁻¹²");
        assert_eq!(bound_text(&Bound::AtMost(1e-5)), "≤ 10⁻⁵");
        assert_eq!(bound_text(&Bound::AtLeast(1.8)), "≥ 1.8");
        assert_eq!(bound_text(&Bound::Between(-0.5, 2e-6)), "−0.5 … 2×10⁻⁶");
    }
}
