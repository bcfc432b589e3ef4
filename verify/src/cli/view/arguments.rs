//! Arguments of `mtled view`.

use clap::{Args, ValueEnum};
use mtled::algebra::tensor::Vector3;
use mtled_run::picture::{Direction, Shown};
use std::path::PathBuf;

/// Draws the frames of the body that `mtled solve` wrote (body_*.vtu).
#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    /// Folder that `mtled solve --out` wrote.
    pub result: PathBuf,
    /// The picture, .svg [default: RESULT/picture.svg].
    #[arg(short, long, value_name = "FILE.svg")]
    pub out: Option<PathBuf>,
    /// The field that gives the colours: displacement, von_mises_stress, pressure, J,
    /// principal_green_lagrange_strain (its largest), nodal_spacing and, where there are such,
    /// displacement_error_bar, contact_pressure, contact_gap.
    #[arg(long, value_name = "NAME", default_value = "displacement")]
    pub field: String,
    /// Where the viewer stands, seen from the body, such as 1,-1,0.5 [default: in front, to the
    /// right and above; above a plane].
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    pub from: Option<Direction>,
    /// What is shown, from the left [default: before,after,cut; before,after in a plane].
    #[arg(long, value_enum, value_name = "PANEL", value_delimiter = ',')]
    pub show: Vec<PanelName>,
    /// Number of the frame [default: the last].
    #[arg(long, value_name = "N")]
    pub frame: Option<usize>,
}

/// A panel of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PanelName {
    /// The body before, its regions in their colours.
    Before,
    /// The body after, coloured by the field.
    After,
    /// The body after without the half in front of its middle.
    Cut,
}

impl From<PanelName> for Shown {
    fn from(name: PanelName) -> Shown {
        match name {
            PanelName::Before => Shown::Before,
            PanelName::After => Shown::After,
            PanelName::Cut => Shown::Cut,
        }
    }
}

fn direction(text: &str) -> Result<Direction, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z])
            if [x, y, z].iter().all(|c| c.is_finite()) && (x, y, z) != (0.0, 0.0, 0.0) =>
        {
            Ok(Direction(Vector3::new(x, y, z)))
        }
        _ => Err("expected three numbers that are not all zero, such as 1,-1,0.5".into()),
    }
}
