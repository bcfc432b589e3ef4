//! Manufactured solutions at finite strain: a displacement field is chosen, and
//! its body force is b = −Div P/ρ (Roache 2002, J.
//! Fluids Eng. 124, 4). `reference/manufactured/derive.py` derives the same
//! forces from the strain energies with SymPy.
#![allow(non_snake_case)]

use super::jet::Jet;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::material::{
    ElasticConstants, Law, MaterialError, MooneyRivlin, NeoHookeanIsochoric, NeoHookeanLogJ,
    VolumetricTerm,
};
use std::f64::consts::PI;

/// Constitutive laws, with their first Piola–Kirchhoff stress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Family {
    /// P = μF + (λ ln J − μ)F⁻ᵀ.
    LogJ,
    /// P = μJ^(−2/3)(F − I₁/3 F⁻ᵀ) + K(J − 1)J F⁻ᵀ.
    Isochoric,
    /// Mooney–Rivlin (Horton 2007, section 3.3) with A = 0.4 μ and B = 0.1 μ:
    /// P = 2A F + 2B(I₁F − FC) + [−4C J⁻⁴ + 4D(J⁴ − J²)]F⁻ᵀ.
    MooneyRivlin,
}

/// Displacement fields on the unit cube \[m\].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FieldKind {
    /// u = ½ (sin(πX)/10, Y²Z/2, X ln(1 + Y)/5): J runs from 0.82 to 1.74.
    General,
    /// Three shears, one after the other, of determinant 1:
    /// x = X + Z sin(πY)/10, y = Y + Z x²/10, z = Z + y sin(πx)/10, and on top
    /// μ/λ times `General`, so that the pressure stays of the order of μ.
    NearlyIsochoric,
}

/// A field in a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Manufactured {
    /// The displacement.
    pub field: FieldKind,
    /// The constitutive law.
    pub family: Family,
    /// Of the law.
    pub constants: ElasticConstants,
    /// Per reference volume \[kg/m³\].
    pub density: f64,
}

impl Manufactured {
    /// The displacement u(X) \[m\].
    pub(crate) fn displacement(&self, X: &Vector3) -> Vector3 {
        let [x, y, z] = self.jets(X);
        Vector3::new(x.value, y.value, z.value)
    }

    /// F = I + Grad u.
    pub(crate) fn deformation_gradient(&self, X: &Vector3) -> Matrix3 {
        deformation_gradient(&self.jets(X))
    }

    /// b = −Div P/ρ \[N/kg\], with ∂P_iJ/∂X_J = (∂P/∂F : ∂F/∂X_J)_iJ.
    pub(crate) fn body_force(&self, X: &Vector3) -> Vector3 {
        let u = self.jets(X);
        let F = deformation_gradient(&u);
        let mut divergence = Vector3::zeros();
        for J in 0..3 {
            let slope = Matrix3::from_fn(|i, K| u[i].hessian[(K, J)]);
            divergence += self.family.stress_change(&self.constants, &F, &slope).column(J);
        }
        -divergence / self.density
    }

    fn jets(&self, X: &Vector3) -> [Jet; 3] {
        let at = Jet::coordinates(X);
        match self.field {
            FieldKind::General => general(at),
            FieldKind::NearlyIsochoric => {
                let ratio = self.constants.shear_modulus / self.constants.lame_modulus();
                let (shears, rest) = (shears(at), general(at));
                [0, 1, 2].map(|k| shears[k] + rest[k] * ratio)
            }
        }
    }
}

fn general([x, y, z]: [Jet; 3]) -> [Jet; 3] {
    [(x * PI).sin() * 0.05, y * y * z * 0.25, x * (y + 1.0).ln() * 0.1]
}

fn shears([x, y, z]: [Jet; 3]) -> [Jet; 3] {
    let u = z * (y * PI).sin() * 0.1;
    let x = x + u;
    let v = z * x * x * 0.1;
    let y = y + v;
    [u, v, y * (x * PI).sin() * 0.1]
}

fn deformation_gradient(u: &[Jet; 3]) -> Matrix3 {
    Matrix3::identity() + Matrix3::from_fn(|i, J| u[i].gradient[J])
}

