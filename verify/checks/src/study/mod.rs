//! What a study returns: plain data that a report is built from.

mod check;
mod comparison;
mod figure;
mod nan_as_null;
mod outcome;
mod report;
mod table;

pub use check::{Better, Bound, Check, Kind};
pub use comparison::{Band, BandSource, Comparison, Scale, Verdict};
pub(crate) use comparison::{Change, Scatter};
pub use figure::{
    Axis, ColourScale, Drawing, Figure, Layer, LayerStyle, Panels, Plot, Series, SeriesStyle, axis,
    curve, line, names_axis, styled,
};
pub use outcome::Outcome;
pub use report::{Provenance, Report, Study};
pub use table::{Cell, Column, Table, number, text};
