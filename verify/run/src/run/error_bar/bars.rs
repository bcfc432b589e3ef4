//! Error bars as plain data.

use super::coarser::CoarserCloud;
use super::no_error_bar::NoErrorBar;
use mtled_case::reference::Quantity;

/// The estimated error of one answer of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBar {
    /// What was answered.
    pub quantity: Quantity,
    /// Estimated length of the error vector at the end of the run, root mean square over the
    /// positions of a lattice, in the unit of the quantity.
    pub size: Result<f64, NoErrorBar>,
}

/// Where the error comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Indicator {
    /// Displacement of a coarser cloud at the nodes of the run \[node\]\[x, y, z\] \[m\].
    pub coarser_displacement: Vec<f64>,
    /// Error bar over the change of the displacement \[–\].
    pub factor: f64,
}

impl Indicator {
    /// Error bars at the nodes \[node\] \[m\] where the run has the displacement
    /// \[node\]\[x, y, z\] \[m\].
    pub(crate) fn sizes(&self, displacement: &[f64]) -> Vec<f64> {
        let changes = displacement.chunks(3).zip(self.coarser_displacement.chunks(3));
        let length = |(own, coarser): (&[f64], &[f64])| {
            own.iter().zip(coarser).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        changes.map(|change| self.factor * length(change)).collect()
    }
}

/// The error bars of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBars {
    /// In the order of the quantities of the case.
    pub bars: Vec<ErrorBar>,
    /// What they were estimated with, the finest first.
    pub clouds: Vec<CoarserCloud>,
    /// The displacement of the first of them that was solved, if frames are written.
    pub indicator: Option<Indicator>,
    /// CPU time of the runs on the coarser clouds, all threads \[s\].
    pub cpu_seconds: f64,
}

impl ErrorBars {
    /// The bar of a quantity by its name, such as `force/top`.
    pub fn of(&self, name: &str) -> Option<&Result<f64, NoErrorBar>> {
        self.bars.iter().find(|bar| bar.quantity.name == name).map(|bar| &bar.size)
    }
}

/// The error bars of a run, or why it has none.
pub type Estimated = Result<ErrorBars, NoErrorBar>;
