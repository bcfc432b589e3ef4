//! Vectors at the voxels of an image, such as displacements or directions of fibres.

use super::format::ImageFormat;
use super::grid::Grid;
use crate::files::bytes;
use crate::files::error::{FileError, Mistake};
use crate::files::nifti::{Content, read_voxels};
use crate::files::nrrd::{Opened, open_image, stored};
use crate::files::unit::LengthUnit;
use crate::files::voxels::voxel_count;
use mtled::algebra::tensor::{Matrix3, Vector3};
use std::path::{Path, PathBuf};

/// What the components of vectors are measured along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VectorFrame {
    /// Right, anterior, superior.
    Ras,
    /// Left, posterior, superior.
    Lps,
    /// The voxels, each step of length 1, the first turned round where the three are right-handed:
    /// so do the b-vectors of FSL count, and with them the directions of its dtifit.
    Fsl,
}

impl VectorFrame {
    /// Turns components into RAS; `directions` are the steps from voxel to voxel.
    fn to_ras(self, directions: &Matrix3) -> Matrix3 {
        match self {
            VectorFrame::Ras => Matrix3::identity(),
            VectorFrame::Lps => Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0)),
            VectorFrame::Fsl => {
                let mut steps = *directions;
                steps.column_iter_mut().for_each(|mut step| {
                    step.normalize_mut();
                });
                if steps.determinant() > 0.0 {
                    steps.column_mut(0).neg_mut();
                }
                steps
            }
        }
    }
}

/// Vectors at places, and the files they came from.
#[derive(Debug, Clone)]
pub struct VectorFile {
    /// Centres of voxels and their vectors, both in RAS \[m\]. Voxels whose vector is no number
    /// have none.
    pub vectors: Vec<(Vector3, Vector3)>,
    /// The file that was named, then another that belongs to it.
    pub files: Vec<PathBuf>,
    /// Reasons to doubt where the voxels lie.
    pub notes: Vec<String>,
}

/// Reads an image of vectors. `unit` overrides what the file states, and `frame` that of an NRRD file; NIfTI has none,
/// so that it must be given.
pub fn read_vectors(
    path: &Path,
    unit: Option<LengthUnit>,
    frame: Option<VectorFrame>,
) -> Result<VectorFile, FileError> {
    match ImageFormat::of_input(path)? {
        ImageFormat::Nifti | ImageFormat::NiftiGz => {
            let frame = frame.ok_or_else(|| Mistake::NoVectorFrame.of(path))?;
            of_nifti(path, unit, frame)
        }
        ImageFormat::Nrrd => {
            let opened = open_image(path)?;
            of_nrrd(opened, unit, frame).map_err(|mistake| mistake.of(path))
        }
    }
}

fn of_nifti(
    path: &Path,
    unit: Option<LengthUnit>,
    frame: VectorFrame,
) -> Result<VectorFile, FileError> {
    let voxels = read_voxels(path, Content::Vectors)?;
    let made = voxels.frame(unit).and_then(|(origin, directions)| {
        let (grid, metres) = (Grid::new(voxels.size, origin, directions)?, voxels.metres(unit)?);
        let numbers: Vec<f64> =
            bytes::numbers(&voxels.stored, voxels.scalar, voxels.order).collect();
        let (count, (slope, intercept)) = (grid.count(), voxels.scaling);
        let vector =
            |n: usize| Vector3::from_fn(|axis, _| slope * numbers[axis * count + n] + intercept);
        Ok(placed(&grid, frame.to_ras(&directions) * metres, vector))
    });
    let vectors = made.map_err(|mistake| mistake.of(path))?;
    Ok(VectorFile { vectors, files: voxels.files, notes: voxels.notes })
}

fn of_nrrd(
    opened: Opened,
    unit: Option<LengthUnit>,
    frame: Option<VectorFrame>,
) -> Result<VectorFile, Mistake> {
    let Opened { header, data, length, files, .. } = opened;
    let ((components, size), scalar) = (header.layers_and_sizes()?, header.scalar()?);
    if components != 3 {
        let expected = "four numbers, the first of them 3, the components of a vector";
        let sizes = header.get("sizes").unwrap_or_default();
        return Err(Mistake::bad_field("sizes", sizes, expected));
    }
    let order = header.byte_order(scalar, header.encoding()?)?;
    let (origin, directions) = header.frame(unit)?;
    let (grid, metres) = (Grid::new(size, origin, directions)?, header.metres(unit)?);
    let to_ras = match frame {
        Some(frame) => frame.to_ras(&directions),
        None => header.measurement_frame()?,
    };
    let count = 3 * voxel_count(&size)?;
    let bytes = stored(&header, data, length, count * scalar.size())?;
    let numbers: Vec<f64> = bytes::numbers(&bytes, scalar, order).collect();
    let vector = |n: usize| Vector3::from_column_slice(&numbers[3 * n..3 * n + 3]);
    let vectors = placed(&grid, to_ras * metres, vector);
    Ok(VectorFile { vectors, files, notes: header.doubts() })
}

