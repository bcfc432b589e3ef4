//! Viscosity of tissue: a Prony series of the isochoric stress.

use crate::material::constants::{MaterialError, positive};

/// A term g e^(−t/τ) of [`PronySeries`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PronyTerm {
    /// The part of the isochoric stress that relaxes with it \[–\].
    pub g: f64,
    /// Its relaxation time \[s\].
    pub tau: f64,
}

/// g(t) = 1 − Σ_i g_i (1 − e^(−t/τ_i)): what is left at time t after a sudden strain of the isochoric
/// stress that the law gives, whose constants are those of a sudden strain (Miller, Chinzei, J.
/// Biomech. 35, 483, 2002, eq. 5; method book, eq. 3.23).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PronySeries {
    terms: [PronyTerm; PronySeries::MOST],
    count: usize,
}

impl PronySeries {
    /// Terms at most.
    pub const MOST: usize = 6;

    /// One to six terms with g_i > 0, τ_i > 0 and Σ g_i < 1: something must be left in the end.
    ///
    /// # Errors
    /// [`MaterialError`] otherwise.
    pub fn new(terms: &[PronyTerm]) -> Result<PronySeries, MaterialError> {
        let count = terms.len();
        if count == 0 || count > PronySeries::MOST {
            return Err(MaterialError::PronyTerms { count, most: PronySeries::MOST });
        }
        let mut padded = [PronyTerm { g: 0.0, tau: 1.0 }; PronySeries::MOST];
        for (term, given) in padded.iter_mut().zip(terms) {
            given.check()?;
            *term = *given;
        }
        let series = PronySeries { terms: padded, count };
        match series.relaxing() {
            sum if sum < 1.0 => Ok(series),
            sum => Err(MaterialError::PronySum { sum }),
        }
    }

    /// Its terms.
    pub fn terms(&self) -> &[PronyTerm] {
        &self.terms[..self.count]
    }

    /// Σ g_i, the part of the isochoric stress that relaxes in the end \[–\].
    pub fn relaxing(&self) -> f64 {
        self.terms().iter().map(|term| term.g).sum()
    }
}

impl PronyTerm {
    /// Refuses g or τ that is not positive.
    ///
    /// # Errors
    /// [`MaterialError::NotPositive`]
    pub fn check(&self) -> Result<(), MaterialError> {
        positive("g", self.g)?;
        positive("tau", self.tau)
    }

    /// e^(−Δt/τ), what is left of a stress after Δt \[s\], and the mean of that over Δt, what is left
    /// of one that grew by equal parts in it.
    pub fn left_after(&self, interval: f64) -> (f64, f64) {
        let x = interval / self.tau;
        let mean = if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 };
        ((-x).exp(), mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(terms: &[(f64, f64)]) -> Result<PronySeries, MaterialError> {
        let terms: Vec<PronyTerm> = terms.iter().map(|&(g, tau)| PronyTerm { g, tau }).collect();
        PronySeries::new(&terms)
    }

    #[test]
    fn what_cannot_be_a_series_is_refused() {
        let message = |terms: &[(f64, f64)]| series(terms).unwrap_err().to_string();
        assert!(message(&[]).contains("has 0 terms"));
        assert!(message(&[(0.1, 1.0); 7]).contains("one to 6"));
        assert!(message(&[(0.6, 1.0), (0.4, 2.0)]).contains("sum to 1"));
        assert!(message(&[(-0.1, 1.0)]).contains("g is -0.1"));
        assert!(message(&[(0.1, -1.0)]).contains("tau is -1"));
        assert!(message(&[(0.1, f64::NAN)]).contains("tau is NaN"));
    }

    #[test]
    fn a_stress_that_grows_steadily_leaves_the_mean_of_the_decay() {
        let term = PronyTerm { g: 0.5, tau: 2.0 };
        assert_eq!(term.left_after(0.0), (1.0, 1.0));
        let (left, mean) = term.left_after(3.0);
        assert!((left - (-1.5f64).exp()).abs() < 1e-15);
        let sum: f64 = (0..10_000).map(|n| (-1.5 * (n as f64 + 0.5) / 1e4).exp()).sum();
        assert!((mean - sum / 1e4).abs() < 1e-9);
        // Short intervals lose no digits.
        assert!((term.left_after(1e-12).1 - 1.0).abs() < 1e-12);
    }
}
