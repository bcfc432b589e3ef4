//! Where the voxels of a NIfTI image lie.

use crate::files::error::Mistake;
use crate::files::voxels::are_singular;
use mtled::algebra::tensor::{Matrix3, Vector3};
use nifti::NiftiHeader;

/// Places that sform and qform give may differ by this much \[voxel\].
const AGREE: f64 = 0.1;

/// Reasons to doubt where an image lies.
pub(crate) fn doubts(header: &NiftiHeader, size: [usize; 3]) -> Result<Vec<String>, Mistake> {
    if header.sform_code <= 0 && header.qform_code <= 0 {
        return Ok(vec![
            "neither `sform_code` nor `qform_code` is set, so that the file does not say where its \
             voxels lie: the first index is taken along R, the second along A, the third along S, \
             from (0, 0, 0); other programs mirror or centre such an image; set one of them"
                .to_string(),
        ]);
    }
    if header.sform_code <= 0 || header.qform_code <= 0 {
        return Ok(Vec::new());
    }
    let (origin, directions) = frame(header)?;
    let Ok((other, turned)) = frame(&NiftiHeader { sform_code: 0, ..header.clone() }) else {
        return Ok(vec![
            "`qform_code` is set, but the qform has no sense; the sform is taken".to_string(),
        ]);
    };
    let apart = |corner: usize| {
        let end = |axis: usize| (corner >> axis & 1) as f64 * (size[axis] as f64 - 1.0);
        let index = Vector3::from_fn(|axis, _| end(axis));
        (origin - other + (directions - turned) * index).norm()
    };
    let most = (0..8).map(apart).fold(0.0, f64::max);
    let voxel = directions.column_iter().map(|step| step.norm()).fold(f64::INFINITY, f64::min);
    if most <= AGREE * voxel {
        return Ok(Vec::new());
    }
    Ok(vec![format!(
        "sform and qform disagree, by {most:.4} of the file's units at one corner: the sform is \
         taken; programs that take the qform show the image elsewhere"
    )])
}

/// Refuses a field with a number that is not finite.
pub(crate) fn finite(field: &'static str, values: &[f32]) -> Result<(), Mistake> {
    if values.iter().all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err(Mistake::bad_field(field, &format!("{values:?}"), "finite numbers"))
    }
}

/// Centre of the first voxel and steps along the indices: sform, else qform,
/// else pixdim alone.
pub(crate) fn frame(header: &NiftiHeader) -> Result<(Vector3, Matrix3), Mistake> {
    let wide = |row: &[f32; 4]| row.map(f64::from);
    if header.sform_code > 0 {
        finite("srow_x", &header.srow_x)?;
        finite("srow_y", &header.srow_y)?;
        finite("srow_z", &header.srow_z)?;
        let rows = [wide(&header.srow_x), wide(&header.srow_y), wide(&header.srow_z)];
        let origin = Vector3::from_fn(|row, _| rows[row][3]);
        let directions = Matrix3::from_fn(|row, column| rows[row][column]);
        if are_singular(&directions) {
            let expected = "three rows whose directions span a volume";
            return Err(Mistake::bad_field(
                "srow_x, srow_y, srow_z",
                &format!("{rows:?}"),
                expected,
            ));
        }
        return Ok((origin, directions));
    }
    let step = header.pixdim.map(f64::from);
    if !step[1..4].iter().all(|step| *step > 0.0 && step.is_finite()) {
        let value = format!("{:?}", &step[1..4]);
        return Err(Mistake::bad_field("pixdim", &value, "three positive voxel sizes"));
    }
    if header.qform_code > 0 {
        finite("qoffset", &[header.quatern_x, header.quatern_y, header.quatern_z])?;
        finite("quatern", &[header.quatern_b, header.quatern_c, header.quatern_d])?;
        let hand = if step[0] < 0.0 { -1.0 } else { 1.0 };
        let scale = Matrix3::from_diagonal(&Vector3::new(step[1], step[2], hand * step[3]));
        let origin = [header.quatern_x, header.quatern_y, header.quatern_z].map(f64::from);
        return Ok((Vector3::from(origin), quaternion_rotation(header) * scale));
    }
    Ok((Vector3::zeros(), Matrix3::from_diagonal(&Vector3::new(step[1], step[2], step[3]))))
}

/// Rotation of the unit quaternion a + bi + cj + dk with a ≥ 0.
fn quaternion_rotation(header: &NiftiHeader) -> Matrix3 {
    let [b, c, d] = [header.quatern_b, header.quatern_c, header.quatern_d].map(f64::from);
    let a = (1.0 - b * b - c * c - d * d).max(0.0).sqrt();
    let quaternion = nalgebra::Quaternion::new(a, b, c, d);
    *nalgebra::UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix().matrix()
}
