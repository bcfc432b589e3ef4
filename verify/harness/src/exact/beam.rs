//! First frequency of a slender beam at small displacements.

use std::f64::consts::PI;

/// First root β of cos β cosh β = −1: clamped and free ends (Blevins 1979,
/// table 8-1).
pub(crate) const CANTILEVER_ROOT: f64 = 1.875_104_068_711_961;

/// A prismatic beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Beam {
    /// \[m\]
    pub length: f64,
    /// \[m²\]
    pub area: f64,
    /// About the axis of bending \[m⁴\].
    pub second_moment: f64,
    /// \[Pa\]; E/(1 − ν²) for a plate strip in plane strain.
    pub young_modulus: f64,
    /// \[kg/m³\]
    pub density: f64,
}

impl Beam {
    /// First bending frequency, one end clamped \[Hz\]:
    /// f = β²/(2π) √(EI/(ρA L⁴)) (Euler and Bernoulli).
    pub(crate) fn cantilever_frequency(&self) -> f64 {
        self.bending_frequency(CANTILEVER_ROOT)
    }

    /// Shape of the first mode, one end clamped, at the distance x \[m\] from the
    /// clamp, up to a factor: cosh ξ − cos ξ − σ(sinh ξ − sin ξ), ξ = βx/L,
    /// σ = (cosh β + cos β)/(sinh β + sin β) (Blevins 1979, table 8-1).
    pub(crate) fn cantilever_mode(&self, x: f64) -> f64 {
        let beta = CANTILEVER_ROOT;
        let sigma = (beta.cosh() + beta.cos()) / (beta.sinh() + beta.sin());
        let xi = beta * x / self.length;
        xi.cosh() - xi.cos() - sigma * (xi.sinh() - xi.sin())
    }

    fn bending_frequency(&self, root: f64) -> f64 {
        let stiffness = self.young_modulus * self.second_moment;
        let mass = self.density * self.area * self.length.powi(4);
        root * root / (2.0 * PI) * (stiffness / mass).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_root_solves_its_characteristic_equation() {
        assert!((CANTILEVER_ROOT.cos() * CANTILEVER_ROOT.cosh() + 1.0).abs() < 1e-13);
    }

    #[test]
    fn the_turek_hron_flag_swings_near_its_published_frequency() {
        // CSM3 swings at 1.0995 Hz (Turek and Hron 2006); the thin beam is 3 % off.
        let flag = Beam {
            length: 0.35,
            area: 0.02,
            second_moment: 0.02_f64.powi(3) / 12.0,
            young_modulus: 1.4e6 / (1.0 - 0.4 * 0.4),
            density: 1000.0,
        };
        assert_relative_eq!(flag.cantilever_frequency(), 1.0995, max_relative = 0.03);
    }

    #[test]
    fn the_first_mode_is_clamped_at_one_end_and_free_at_the_other() {
        let beam =
            Beam { length: 2.0, area: 1.0, second_moment: 1.0, young_modulus: 1.0, density: 1.0 };
        let mode = |x: f64| beam.cantilever_mode(x);
        let bend = |x: f64| (mode(x + 1e-3) - 2.0 * mode(x) + mode(x - 1e-3)) / 1e-6;
        assert!(mode(0.0).abs() < 1e-15 && mode(1e-4).abs() < 1e-7);
        assert!(bend(2.0).abs() < 1e-5 && (bend(2.0) - bend(1.99)).abs() < 1e-3);
        assert!(mode(2.0) > mode(1.0));
    }
}
