//! A laterally confined column under its own weight, linear elasticity
//! (after Timoshenko and Goodier 1970, with zero lateral strain).

use mtled::material::ElasticConstants;

/// A column on a fixed base at z = 0, free on top, sides on rollers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConfinedColumn {
    /// \[m\]
    pub height: f64,
    /// \[kg/m³\]
    pub density: f64,
    /// Downwards \[N/kg\].
    pub gravity: f64,
    pub constants: ElasticConstants,
}

impl ConfinedColumn {
    /// Oedometric modulus M = K + 4μ/3 \[Pa\].
    pub fn oedometric_modulus(&self) -> f64 {
        self.constants.bulk_modulus + 4.0 / 3.0 * self.constants.shear_modulus
    }

    /// u_z(z) = −ρg/M (H z − z²/2) \[m\], downwards negative.
    pub fn displacement(&self, z: f64) -> f64 {
        let weight = self.density * self.gravity;
        -weight / self.oedometric_modulus() * (self.height * z - 0.5 * z * z)
    }

    /// σ_zz(z) = −ρg(H − z) \[Pa\], compression negative.
    pub fn axial_stress(&self, z: f64) -> f64 {
        -self.density * self.gravity * (self.height - z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

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
            assert_relative_eq!(stress, c.axial_stress(z), max_relative = 1e-6);
        }
    }

    #[test]
    fn the_base_is_fixed_and_the_top_settles_most() {
        let c = column();
        assert_eq!(c.displacement(0.0), 0.0);
        assert_eq!(c.axial_stress(c.height), 0.0);
        let top = -1000.0 * 9.81 * 0.1 * 0.1 / (2.0 * c.oedometric_modulus());
        assert_relative_eq!(c.displacement(c.height), top, max_relative = 1e-14);
    }
}
