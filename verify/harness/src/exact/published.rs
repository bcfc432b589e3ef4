//! Values from the literature.

/// A published value with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Published {
    /// In `unit`.
    pub value: f64,
    /// Half-width of the interval of the exact value, in `unit`.
    pub uncertainty: f64,
    /// SI unit.
    pub unit: &'static str,
    /// Where it is published.
    pub source: &'static str,
}
