//! Images and landmarks moved by a known field.
#![allow(non_snake_case)]

use super::image::{Kind, Place, SIZE, around, nifti, voxels};
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled_case::scene::parse_case;
use mtled_io::files::image::{
    Image, ImageFormat, Interpolation, field_bytes, image_bytes, read_image,
};
use mtled_run::run::StoredField;
use mtled_run::warp::{
    DisplacementField, TOLERANCE, deform, forward_field, nodes_outside, source_of,
};
use std::path::Path;

const BLOCK: &str = concat!(
    "\n",
    include_str!("../common/pulled_block.toml"),
    "[time]\nmethod = \"static\"\nload_end = 1.0\n"
);

/// Middle of the block of 100 mm \[m\].
const MIDDLE: Vector3 = Vector3::new(0.05, 0.05, 0.05);

/// The block with this displacement \[m\] at its nodes.
fn field(u: impl Fn(&Vector3) -> Vector3, decay: Option<f64>) -> DisplacementField {
    let case = parse_case(BLOCK, "block.toml", Path::new(".")).unwrap();
    let simulation = Simulation::with_any_recipe(&case.problem).unwrap();
    let nodes = &simulation.discretisation.cloud.positions;
    let parameters: Vec<f64> = nodes.iter().flat_map(|X| <[f64; 3]>::from(u(X))).collect();
    let stored = StoredField::new(&case, &simulation, &parameters, false);
    DisplacementField::new(&stored, &case.problem, decay).unwrap()
}

fn rotation() -> Matrix3 {
    let axis = nalgebra::Unit::new_normalize(Vector3::new(-2.0, 1.0, 0.5));
    *nalgebra::Rotation3::from_axis_angle(&axis, 0.2).matrix()
}

fn rotated() -> DisplacementField {
    field(|X| (rotation() - Matrix3::identity()) * (X - MIDDLE), None)
}

fn read(bytes: &[u8], name: &str) -> Image {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_image(&path, None).unwrap()
}

/// Centre of a voxel, RAS \[mm\].
fn centre(place: &Place, [i, j, k]: [usize; 3]) -> Vector3 {
    place.origin + place.directions * Vector3::new(i as f64, j as f64, k as f64)
}

/// The vectors of a NIfTI displacement field, RAS \[mm\].
fn vectors(bytes: &[u8]) -> Vec<Vector3> {
    let short = |at: usize| i16::from_le_bytes(bytes[at..at + 2].try_into().unwrap());
    let sizes: Vec<i16> = (0..6).map(|n| short(40 + 2 * n)).collect();
    assert_eq!(sizes, [5, SIZE[0] as i16, SIZE[1] as i16, SIZE[2] as i16, 1, 3]);
    assert_eq!((short(68), short(70)), (1007, 16), "intent and type");
    let real = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let (count, start) = (SIZE.iter().product::<usize>(), real(108) as usize);
    let component = |c: usize, n: usize| f64::from(real(start + 4 * (c * count + n)));
    let ras = |n: usize| Vector3::new(-component(0, n), -component(1, n), component(2, n));
    (0..count).map(ras).collect()
}

fn noise([i, j, k]: [usize; 3]) -> f64 {
    ((i * 7919 + j * 104_729 + k * 1_299_709) % 2003) as f64 - 1000.0
}

/// The file of the image deformed by a field.
fn deformed_file(field: &DisplacementField, bytes: &[u8], how: Interpolation) -> Vec<u8> {
    let image = read(bytes, "image.nii");
    let deformed = deform(field, &image, how);
    assert_eq!((deformed.unconverged, deformed.sources.len()), (0, image.grid.count()));
    image_bytes(&image, &deformed.voxels, ImageFormat::Nifti, Path::new("image.nii")).unwrap()
}

#[test]
fn without_displacement_the_file_is_the_same_to_the_last_bit() {
    let field = field(|_| Vector3::zeros(), None);
    let place = around(1e3 * MIDDLE);
    for kind in [Kind::I16, Kind::F32] {
        let bytes = nifti(&place, kind, noise);
        for how in [Interpolation::Linear, Interpolation::Nearest] {
            assert!(deformed_file(&field, &bytes, how) == bytes);
        }
    }
    let image = read(&nifti(&place, Kind::I16, noise), "image.nii");
    assert!(forward_field(&field, &image.grid).iter().flatten().all(|c| *c == 0.0));
}

