//! Inflation of a thick spherical shell of incompressible neo-Hookean material
//! (Green and Zerna 1968, section 3.10; Ogden 1984, section 5.3.2).

/// A shell between the radii `inner` and `outer` \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell {
    /// \[m\]
    pub inner: f64,
    /// \[m\]
    pub outer: f64,
    /// \[Pa\]
    pub shear_modulus: f64,
}

impl Shell {
    /// Stretch \[–\] at the reference radius `at` \[m\] if the inner radius is
    /// stretched by `inner_stretch`: (λ³ − 1)R³ is the same everywhere.
    pub fn stretch(&self, inner_stretch: f64, at: f64) -> f64 {
        let ratio = (self.inner / at).powi(3);
        (1.0 + (inner_stretch.powi(3) - 1.0) * ratio).cbrt()
    }

    /// Pressure inside \[Pa\] over that outside,
    /// P = μ[(2/λ_B + 1/(2λ_B⁴)) − (2/λ_A + 1/(2λ_A⁴))].
    pub fn pressure(&self, inner_stretch: f64) -> f64 {
        let term = |stretch: f64| 2.0 / stretch + 0.5 / stretch.powi(4);
        let outer_stretch = self.stretch(inner_stretch, self.outer);
        self.shear_modulus * (term(outer_stretch) - term(inner_stretch))
    }
}

#[cfg(test)]
mod tests {
    #![allow(non_snake_case)]
    use super::*;
    use approx::assert_relative_eq;

    const SHELL: Shell = Shell { inner: 1.0, outer: 2.0, shear_modulus: 1.0 };

    #[test]
    fn the_known_shell_needs_its_known_pressure() {
        assert_relative_eq!(SHELL.pressure(1.5), 0.755433, epsilon = 5e-7);
        assert_eq!(SHELL.pressure(1.0), 0.0);
    }

    #[test]
    fn the_pressure_is_the_integral_of_the_radial_balance() {
        // P = ∫ 2(σ_t − σ_r)/r dr with σ_t − σ_r = μ(λ² − λ⁻⁴), r = λR, dr = dR/λ².
        let count = 20_000;
        let step = (SHELL.outer - SHELL.inner) / count as f64;
        let ring = |i: usize| {
            let R = SHELL.inner + (i as f64 + 0.5) * step;
            let l = SHELL.stretch(1.5, R);
            2.0 * (l * l - l.powi(-4)) / (l * R) * step / (l * l)
        };
        let integral: f64 = (0..count).map(ring).sum();
        assert_relative_eq!(SHELL.pressure(1.5), integral, max_relative = 1e-8);
    }

    #[test]
    fn the_shell_keeps_its_volume() {
        let radius = |R: f64| R * SHELL.stretch(1.5, R);
        let volume = radius(2.0).powi(3) - radius(1.0).powi(3);
        assert_relative_eq!(volume, 7.0, max_relative = 1e-14);
    }
}
