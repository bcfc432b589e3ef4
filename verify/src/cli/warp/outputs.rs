//! Files that `mtled warp` writes.

use super::arguments::WarpArgs;
use anyhow::Result;
use mtled_checks::report::{ensure_writable, write_atomically};
use mtled_io::files::image::ImageFormat;
use mtled_io::files::{FileError, Mistake};
use mtled_run::warp::WarpError;
use std::path::{Path, PathBuf};

type ImageFile = (PathBuf, ImageFormat);

/// Where things are written, with formats that are known.
pub(crate) struct Outputs {
    pub image: Option<ImageFile>,
    pub field: Option<ImageFile>,
    pub inverse_field: Option<ImageFile>,
    pub landmarks: Option<PathBuf>,
    /// A folder.
    pub surfaces: Option<PathBuf>,
}

impl Outputs {
    /// Refuses unknown endings and files that are named twice.
    pub(crate) fn of(arguments: &WarpArgs) -> Result<Outputs> {
        let preset = |image: &Path| {
            let name = image.file_name().unwrap_or_default().to_string_lossy();
            let name = match name.strip_suffix(".nhdr") {
                Some(stem) => format!("{stem}.nrrd"),
                None => name.into_owned(),
            };
            arguments.result.join(format!("deformed_{name}"))
        };
        let image = arguments.image.as_deref();
        let image = image.map(|image| arguments.out.clone().unwrap_or_else(|| preset(image)));
        let landmarks = arguments.points.is_some().then(|| {
            arguments.points_out.clone().unwrap_or_else(|| arguments.result.join("landmarks.csv"))
        });
        if let Some(path) = landmarks.as_deref().filter(|path| !is_csv(path)) {
            return Err(Mistake::UnknownExtension { known: ".csv" }.of(path).into());
        }
        let outputs = Outputs {
            image: image.map(with_format).transpose()?,
            field: arguments.field.clone().map(with_format).transpose()?,
            inverse_field: arguments.inverse_field.clone().map(with_format).transpose()?,
            landmarks,
            surfaces: arguments.surfaces.clone(),
        };
        outputs.refuse_twice([&arguments.image, &arguments.points])?;
        Ok(outputs)
    }

    fn paths(&self) -> Vec<&PathBuf> {
        let images = [&self.image, &self.field, &self.inverse_field];
        let images = images.into_iter().flatten().map(|(path, _)| path);
        images.chain(&self.landmarks).collect()
    }

    fn refuse_twice(&self, inputs: [&Option<PathBuf>; 2]) -> Result<(), WarpError> {
        let mut seen: Vec<PathBuf> = inputs.into_iter().flatten().map(|path| place(path)).collect();
        for path in self.paths() {
            if seen.contains(&place(path)) {
                return Err(WarpError::NamedTwice { path: path.clone() });
            }
            seen.push(place(path));
        }
        Ok(())
    }

    /// Tries all folders before the work begins.
    pub(crate) fn ensure_writable(&self) -> Result<()> {
        let folders = self.paths().into_iter().map(|path| folder(path));
        folders.chain(self.surfaces.as_deref()).try_for_each(ensure_writable)
    }
}

fn with_format(path: PathBuf) -> Result<ImageFile, FileError> {
    ImageFormat::of_output(&path).map(|format| (path, format))
}

fn is_csv(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The one path of a file that may not be there yet.
fn place(path: &Path) -> PathBuf {
    let real = path.canonicalize().or_else(|_| {
        folder(path).canonicalize().map(|folder| folder.join(path.file_name().unwrap_or_default()))
    });
    real.unwrap_or_else(|_| path.to_path_buf())
}

/// Writes each file at once, when all are complete in memory.
pub(crate) fn write_all(files: &[(PathBuf, Vec<u8>)]) -> Result<()> {
    files.iter().try_for_each(|(path, bytes)| write_atomically(path, bytes))
}
