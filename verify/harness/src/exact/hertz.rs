//! Frictionless contact of elastic spheres at small displacements (Hertz 1882;
//! Johnson 1985, section 4.2).

/// Two spheres, or a sphere and a half-space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Contact {
    /// R with 1/R = 1/R₁ + 1/R₂ \[m\]; a half-space has no curvature.
    pub relative_radius: f64,
    /// E* with 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ \[Pa\]; a rigid sphere has
    /// no compliance.
    pub contact_modulus: f64,
}

impl Contact {
    /// F = 4/3 E* √R δ^(3/2) \[N\].
    pub(crate) fn force(&self, approach: f64) -> f64 {
        4.0 / 3.0 * self.contact_modulus * self.relative_radius.sqrt() * approach.powf(1.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_force_is_the_integral_of_the_published_pressure() {
        // code_aster V6.04.104: R = 50 mm, E = 20 GPa, ν = 0.3, approach 4 mm, p₀ = 2798.3 MPa over a
        // radius of 10 mm; ∫ p₀ √(1 − r²/a²) 2πr dr = 2/3 p₀ πa².
        let contact = Contact { relative_radius: 0.025, contact_modulus: 20e9 / (2.0 * 0.91) };
        let force = 2.0 / 3.0 * 2798.3e6 * std::f64::consts::PI * 0.01 * 0.01;
        assert_relative_eq!(contact.force(4e-3), force, max_relative = 2e-5);
        assert_relative_eq!(contact.force(16e-3), 8.0 * contact.force(4e-3), max_relative = 1e-13);
    }
}
