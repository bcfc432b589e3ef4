//! `mtled warp` from its arguments to its files.

use super::arguments::WarpArgs;
use super::outputs::{Outputs, write_all};
use super::summary::Summary;
use crate::cli::common::Common;
use anyhow::{Context, Result};
use mtled::problem::Problem;
use mtled_case::scene::Case;
use mtled_checks::escape::file_name;
use mtled_io::files::LengthUnit;
use mtled_io::files::image::{Image, Interpolation, field_bytes, image_bytes, read_image};
use mtled_io::files::points::read_landmarks;
use mtled_io::files::surface::to_stl;
use mtled_run::run::{StoredField, load};
use mtled_run::warp::{
    DisplacementField, RegionSurface, WarpError, deform, forward_field, move_landmarks,
    nodes_outside, region_surfaces, to_csv,
};
use std::path::{Path, PathBuf};

pub(crate) fn warp(arguments: &WarpArgs, common: &Common) -> Result<u8> {
    let outputs = Outputs::of(arguments)?;
    let stored = StoredField::read(&arguments.result)?;
    let case = solved_case(arguments, &stored)?;
    stored.check(&arguments.result, &case)?;
    if stored.stopped {
        common.warn("the run was stopped before its end: this is the deformation up to then");
    }
    let image = arguments.image.as_deref().map(|path| {
        read_image(path, arguments.image_unit.map(LengthUnit::from)).map(|image| (path, image))
    });
    let image = image.transpose()?;
    let landmarks = arguments
        .points
        .as_deref()
        .map(|path| read_landmarks(path, arguments.unit.map(LengthUnit::from)));
    let landmarks = landmarks.transpose()?;
    let decay = arguments.decay.map(|millimetres| 1e-3 * millimetres);
    let field = DisplacementField::new(&stored, &case.problem, decay)?;
    if let Some((path, image)) = &image {
        image.notes.iter().for_each(|note| common.warn_about(path, note));
        refuse_other_space(path, image, &field, common)?;
    }
    outputs.ensure_writable()?;

    let mut summary = Summary::of(&field);
    let mut files = Vec::new();
    if let Some((_, image)) = &image {
        files.extend(warped_image(arguments, &outputs, image, &field, &mut summary)?);
    }
    if let (Some(landmarks), Some(path)) = (&landmarks, &outputs.landmarks) {
        summary.landmarks = move_landmarks(&field, landmarks);
        files.push((path.clone(), to_csv(&summary.landmarks)?.into_bytes()));
    }
    if let Some(folder) = &outputs.surfaces {
        files.extend(surfaces(&case.problem, &field, folder, common)?);
    }
    write_all(&files)?;
    summary.files = files.into_iter().map(|(path, _)| path).collect();
    summary.warn(common);
    common.print_summary(&|| summary.json(), &|| summary.text())?;
    Ok(0)
}

/// The surfaces of the body and of its regions before and after, as bytes of files.
fn surfaces(
    problem: &Problem,
    field: &DisplacementField,
    folder: &Path,
    common: &Common,
) -> Result<Vec<(PathBuf, Vec<u8>)>> {
    let (surfaces, left_out) = region_surfaces(problem, field)?;
    for region in left_out {
        common.warn(format!(
            "region \"{region}\" has no surface of its own: its selection is no solid"
        ));
    }
    let files = |surface: &RegionSurface| {
        let name = file_name(&surface.name);
        [
            (folder.join(format!("{name}.stl")), to_stl(&surface.before)),
            (folder.join(format!("{name}_deformed.stl")), to_stl(&surface.after)),
        ]
    };
    Ok(surfaces.iter().flat_map(files).collect())
}

/// The case that was solved.
fn solved_case(arguments: &WarpArgs, stored: &StoredField) -> Result<Case> {
    match &arguments.case {
        Some(file) => load(file, &stored.case.overrides),
        None => load(&stored.case.file, &stored.case.overrides).with_context(|| {
            format!(
                "{} was solved; where it has been moved, name it with --case",
                stored.case.file.display()
            )
        }),
    }
}

fn refuse_other_space(
    path: &Path,
    image: &Image,
    field: &DisplacementField,
    common: &Common,
) -> Result<(), WarpError> {
    let outside = nodes_outside(field, &image.grid, path)?;
    if outside > 0 {
        let all = field.nodes().len();
        common.warn_about(
            path,
            format!("{outside} of {all} nodes of the body lie outside of this image"),
        );
    }
    Ok(())
}

/// The deformed image and the fields that are asked for, as bytes of files.
fn warped_image(
    arguments: &WarpArgs,
    outputs: &Outputs,
    image: &Image,
    field: &DisplacementField,
    summary: &mut Summary,
) -> Result<Vec<(PathBuf, Vec<u8>)>> {
    let how = if arguments.labels { Interpolation::Nearest } else { Interpolation::Linear };
    let deformed = deform(field, image, how);
    let mut files = Vec::new();
    if let Some((path, format)) = &outputs.image {
        files.push((path.clone(), image_bytes(image, &deformed.voxels, *format, path)?));
    }
    if let Some((path, format)) = &outputs.field {
        let vectors = forward_field(field, &image.grid);
        files.push((path.clone(), field_bytes(&image.grid, &vectors, *format, path)?));
    }
    if let Some((path, format)) = &outputs.inverse_field {
        files.push((path.clone(), field_bytes(&image.grid, &deformed.sources, *format, path)?));
    }
    summary.deformed = Some(deformed.into());
    Ok(files)
}
