//! A laterally confined column under its own weight, linear elasticity
//! (after Timoshenko and Goodier 1970, with zero lateral strain).

use mtled::material::ElasticConstants;

/// A column on a fixed base at z = 0, free on top, sides on rollers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ConfinedColumn {
    /// \[m\]
    pub height: f64,
    /// \[kg/m³\]
    pub density: f64,
    /// Downwards \[N/kg\].
    pub gravity: f64,
    /// Of the material.
    pub constants: ElasticConstants,
}

impl ConfinedColumn {
    /// Oedometric modulus M = K + 4μ/3 \[Pa\].
    pub(crate) fn oedometric_modulus(&self) -> f64 {
        self.constants.bulk_modulus + 4.0 / 3.0 * self.constants.shear_modulus
    }

    /// u_z(z) = −ρg/M (H z − z²/2) \[m\], downwards negative.
    pub(crate) fn displacement(&self, z: f64) -> f64 {
        let weight = self.density * self.gravity;
        -weight / self.oedometric_modulus() * (self.height * z - 0.5 * z * z)
    }

    /// Speed of the waves in the column c = √(M/ρ) \[m/s\].
    pub(crate) fn wave_speed(&self) -> f64 {
        (self.oedometric_modulus() / self.density).sqrt()
    }

    /// Displacement of the top \[m\] at `t` \[s\] after gravity sets in on the
    /// column at rest: it falls freely, u = −gt²/2, until the wave from the base
    /// arrives at H/c, and swings about its static sag with the period 4H/c
    /// (d'Alembert; Graff 1975, section 2.1). The departure from the sag is odd
    /// about H/c: w(τ) = u_s(τ² − 1) for |τ| ≤ 1, w(τ) = −w(2 − τ), τ = ct/H.
    pub(crate) fn top_after_release(&self, t: f64) -> f64 {
        let tau = (self.wave_speed() * t / self.height + 1.0).rem_euclid(4.0) - 1.0;
        let departure = if tau <= 1.0 { tau * tau - 1.0 } else { 1.0 - (2.0 - tau).powi(2) };
        self.displacement(self.height) * (1.0 + departure)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::PI;

    fn column() -> ConfinedColumn {
        let constants = ElasticConstants::from_young_poisson(3000.0, 0.4).unwrap();
        ConfinedColumn { height: 0.1, density: 1000.0, gravity: 9.81, constants }
    }

    #[test]
    fn strain_times_modulus_is_the_weight_above() {
        let c = column();
        for z in [0.01, 0.05, 0.09] {
            let strain = (c.displacement(z + 1e-6) - c.displacement(z - 1e-6)) / 2e-6;
            let stress = c.oedometric_modulus() * strain;
            assert_relative_eq!(stress, -1000.0 * 9.81 * (0.1 - z), max_relative = 1e-6);
        }
    }

    #[test]
    fn a_released_top_falls_freely_turns_at_twice_its_sag_and_comes_back() {
        let c = column();
        let (sag, quarter) = (c.displacement(c.height), c.height / c.wave_speed());
        let t = 0.7 * quarter;
        assert_relative_eq!(c.top_after_release(t), -0.5 * 9.81 * t * t, max_relative = 1e-12);
        assert_relative_eq!(c.top_after_release(quarter), sag, max_relative = 1e-12);
        assert_relative_eq!(c.top_after_release(2.0 * quarter), 2.0 * sag, max_relative = 1e-12);
        assert!(c.top_after_release(4.0 * quarter).abs() < 1e-12 * sag.abs());
        // The series of standing waves, u_s(1 − 32/π³ Σ sin(nπ/2)/n³ cos(nπτ/2)), n odd.
        for tau in [0.3, 1.4, 2.2, 3.7_f64] {
            let term = |n: i32| {
                let n = f64::from(2 * n + 1);
                (n * PI / 2.0).sin() * (n * PI * tau / 2.0).cos() / n.powi(3)
            };
            let series = 1.0 - 32.0 / PI.powi(3) * (0..2000).map(term).sum::<f64>();
            assert_relative_eq!(c.top_after_release(tau * quarter), sag * series, epsilon = 1e-9);
        }
    }

    #[test]
    fn the_base_is_fixed_and_the_top_settles_most() {
        let c = column();
        assert_eq!(c.displacement(0.0), 0.0);
        let top = -1000.0 * 9.81 * 0.1 * 0.1 / (2.0 * c.oedometric_modulus());
        assert_relative_eq!(c.displacement(c.height), top, max_relative = 1e-14);
    }
}