fn placed(
    grid: &Grid,
    to_ras: Matrix3,
    vector: impl Fn(usize) -> Vector3,
) -> Vec<(Vector3, Vector3)> {
    let [nx, ny, _] = grid.size;
    let row = |n: usize| {
        let centre = grid.centre([n % nx, n / nx % ny, n / (nx * ny)]);
        (centre, to_ras * vector(n))
    };
    (0..grid.count()).map(row).filter(|(_, v)| v.iter().all(|c| c.is_finite())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::image::field_bytes;

    /// A grid whose steps are neither alike nor along the axes of the world.
    fn grid(hand: f64) -> Grid {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.2, 0.5);
        let steps = Vector3::new(hand * 1e-3, 1.5e-3, 2e-3);
        let directions = turn.matrix() * Matrix3::from_diagonal(&steps);
        Grid::new([3, 2, 2], Vector3::new(0.01, -0.02, 0.03), directions).unwrap()
    }

    fn vector(n: usize) -> [f32; 3] {
        [n as f32 * 1e-3, 2e-3, -1e-3 * (n * n) as f32]
    }

    /// What is read of a file of these bytes.
    fn read(name: &str, bytes: &[u8], frame: Option<VectorFrame>) -> Result<VectorFile, FileError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        read_vectors(&path, None, frame)
    }

    fn written(name: &str, hand: f64) -> Vec<u8> {
        let format = ImageFormat::of_output(Path::new(name)).unwrap();
        let vectors: Vec<[f32; 3]> = (0..grid(hand).count()).map(vector).collect();
        field_bytes(&grid(hand), &vectors, format, Path::new(name)).unwrap()
    }

    #[test]
    fn a_field_that_was_written_is_read_at_its_places() {
        for (name, frame) in [
            ("u.nrrd", None),
            ("u.nii", Some(VectorFrame::Lps)),
            ("u.nii.gz", Some(VectorFrame::Lps)),
        ] {
            for hand in [1.0, -1.0] {
                let file = read(name, &written(name, hand), frame).unwrap();
                assert_eq!(file.vectors.len(), 12, "{name}");
                for (n, (position, found)) in file.vectors.iter().enumerate() {
                    let centre = grid(hand).centre([n % 3, n / 3 % 2, n / 6]);
                    assert!((position - centre).norm() < 1e-8, "{name} {n}");
                    let known = Vector3::from(vector(n).map(f64::from));
                    assert!((found - known).norm() < 1e-8, "{name} {n}");
                }
            }
        }
    }

    #[test]
    fn directions_of_fsl_lie_along_the_voxels_whichever_hand_they_have() {
        for hand in [1.0, -1.0] {
            let directions = grid(hand).directions;
            let along = |axis: usize| directions.column(axis).normalize();
            let to_ras = VectorFrame::Fsl.to_ras(&directions);
            assert!((to_ras * Vector3::x() + hand * along(0)).norm() < 1e-15);
            assert!((to_ras * Vector3::y() - along(1)).norm() < 1e-15);
            assert!(to_ras.determinant() < 0.0);
        }
    }

    #[test]
    fn a_measurement_frame_turns_vectors_before_the_space_does() {
        let header = "NRRD0004\ntype: float\ndimension: 4\nspace: LPS\nsizes: 3 1 1 1\n\
                      space directions: none (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n\
                      measurement frame: (0,1,0) (-1,0,0) (0,0,1)\nendian: little\n\
                      encoding: raw\n\n";
        let numbers = [1000f32, 2000.0, 3000.0].map(f32::to_le_bytes).concat();
        let bytes = [header.as_bytes(), &numbers].concat();
        let found = read("v.nrrd", &bytes, None).unwrap().vectors;
        // (1, 2, 3) along (0, 1, 0), (−1, 0, 0), (0, 0, 1) is (−2, 1, 3) in LPS.
        assert_eq!(found, [(Vector3::zeros(), Vector3::new(2.0, -1.0, 3.0))]);
    }

    #[test]
    fn voxels_without_numbers_have_no_vector() {
        let mut bytes = written("u.nii", 1.0);
        let second = bytes.len() - 4 * 12 + 4;
        bytes[second..second + 4].copy_from_slice(&f32::NAN.to_le_bytes());
        let found = read("u.nii", &bytes, Some(VectorFrame::Ras)).unwrap().vectors;
        assert_eq!(found.len(), 11);
    }

    #[test]
    fn nifti_without_a_frame_and_images_of_single_numbers_are_refused() {
        let refused =
            |name: &str, bytes: &[u8], frame| read(name, bytes, frame).unwrap_err().to_string();
        let message = refused("u.nii", &written("u.nii", 1.0), None);
        assert!(message.contains("say it by the key `frame`"), "{message}");
        let single = "NRRD0004\ntype: float\ndimension: 3\nsizes: 1 1 1\nspacings: 1 1 1\n\
                      endian: little\nencoding: raw\n\n1234";
        let message = refused("v.nrrd", single.as_bytes(), None);
        assert!(message.contains("the first of them 3"), "{message}");
        let mut single = written("u.nii", 1.0);
        single[50..52].copy_from_slice(&1i16.to_le_bytes());
        let message = refused("u.nii", &single, Some(VectorFrame::Ras));
        assert!(message.contains("the components of a vector"), "{message}");
    }
}
