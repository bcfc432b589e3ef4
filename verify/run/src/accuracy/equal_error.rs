//! The cost of an error, interpolated between runs of a refinement series.

/// A cost at an error, in the unit of the cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// The cost, or its upper bound.
    pub value: f64,
    /// Whether it is an upper bound: the coarsest run is more accurate already.
    pub at_most: bool,
}

/// The cost at which (error, cost) `runs`, from coarse to fine, first reach `error`, by
/// logarithmic interpolation between two neighbours. None where no run is that accurate;
/// nothing is extrapolated.
pub fn cost_at(runs: &[(f64, f64)], error: f64) -> Option<Cost> {
    let &(first_error, first_cost) = runs.first()?;
    if first_error <= error {
        return Some(Cost { value: first_cost, at_most: true });
    }
    let crossing = runs.windows(2).find(|pair| pair[0].0 > error && pair[1].0 <= error)?;
    let [(worse, cheap), (better, expensive)] = [crossing[0], crossing[1]];
    let fraction = (worse / error).ln() / (worse / better).ln();
    Some(Cost { value: cheap * (expensive / cheap).powf(fraction), at_most: false })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_power_law_is_interpolated_exactly() {
        let runs: Vec<(f64, f64)> =
            [1.0, 4.0, 16.0].map(|cost: f64| (2.0 / cost.sqrt(), cost)).to_vec();
        for error in [1.7, 1.0, 0.6] {
            let cost = cost_at(&runs, error).unwrap();
            assert_relative_eq!(cost.value, (2.0 / error).powi(2), epsilon = 1e-12);
            assert!(!cost.at_most);
        }
    }

    #[test]
    fn nothing_is_extrapolated() {
        let runs = [(1.0, 1.0), (0.5, 2.0)];
        assert_eq!(cost_at(&runs, 0.4), None);
        assert_eq!(cost_at(&runs, 2.0), Some(Cost { value: 1.0, at_most: true }));
        assert_eq!(cost_at(&[], 2.0), None);
    }

    #[test]
    fn a_finer_run_with_a_larger_error_does_not_matter() {
        let runs = [(1.0, 1.0), (0.25, 4.0), (0.3, 8.0)];
        assert_relative_eq!(cost_at(&runs, 0.5).unwrap().value, 2.0, epsilon = 1e-12);
    }
}