#[test]
fn a_shift_by_one_voxel_along_the_flipped_axis_moves_every_value_by_one_voxel() {
    let place = around(1e3 * MIDDLE);
    let step = place.directions.column(1) * 1e-3;
    let field = field(|_| step, None);
    let bytes = nifti(&place, Kind::I16, noise);
    let expected = nifti(&place, Kind::I16, |[i, j, k]| match j {
        0 => 0.0,
        _ => noise([i, j - 1, k]),
    });
    for how in [Interpolation::Linear, Interpolation::Nearest] {
        assert!(deformed_file(&field, &bytes, how) == expected);
    }
    let image = read(&bytes, "image.nii");
    let u = forward_field(&field, &image.grid);
    let file = field_bytes(&image.grid, &u, ImageFormat::Nifti, Path::new("u.nii")).unwrap();
    let worst = vectors(&file).iter().map(|u| (u - 1e3 * step).norm()).fold(0.0, f64::max);
    assert!(worst < 1e-6, "{worst} mm");
    assert_eq!(deform(&field, &image, Interpolation::Linear).from_outside, SIZE[0] * SIZE[2]);
}

#[test]
fn a_rotation_is_recovered_in_the_field_its_inverse_and_the_image() {
    let (field, place) = (rotated(), around(1e3 * MIDDLE));
    let value = |index: Vector3| 3.0 + index.dot(&Vector3::new(1.5, -2.0, 0.7));
    let of_voxel = |[i, j, k]: [usize; 3]| value(Vector3::new(i as f64, j as f64, k as f64));
    let image = read(&nifti(&place, Kind::F32, of_voxel), "image.nii");
    let deformed = deform(&field, &image, Interpolation::Linear);
    let forward = forward_field(&field, &image.grid);
    let file = |v: &[[f32; 3]]| {
        vectors(&field_bytes(&image.grid, v, ImageFormat::Nifti, Path::new("u.nii")).unwrap())
    };
    let (forward, sources) = (file(&forward), file(&deformed.sources));
    let to_index = place.directions.try_inverse().unwrap();
    let (mut compared, last) = (0, SIZE.map(|n| (n - 1) as f64));
    for (n, voxel) in voxels().enumerate() {
        let x = centre(&place, voxel) - 1e3 * MIDDLE;
        let u = (rotation() - Matrix3::identity()) * x;
        assert!((forward[n] - u).norm() < 1e-6, "{voxel:?}: {} mm", forward[n] - u);
        let back = (rotation().transpose() - Matrix3::identity()) * x;
        assert!((sources[n] - back).norm() < 2e3 * TOLERANCE, "{voxel:?}");
        let index = to_index * (centre(&place, voxel) + back - place.origin);
        if (0..3).all(|axis| (0.0..=last[axis]).contains(&index[axis])) {
            let got = f32::from_le_bytes(deformed.voxels[4 * n..4 * n + 4].try_into().unwrap());
            assert!((f64::from(got) - value(index)).abs() < 1e-3, "{voxel:?}: {got}");
            compared += 1;
        }
    }
    assert!(compared > 2000, "{compared}");
}

#[test]
fn forward_after_inverse_is_the_identity_to_the_tolerance_inside_and_outside_of_the_body() {
    let bent = |X: &Vector3| {
        let d = X - MIDDLE;
        Vector3::new(0.02 * (40.0 * d.y).sin(), 2.0 * d.x * d.x, 0.01 * (30.0 * d.x).cos())
    };
    let field = field(bent, None);
    let place = around(Vector3::new(95.0, 50.0, 60.0));
    let mut outside = 0;
    for voxel in voxels() {
        let x = 1e-3 * centre(&place, voxel);
        let source = source_of(&field, &x, &Vector3::zeros(), Matrix3::identity());
        let X = x + source.vector;
        let left = (X + field.at(&X) - x).norm();
        assert!(left <= TOLERANCE && source.residual <= TOLERANCE, "{voxel:?}: {left} m");
        outside += usize::from(field.distance_outside(&X) > 0.0);
    }
    assert!((200..2488).contains(&outside), "{outside}");
}

