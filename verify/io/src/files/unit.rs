//! Units of length.

/// A unit of length in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// m
    Metre,
    /// mm
    Millimetre,
    /// µm
    Micrometre,
}

impl LengthUnit {
    /// The unit \[m\].
    pub fn in_metres(self) -> f64 {
        match self {
            LengthUnit::Metre => 1.0,
            LengthUnit::Millimetre => 1e-3,
            LengthUnit::Micrometre => 1e-6,
        }
    }
}
