//! Arguments of `mtled warp`.

use clap::{Args, ValueEnum};
use mtled_io::files::LengthUnit;
use std::path::PathBuf;

/// Image files are .nii, .nii.gz or .nrrd, told by their endings. Fields are on the grid of the
/// image: vectors in mm along L, P and S in single precision, as ITK, SimpleITK and ANTs read
/// them (NIfTI: five axes, intent 1007). --field has u at the voxels of the undeformed space;
/// --inverse-field has at each voxel x of the deformed space the vector X − x to where it came
/// from, found by iterating X = x − u(X) until |X + u(X) − x| is at most 0.0001 mm. It is the
/// inverse field that a resampler of ITK deforms the image with. Voxels for which that does not
/// converge, such as where the body has folded, are counted and keep the best vector.
///
/// The deformed image has the grid, directions and data type of the image. Voxels that came from
/// outside of it are 0. Inside the body u is the field of the approximation. Outside it is that
/// of the nearest point of the body and decays smoothly to zero over the distance of --decay; it
/// may jump where two parts of the body are equally near.
#[derive(Debug, Args)]
pub(crate) struct WarpArgs {
    /// Folder that `mtled solve --out` wrote.
    pub result: PathBuf,
    /// Image or label map of the space of the case.
    #[arg(long, value_name = "FILE", required_unless_present_any = ["points", "surfaces"])]
    pub image: Option<PathBuf>,
    /// Deformed image [default: RESULT/deformed_<name of the image>].
    #[arg(long, value_name = "FILE", requires = "image")]
    pub out: Option<PathBuf>,
    /// The image has labels: each voxel takes the nearest one instead of a linear interpolation.
    #[arg(long, requires = "image")]
    pub labels: bool,
    /// Displacement field u(X) on the grid of the image.
    #[arg(long, value_name = "FILE", requires = "image")]
    pub field: Option<PathBuf>,
    /// Inverse displacement field X(x) − x on the grid of the image.
    #[arg(long, value_name = "FILE", requires = "image")]
    pub inverse_field: Option<PathBuf>,
    /// Unit of length of the image, where that of its file is wrong.
    #[arg(long, value_enum, value_name = "UNIT", requires = "image")]
    pub image_unit: Option<Unit>,
    /// Landmarks in RAS: columns name, x, y, z and, where they were found again, x2, y2, z2.
    #[arg(long, value_name = "FILE.csv")]
    pub points: Option<PathBuf>,
    /// Unit of the landmarks, where their header does not state it, as in x_mm.
    #[arg(long, value_enum, value_name = "UNIT", requires = "points")]
    pub unit: Option<Unit>,
    /// Landmarks after the deformation, with registration errors [default: RESULT/landmarks.csv].
    #[arg(long, value_name = "FILE.csv", requires = "points")]
    pub points_out: Option<PathBuf>,
    /// Folder for the surfaces of the body and of its regions before and after, NAME.stl and
    /// NAME_deformed.stl, in mm along L, P and S as 3D Slicer reads them.
    #[arg(long, value_name = "FOLDER")]
    pub surfaces: Option<PathBuf>,
    /// Distance outside of the body over which the displacement decays to zero; 0 ends it at the
    /// boundary [default: three times the largest displacement, so that nothing folds].
    #[arg(long, value_name = "MM", value_parser = not_negative, allow_hyphen_values = true)]
    pub decay: Option<f64>,
    /// The case file that was solved, where it has been moved since.
    #[arg(long, value_name = "FILE")]
    pub case: Option<PathBuf>,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Unit {
    M,
    Mm,
    Um,
}

impl From<Unit> for LengthUnit {
    fn from(unit: Unit) -> LengthUnit {
        match unit {
            Unit::M => LengthUnit::Metre,
            Unit::Mm => LengthUnit::Millimetre,
            Unit::Um => LengthUnit::Micrometre,
        }
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if (0.0..f64::INFINITY).contains(&number) => Ok(number),
        _ => Err("expected a number of millimetres, 0 or more".into()),
    }
}
