//! Torsion of an incompressible neo-Hookean cylinder at fixed length, lateral
//! surface free (Rivlin 1948; Ogden 1984).

use std::f64::consts::PI;

/// Moment M = πμψR⁴/2 \[N m\] for the shear modulus μ \[Pa\], the twist per
/// length ψ \[rad/m\] and the radius R \[m\].
pub(crate) fn moment(shear_modulus: f64, twist: f64, radius: f64) -> f64 {
    0.5 * PI * shear_modulus * twist * radius.powi(4)
}

/// Axial force N = −πμψ²R⁴/4 \[N\]: negative, because the cylinder is kept from
/// growing longer (Poynting effect).
pub(crate) fn axial_force(shear_modulus: f64, twist: f64, radius: f64) -> f64 {
    -0.25 * PI * shear_modulus * twist * twist * radius.powi(4)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// ∫₀ᴿ f(r) 2πr dr by the midpoint rule.
    fn over_section(radius: f64, f: impl Fn(f64) -> f64) -> f64 {
        let count = 20_000;
        let step = radius / count as f64;
        let ring = |i: usize| (i as f64 + 0.5) * step;
        (0..count).map(|i| f(ring(i)) * 2.0 * PI * ring(i) * step).sum()
    }

    #[test]
    fn moment_and_force_are_the_integrals_of_the_stresses() {
        let (mu, twist, radius) = (1034.0, 7.0, 0.03);
        let shear = |r: f64| mu * twist * r;
        let by_integration = over_section(radius, |r| shear(r) * r);
        assert_relative_eq!(moment(mu, twist, radius), by_integration, max_relative = 1e-8);
        // Radial balance dσ_rr/dr = μψ²r, σ_rr(R) = 0, and σ_zz = σ_rr.
        let axial = |r: f64| 0.5 * mu * twist * twist * (r * r - radius * radius);
        let by_integration = over_section(radius, axial);
        assert_relative_eq!(axial_force(mu, twist, radius), by_integration, max_relative = 1e-8);
    }

    #[test]
    fn turning_the_other_way_turns_the_moment_and_keeps_the_force() {
        assert_eq!(moment(1.0, -2.0, 3.0), -moment(1.0, 2.0, 3.0));
        assert_eq!(axial_force(1.0, -2.0, 3.0), axial_force(1.0, 2.0, 3.0));
        assert!(axial_force(1.0, 2.0, 3.0) < 0.0);
    }
}