#[test]
fn outside_of_the_body_the_displacement_goes_on_and_decays_to_zero() {
    let shift = Vector3::new(0.004, -0.002, 0.001);
    let field = field(|_| shift, Some(0.01));
    let beside = |distance: f64| field.at(&Vector3::new(0.1 + distance, 0.05, 0.03));
    assert!((beside(0.0) - shift).norm() < 1e-12 && (beside(1e-7) - shift).norm() < 1e-8);
    assert!((beside(0.005) - 0.5 * shift).norm() < 1e-9);
    let sizes: Vec<f64> = (0..=110).map(|n| beside(1e-4 * f64::from(n)).norm()).collect();
    assert!(sizes.is_sorted_by(|a, b| a >= b) && sizes[100..].iter().all(|u| *u == 0.0));
    let ending = self::field(|_| shift, Some(0.0));
    assert!((ending.at(&MIDDLE) - shift).norm() < 1e-12);
    assert_eq!(ending.at(&Vector3::new(0.1001, 0.05, 0.05)), Vector3::zeros());
}

#[test]
fn where_the_field_ends_at_the_boundary_what_moved_out_of_the_body_is_seen() {
    // The block moves by 20 mm along x, past its old face at x = 100 mm.
    let field = field(|_| Vector3::new(0.02, 0.0, 0.0), Some(0.0));
    for (x, source) in [(0.11, 0.09), (0.119, 0.099), (0.05, 0.03), (0.13, 0.13)] {
        let place = Vector3::new(x, 0.05, 0.05);
        let found = source_of(&field, &place, &Vector3::zeros(), Matrix3::identity());
        assert!(found.residual <= TOLERANCE, "{x}: {}", found.residual);
        assert!((found.vector.x - (source - x)).abs() < 1e-6, "{x}: {}", found.vector.x);
    }
}

#[test]
fn an_image_has_the_same_voxels_in_the_same_places_in_nifti_and_nrrd() {
    let first = read(&nifti(&around(1e3 * MIDDLE), Kind::I16, noise), "image.nii");
    let to = |image: &Image, format, name| {
        read(&image_bytes(image, &image.stored, format, Path::new(name)).unwrap(), name)
    };
    let second = to(&first, ImageFormat::Nrrd, "image.nrrd");
    let third = to(&second, ImageFormat::NiftiGz, "image.nii.gz");
    for other in [&second, &third] {
        assert!(first.stored == other.stored && first.scalar == other.scalar);
        assert_eq!(first.grid.size, other.grid.size);
        assert!((first.grid.origin - other.grid.origin).norm() < 1e-8);
        assert!((first.grid.directions - other.grid.directions).norm() < 1e-9);
    }
}

#[test]
fn the_lines_of_an_nrrd_header_are_kept() {
    let header = "NRRD0005\n# made up\ntype: short\ndimension: 3\nspace: RAS\nsizes: 2 1 1\n\
                  space directions: (1,0,0) (0,2,0) (0,0,3)\nkinds: domain domain domain\n\
                  endian: big\nencoding: raw\nspace origin: (1,2,3)\npatient:=nobody\n";
    let bytes = [header.as_bytes(), b"\n", &[1, 2, 3, 4]].concat();
    let image = read(&bytes, "image.nrrd");
    let path = Path::new("image.nrrd");
    let written = image_bytes(&image, &image.stored, ImageFormat::Nrrd, path).unwrap();
    let end = written.windows(2).position(|pair| pair == b"\n\n").unwrap();
    let expected =
        header.replace("endian: big\nencoding: raw\n", "") + "endian: big\nencoding: gzip";
    assert_eq!(String::from_utf8_lossy(&written[..end]), expected);
    assert_eq!(read(&written, "again.nrrd").stored, [1, 2, 3, 4]);
}

#[test]
fn an_image_of_another_space_has_no_node_of_the_body() {
    let field = rotated();
    let outside = |middle: Vector3| {
        let image = read(&nifti(&around(middle), Kind::I16, noise), "i.nii");
        nodes_outside(&field, &image.grid, Path::new("i.nii"))
    };
    assert!(outside(1e3 * MIDDLE).is_ok());
    let refusal = outside(Vector3::new(-200.0, 50.0, 50.0)).unwrap_err().to_string();
    assert!(refusal.contains("i.nii"), "{refusal}");
}
