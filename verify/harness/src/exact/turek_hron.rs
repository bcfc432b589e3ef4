//! The elastic flag of Turek and Hron under gravity, at the middle A of its
//! free end: 0.35 m × 0.02 m, plane strain, St Venant–Kirchhoff, ρ = 1000 kg/m³,
//! ν = 0.4, g = 2 N/kg downwards.

use super::published::Published;

const SOURCE: &str =
    "Turek, Hron 2006, Proposal for numerical benchmarking of fluid-structure interaction";

/// A published length whose uncertainty is half a unit of its last digit.
const fn printed(value: f64, uncertainty: f64) -> Published {
    Published { value, uncertainty, unit: "m", source: SOURCE }
}

/// CSM1, E = 1.4 MPa, steady: u_x and u_y of A \[m\].
pub(crate) const CSM1: [Published; 2] = [printed(-7.18767e-3, 5e-9), printed(-66.1023e-3, 5e-8)];

/// CSM2, E = 5.6 MPa, steady: u_x and u_y of A \[m\].
#[cfg(test)]
pub(crate) const CSM2: [Published; 2] = [printed(-0.469000e-3, 5e-10), printed(-16.9739e-3, 5e-8)];

/// CSM3, E = 1.4 MPa, let go at t = 0: mean of the swinging u_y of A \[m\].
pub(crate) const CSM3_MEAN: Published = printed(-63.6e-3, 0.05e-3);

/// CSM3: amplitude of the swinging u_y of A \[m\].
pub(crate) const CSM3_AMPLITUDE: Published = printed(65.2e-3, 0.05e-3);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stiff_flag_bends_as_the_linear_beam_and_swings_about_its_rest() {
        // q L⁴/(8 E' I) with q = ρ g h and E' = E/(1 − ν²).
        let stiffness = 5.6e6 / (1.0 - 0.16) * 0.02_f64.powi(3) / 12.0;
        let beam = -1000.0 * 2.0 * 0.02 * 0.35_f64.powi(4) / (8.0 * stiffness);
        assert!((CSM2[1].value / beam - 1.0).abs() < 0.02, "{beam}");
        assert!((CSM3_MEAN.value / CSM1[1].value - 1.0).abs() < 0.05);
        assert!((CSM3_AMPLITUDE.value + CSM3_MEAN.value).abs() < 3e-3);
    }
}
