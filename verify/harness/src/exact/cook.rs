//! Cook's membrane at finite strain: corners (0,0), (48,44), (48,60), (0,44) mm,
//! 1 mm thick, plane strain, left edge clamped, dead load of 1 N up on the right
//! edge, ψ = μ/2(J^(−2/3)I₁ − 3) + K/4(J² − 1 − 2 ln J), μ = 0.4225 MPa, ν = 0.3.

use super::published::Published;

/// u_y at (48, 52) mm, the middle of the loaded edge \[m\]: 14.74 mm; the
/// uncertainty is the difference from 14.7273 mm of Abaqus with 36 864 cells.
pub(crate) const TIP: Published = Published {
    value: 14.74e-3,
    uncertainty: 14.74e-3 - 14.7273e-3,
    unit: "m",
    source: "deal.II code gallery, Quasi-Static Finite-Strain Compressible Elasticity",
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_codes_agree_within_a_thousandth() {
        let relative = TIP.uncertainty / TIP.value;
        assert!(relative < 1e-3, "{relative}");
    }
}
