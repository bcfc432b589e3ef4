//! A ball of another material in an unbounded body under a uniform strain far away, at small
//! displacements (Goodier 1933; Eshelby 1957).
#![allow(non_snake_case)]

use mtled::algebra::tensor::{Matrix3, Vector3};

/// The ball, whose centre is the origin, and the body around it, with one Poisson ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inclusion {
    /// Of the ball \[m\].
    pub radius: f64,
    /// Young's modulus of the ball over that around it \[–\].
    pub stiffness_ratio: f64,
    /// Of both materials.
    pub poisson_ratio: f64,
    /// Far away, symmetric.
    pub strain: Matrix3,
}

impl Inclusion {
    /// ε/3 of the strain far away and the rest E′ of it.
    fn parts(&self) -> (f64, Matrix3) {
        let mean = self.strain.trace() / 3.0;
        (mean, self.strain - Matrix3::from_diagonal_element(mean))
    }

    /// Strains of the ball over those far away: of the volume, 1/(1 + α(k − 1)) with
    /// α = (1 + ν)/(3(1 − ν)), and of the shape, 1/(1 + β(k − 1)) with
    /// β = 2(4 − 5ν)/(15(1 − ν)) (Eshelby 1957), k the ratio of the moduli.
    fn concentrations(&self) -> (f64, f64) {
        let (nu, excess) = (self.poisson_ratio, self.stiffness_ratio - 1.0);
        let alpha = (1.0 + nu) / (3.0 * (1.0 - nu));
        let beta = 2.0 * (4.0 - 5.0 * nu) / (15.0 * (1.0 - nu));
        (1.0 / (1.0 + alpha * excess), 1.0 / (1.0 + beta * excess))
    }

    /// u \[m\] at a place. Inside it is linear; outside, with t = a/r and n = X/r,
    /// u = (1 + (c − 1) t³) ε X/3 + (1 + B (1.2 t⁵ + (2 − 4ν) t³)) E′X + 3 B (t³ − t⁵) n (n·E′X),
    /// B = (c′ − 1)/(3.2 − 4ν), from a centre of dilatation, a force dipole and the gradient of a
    /// harmonic function, which meet the displacement of the ball.
    pub(crate) fn displacement(&self, X: &Vector3) -> Vector3 {
        let (mean, rest) = self.parts();
        let (of_volume, of_shape) = self.concentrations();
        let (r, change) = (X.norm(), rest * X);
        if r <= self.radius {
            return of_volume * mean * X + of_shape * change;
        }
        let (t, n, nu) = (self.radius / r, X / r, self.poisson_ratio);
        let (cube, fifth) = (t.powi(3), t.powi(5));
        let dipole = (of_shape - 1.0) / (3.2 - 4.0 * nu);
        (1.0 + (of_volume - 1.0) * cube) * mean * X
            + (1.0 + dipole * (1.2 * fifth + (2.0 - 4.0 * nu) * cube)) * change
            + 3.0 * dipole * (cube - fifth) * n * n.dot(&change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mtled::material::ElasticConstants;

    const BALLS: [(f64, f64); 4] = [(1.0 / 300.0, 0.3), (0.1, 0.45), (10.0, 0.0), (300.0, 0.3)];

    fn inclusion((stiffness_ratio, poisson_ratio): (f64, f64)) -> Inclusion {
        let strain = Matrix3::new(1.0, 0.3, 0.0, 0.3, -0.2, 0.1, 0.0, 0.1, 0.4);
        Inclusion { radius: 0.3, stiffness_ratio, poisson_ratio, strain }
    }

    /// ∇u by central differences.
    fn gradient(ball: &Inclusion, X: &Vector3) -> Matrix3 {
        let h = 1e-5;
        let column = |k: usize| {
            let step = Vector3::ith(k, h);
            (ball.displacement(&(X + step)) - ball.displacement(&(X - step))) / (2.0 * h)
        };
        Matrix3::from_columns(&[column(0), column(1), column(2)])
    }

    /// σ for E = 1 around the ball.
    fn stress(ball: &Inclusion, X: &Vector3) -> Matrix3 {
        let young = if X.norm() < ball.radius { ball.stiffness_ratio } else { 1.0 };
        let constants = ElasticConstants::from_young_poisson(young, ball.poisson_ratio).unwrap();
        let strain = gradient(ball, X).symmetric_part();
        Matrix3::from_diagonal_element(constants.lame_modulus() * strain.trace())
            + 2.0 * constants.shear_modulus * strain
    }

    #[test]
    fn displacement_and_traction_are_continuous_across_the_border() {
        for ball in BALLS.map(inclusion) {
            for n in [Vector3::new(1.0, 2.0, -2.0) / 3.0, Vector3::z(), Vector3::new(0.6, 0.0, 0.8)]
            {
                let (inside, outside) = (n * (ball.radius - 2e-5), n * (ball.radius + 2e-5));
                let jump = ball.displacement(&outside) - ball.displacement(&inside);
                assert!(jump.norm() < 1e-3, "{jump}");
                let traction = [inside, outside].map(|X| stress(&ball, &X) * n);
                assert!((traction[0] - traction[1]).norm() < 2e-3, "{traction:?}");
            }
        }
    }

    #[test]
    fn the_body_around_is_in_equilibrium_and_strained_as_stated_far_away() {
        for ball in BALLS.map(inclusion) {
            let (X, h) = (Vector3::new(0.3, -0.2, 0.25), 1e-3);
            let slope = |k: usize| {
                let step = Vector3::ith(k, h);
                (stress(&ball, &(X + step)) - stress(&ball, &(X - step))).column(k) / (2.0 * h)
            };
            let force = slope(0) + slope(1) + slope(2);
            assert!(force.norm() < 1e-3, "{force}");
            let far = gradient(&ball, &Vector3::new(20.0, 30.0, -25.0));
            assert!((far - ball.strain).norm() < 1e-4, "{far}");
        }
    }

    #[test]
    fn an_equal_material_changes_nothing() {
        let ball = inclusion((1.0, 0.3));
        for X in [Vector3::new(0.1, 0.0, 0.05), Vector3::new(0.5, -0.4, 0.2)] {
            assert!((ball.displacement(&X) - ball.strain * X).norm() < 1e-15);
        }
    }
}
