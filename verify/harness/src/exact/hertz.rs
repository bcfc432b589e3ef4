//! Frictionless contact of elastic spheres at small displacements (Hertz 1882;
//! Johnson 1985, section 4.2).

use std::f64::consts::PI;

/// Two spheres, or a sphere and a half-space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// R with 1/R = 1/R₁ + 1/R₂ \[m\]; a half-space has no curvature.
    pub relative_radius: f64,
    /// E* with 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ \[Pa\]; a rigid sphere has
    /// no compliance.
    pub contact_modulus: f64,
}

impl Contact {
    /// a = √(Rδ) \[m\] at the approach δ \[m\].
    pub fn radius(&self, approach: f64) -> f64 {
        (self.relative_radius * approach).sqrt()
    }

    /// F = 4/3 E* √R δ^(3/2) \[N\].
    pub fn force(&self, approach: f64) -> f64 {
        4.0 / 3.0 * self.contact_modulus * self.relative_radius.sqrt() * approach.powf(1.5)
    }

    /// Pressure in the middle p₀ = 2E*a/(πR) \[Pa\].
    pub fn peak_pressure(&self, approach: f64) -> f64 {
        2.0 * self.contact_modulus * self.radius(approach) / (PI * self.relative_radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn two_equal_spheres_press_as_published() {
        // code_aster V6.04.104: R = 50 mm, E = 20 GPa, ν = 0.3, approach 4 mm.
        let contact = Contact { relative_radius: 0.025, contact_modulus: 20e9 / (2.0 * 0.91) };
        assert_relative_eq!(contact.radius(4e-3), 10e-3, max_relative = 1e-12);
        assert_relative_eq!(contact.peak_pressure(4e-3), 2798.3e6, max_relative = 2e-5);
    }

    #[test]
    fn the_force_is_the_integral_of_the_pressure_and_follows_the_energy() {
        let contact = Contact { relative_radius: 0.3, contact_modulus: 7.0 };
        let (approach, a) = (0.02, contact.radius(0.02));
        // ∫ p₀ √(1 − r²/a²) 2πr dr = 2/3 p₀ πa².
        let force = 2.0 / 3.0 * contact.peak_pressure(approach) * PI * a * a;
        assert_relative_eq!(contact.force(approach), force, max_relative = 1e-13);
        assert_relative_eq!(contact.force(4.0 * approach), 8.0 * force, max_relative = 1e-13);
    }
}