/// A, B, C and D of the Mooney–Rivlin law \[Pa\] (method book, eq. 3.7).
fn mooney_rivlin(constants: &ElasticConstants) -> [f64; 4] {
    let nu = constants.poisson_ratio();
    let (a, b) = (0.4 * constants.shear_modulus, 0.1 * constants.shear_modulus);
    let d = (a * (5.0 * nu - 2.0) + b * (11.0 * nu - 5.0)) / (2.0 * (1.0 - 2.0 * nu));
    [a, b, 0.5 * a + b, d]
}

impl Family {
    /// The solver's law of this family.
    pub(crate) fn law(self, constants: ElasticConstants) -> Result<Law, MaterialError> {
        Ok(match self {
            Family::LogJ => Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants)),
            Family::Isochoric => Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(
                constants,
                VolumetricTerm::Quadratic,
            )),
            Family::MooneyRivlin => {
                let [a, b, ..] = mooney_rivlin(&constants);
                Law::MooneyRivlin(MooneyRivlin::new(a, b, constants.poisson_ratio())?)
            }
        })
    }

    /// dP = ∂P/∂F : dF \[Pa\], from dJ = J F⁻ᵀ:dF and dF⁻ᵀ = −F⁻ᵀ dFᵀ F⁻ᵀ.
    fn stress_change(self, constants: &ElasticConstants, F: &Matrix3, dF: &Matrix3) -> Matrix3 {
        let (mu, K) = (constants.shear_modulus, constants.bulk_modulus);
        let J = F.determinant();
        let G = mtled::algebra::tensor::cofactor(F) / J;
        let dG = -(G * dF.transpose() * G);
        let growth = G.dot(dF);
        let (first, d_first) = (F.dot(F), 2.0 * F.dot(dF));
        match self {
            Family::LogJ => {
                let lambda = constants.lame_modulus();
                dF * mu + G * (lambda * growth) + dG * (lambda * J.ln() - mu)
            }
            Family::Isochoric => {
                let m = mu * J.cbrt().powi(-2);
                let isochoric = (F - G * (first / 3.0)) * (-2.0 / 3.0 * m * growth)
                    + (dF - G * (d_first / 3.0) - dG * (first / 3.0)) * m;
                isochoric + (G * ((2.0 * J - 1.0) * growth) + dG * (J - 1.0)) * (K * J)
            }
            Family::MooneyRivlin => {
                let [a, b, c, d] = mooney_rivlin(constants);
                let (C, dC) = (F.transpose() * F, dF.transpose() * F + F.transpose() * dF);
                let second = F * d_first + dF * first - dF * C - F * dC;
                let w = -4.0 * c * J.powi(-4) + 4.0 * d * (J.powi(4) - J.powi(2));
                let dw = (16.0 * c * J.powi(-4) + 4.0 * d * (4.0 * J.powi(4) - 2.0 * J.powi(2)))
                    * growth;
                dF * (2.0 * a) + second * (2.0 * b) + G * dw + dG * w
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    const FAMILIES: [Family; 3] = [Family::LogJ, Family::Isochoric, Family::MooneyRivlin];
    const FIELDS: [FieldKind; 2] = [FieldKind::General, FieldKind::NearlyIsochoric];

    fn solution(field: FieldKind, family: Family, poisson_ratio: f64) -> Manufactured {
        let constants = ElasticConstants::from_young_poisson(3000.0, poisson_ratio).unwrap();
        Manufactured { field, family, constants, density: 1000.0 }
    }

    fn places() -> [Vector3; 3] {
        [[0.2, 0.7, 0.4], [0.9, 0.1, 0.6], [0.5, 1.0, 1.0]].map(Vector3::from)
    }

    #[test]
    fn the_gradient_is_the_derivative_of_the_displacement() {
        for field in FIELDS {
            let s = solution(field, Family::LogJ, 0.49);
            for X in places() {
                let F = s.deformation_gradient(&X);
                for k in 0..3 {
                    let step = Vector3::ith(k, 1e-6);
                    let u = (s.displacement(&(X + step)) - s.displacement(&(X - step))) / 2e-6;
                    assert!((F.column(k) - Vector3::ith(k, 1.0) - u).norm() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn the_body_force_balances_differences_of_the_solvers_stress() {
        for (field, family) in FIELDS.into_iter().flat_map(|f| FAMILIES.map(|l| (f, l))) {
            let s = solution(field, family, 0.49);
            let law = family.law(s.constants).unwrap();
            let P = |X: Vector3| law.first_piola_kirchhoff(&s.deformation_gradient(&X));
            for X in places() {
                let mut divergence = Vector3::zeros();
                let mut size = 0.0;
                for k in 0..3 {
                    let step = Vector3::ith(k, 1e-5);
                    let slope = (P(X + step) - P(X - step)) / 2e-5;
                    divergence += slope.column(k);
                    size += slope.norm();
                }
                let error = (s.body_force(&X) * s.density + divergence).norm();
                assert!(error < 1e-7 * size, "{field:?} {family:?}: {error} of {size}");
            }
        }
    }

    #[test]
    fn the_nearly_isochoric_field_has_a_pressure_of_the_order_of_mu() {
        for (family, nu) in FAMILIES.into_iter().flat_map(|f| [(f, 0.49), (f, 0.499)]) {
            let s = solution(FieldKind::NearlyIsochoric, family, nu);
            let law = family.law(s.constants).unwrap();
            for X in places() {
                let F = s.deformation_gradient(&X);
                let pressure = -law.cauchy(&F).trace() / 3.0;
                assert!(pressure.abs() < 2.0 * s.constants.shear_modulus, "{family:?} {pressure}");
            }
        }
    }

    #[test]
    fn the_general_field_keeps_j_positive() {
        let s = solution(FieldKind::General, Family::LogJ, 0.3);
        let mut range = (f64::INFINITY, 0.0_f64);
        for n in 0..11 * 11 * 11 {
            let at = |k: usize| (k % 11) as f64 / 10.0;
            let X = Vector3::new(at(n), at(n / 11), at(n / 121));
            let J = s.deformation_gradient(&X).determinant();
            range = (range.0.min(J), range.1.max(J));
        }
        assert!(range.0 > 0.8 && range.1 < 1.8, "{range:?}");
    }

    /// A row of the values derived by SymPy.
    #[derive(Deserialize)]
    struct Derived {
        field: String,
        law: String,
        poisson_ratio: f64,
        position: [f64; 3],
        displacement: [f64; 3],
        deformation_gradient: [[f64; 3]; 3],
        body_force: [f64; 3],
    }

    #[derive(Deserialize)]
    struct File {
        young_modulus: f64,
        density: f64,
        rows: Vec<Derived>,
    }

    #[test]
    fn sympy_derives_the_same_body_forces_from_the_strain_energies() {
        let text = mtled_reference::MANUFACTURED_BODY_FORCES;
        let file: File = serde_json::from_str(text).unwrap();
        assert!(file.rows.len() >= 30);
        for row in file.rows {
            let field = match row.field.as_str() {
                "general" => FieldKind::General,
                _ => FieldKind::NearlyIsochoric,
            };
            let family = match row.law.as_str() {
                "neo_hookean_log_j" => Family::LogJ,
                "neo_hookean_isochoric" => Family::Isochoric,
                _ => Family::MooneyRivlin,
            };
            let constants =
                ElasticConstants::from_young_poisson(file.young_modulus, row.poisson_ratio)
                    .unwrap();
            let s = Manufactured { field, family, constants, density: file.density };
            let X = Vector3::from(row.position);
            let F = Matrix3::from_fn(|i, J| row.deformation_gradient[i][J]);
            assert!((s.displacement(&X) - Vector3::from(row.displacement)).norm() < 1e-15);
            assert!((s.deformation_gradient(&X) - F).norm() < 1e-14);
            let b = Vector3::from(row.body_force);
            // Round-off in J − 1 is multiplied by λ/μ.
            let tolerance = 1e-14 * constants.bulk_modulus / constants.shear_modulus;
            assert!((s.body_force(&X) - b).norm() < 10.0 * tolerance * b.norm().max(1.0));
        }
    }
}
