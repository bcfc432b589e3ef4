mod files;
mod layers;
mod nifti_files;
mod places;

use super::{LengthUnit, Mistake, nifti, nrrd, read_label_map};
use files::{LABELS, SMALL, gzip, nrrd_text, read_as, read_noted};
use flate2::{Compression, write::GzEncoder};
use mtled::algebra::tensor::{Matrix3, Vector3};
use nifti_files::nifti_bytes;
use std::io::Write;
use std::path::{Path, PathBuf};

fn brain(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../reference/brain").join(name)
}

#[test]
fn the_brain_slice_is_the_same_in_nrrd_and_nifti() {
    let first = nrrd::read(&brain("slice.nrrd"), None, None).unwrap().map;
    let second = nifti::read(&brain("slice.nii.gz"), None).unwrap().map;
    assert_eq!(first.size, [157, 190, 5]);
    assert_eq!(first.size, second.size);
    assert!(first.labels == second.labels);
    assert!((first.origin - Vector3::new(-0.078, -0.111, 0.016)).norm() < 1e-12);
    assert!((first.origin - second.origin).norm() < 1e-9);
    assert!((first.directions - Matrix3::from_diagonal_element(0.001)).norm() < 1e-12);
    assert!((first.directions - second.directions).norm() < 1e-9);
}

#[test]
fn the_areas_of_the_brain_slice_are_those_of_its_description() {
    let map = nrrd::read(&brain("slice.nrrd"), None, None).unwrap().map;
    let area = |label: u32| map.labels.iter().filter(|&&l| l == label).count();
    assert_eq!([area(1), area(2), area(3)], [5 * 17990, 5 * 1001, 5 * 376]);
}

#[test]
fn raw_gzip_and_text_hold_the_same_labels() {
    let raw = nrrd_text(&format!("{SMALL}encoding: raw\n"), &LABELS);
    let text = nrrd_text(&format!("{SMALL}encoding: ascii\n"), b"0 1 2 3\n4 5 6 7\n");
    let zipped = nrrd_text(&format!("{SMALL}encoding: gzip\n"), &gzip(&LABELS));
    for bytes in [raw, text, zipped] {
        let map = read_as("a.nrrd", &bytes).unwrap();
        assert_eq!(map.labels, LABELS.map(u32::from));
        let steps = Vector3::new(0.001, 0.002, 0.003);
        assert!((map.directions - Matrix3::from_diagonal(&steps)).norm() < 1e-15);
    }
}

#[test]
fn both_byte_orders_and_all_types_are_read() {
    for (kind, size) in [("int16", 2), ("uint32", 4), ("int64", 8)] {
        for endian in ["little", "big"] {
            let header = format!("{SMALL}encoding: raw\nendian: {endian}\n").replace("uint8", kind);
            let bytes = LABELS.map(|label| {
                let word = u64::from(label).to_le_bytes()[..size].to_vec();
                if endian == "big" { word.into_iter().rev().collect() } else { word }
            });
            let map = read_as("a.nrrd", &nrrd_text(&header, &bytes.concat())).unwrap();
            assert_eq!(map.labels, LABELS.map(u32::from), "{kind} {endian}");
        }
    }
}

#[test]
fn a_rotated_las_image_in_metres_turns_into_ras() {
    let header = "# comment\r\ntype: uint8\r\ndimension: 3\r\nspace: LAS\r\nsizes: 2 2 2\r\n\
                  space directions: (0, 0.5, 0) (-0.5,0,0) (0,0,2)\r\nspace origin: (1,2,3)\r\n\
                  space units: \"m\" \"m\" \"m\"\r\nkey:=value: with colon\r\nencoding: raw\r\n\r\n";
    let map = read_as("a.nrrd", &[b"NRRD0005\r\n", header.as_bytes(), &LABELS].concat()).unwrap();
    assert_eq!(map.origin, Vector3::new(-1.0, 2.0, 3.0));
    let expected = Matrix3::new(0.0, 0.5, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 2.0);
    assert_eq!(map.directions, expected);
}

#[test]
fn a_detached_data_file_is_found_beside_its_header() {
    let folder = tempfile::tempdir().unwrap();
    let header = format!("NRRD0004\n{SMALL}encoding: raw\nbyte skip: -1\ndata file: voxels.raw\n");
    std::fs::write(folder.path().join("a.nhdr"), header).unwrap();
    std::fs::write(folder.path().join("voxels.raw"), [&[9, 9][..], &LABELS].concat()).unwrap();
    let read =
        read_label_map(&folder.path().join("a.nhdr"), Some(LengthUnit::Metre), None).unwrap();
    assert_eq!(read.map.labels, LABELS.map(u32::from));
    assert_eq!(read.map.directions[(2, 2)], 3.0);
    assert_eq!(read.files.len(), 2);
}

#[test]
fn damaged_nrrd_files_are_refused_with_a_reason() {
    let raw = format!("{SMALL}encoding: raw\n");
    let cases: [(Vec<u8>, &str); 17] = [
        (b"hello".to_vec(), "this is not an NRRD file"),
        (nrrd_text(&raw, &LABELS[..5]), "states 8 bytes of data, there are 5"),
        (nrrd_text(&raw.replace("uint8", "int16"), &LABELS), "header has no `endian`"),
        (nrrd_text(&raw.replace("sizes: 2 2 2\n", ""), &LABELS), "header has no `sizes`"),
        (nrrd_text(&raw.replace("spacings: 1 2 3\n", ""), &LABELS), "no `space directions`"),
        (nrrd_text(&raw.replace("sizes: 2 2 2", "sizes: 2 2 x"), &LABELS), "three whole numbers"),
        (nrrd_text(&raw.replace("dimension: 3", "dimension: 4"), &LABELS), "`dimension` is `4`"),
        (nrrd_text(&raw.replace("raw", "bzip2"), &LABELS), "`encoding` is `bzip2`"),
        (nrrd_text(&raw.replace("spacings: 1", "spacings: 0"), &LABELS), "`spacings` is `0 2 3`"),
        (nrrd_text(&raw.replace("2 2 2", "99999999 99999999 99999999"), &LABELS), "sizes"),
        (nrrd_text(&format!("{raw}nonsense\n"), &LABELS), "`nonsense`; expected `field: value`"),
        (
            nrrd_text(&raw.replace("raw", "gzip"), b"this is plainly no gzip stream"),
            "gzip data cannot be decoded",
        ),
        (nrrd_text(&raw, &[&LABELS[..], &[8]].concat()), "more data than the 8 bytes"),
        (nrrd_text(&raw.replace("raw", "ascii"), b"0 1 2 3 4 5 6 7 8"), "more data than the 8"),
        (nrrd_text(&raw.replace("raw", "gzip"), &gzip(&[0; 99])), "more data than the 8 bytes"),
        (
            nrrd_text(
                &raw.replace("spacings: 1 2 3", "space directions: (1,0,0) (0,1,0) (1,1,0)"),
                &LABELS,
            ),
            "`space directions` is `(1,0,0) (0,1,0) (1,1,0)`",
        ),
        (nrrd_text(&raw.replace("2 2 2", "32768 32768 1"), &LABELS), "states 1073741824 bytes"),
    ];
    for (bytes, reason) in cases {
        let message = read_as("a.nrrd", &bytes).unwrap_err().to_string();
        assert!(message.contains(reason), "{message} does not say {reason}");
    }
}

#[test]
fn a_line_end_behind_the_data_is_no_mistake() {
    for encoding in ["raw", "gzip"] {
        let data = if encoding == "gzip" { gzip(&LABELS) } else { LABELS.to_vec() };
        let header = format!("{SMALL}encoding: {encoding}\n");
        assert!(read_as("a.nrrd", &nrrd_text(&header, &[&data[..], b"\r\n"].concat())).is_ok());
    }
}

#[test]
fn compressed_labels_of_the_wrong_check_sum_are_refused() {
    let mut data = gzip(&LABELS);
    let sum = data.len() - 8;
    data[sum] ^= 1;
    let error = read_as("a.nrrd", &nrrd_text(&format!("{SMALL}encoding: gzip\n"), &data));
    assert!(error.unwrap_err().to_string().contains("checksum"));
}

#[test]
fn no_more_is_decompressed_than_the_header_states() {
    // A gigabyte of zeros in a megabyte.
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(&nifti_bytes(false, |_| {})).unwrap();
    (0..256).for_each(|_| encoder.write_all(&[0; 1 << 22]).unwrap());
    let bomb = encoder.finish().unwrap();
    let mut read = 0;
    let counted = Counted { bytes: &bomb, read: &mut read };
    assert_eq!(
        nifti::parse_voxels(flate2::read::MultiGzDecoder::new(counted), nifti::Content::Numbers)
            .unwrap()
            .size,
        [2; 3]
    );
    assert!(read < bomb.len() / 2, "{read} bytes of {}", bomb.len());
}

/// Bytes, and how many of them were read.
struct Counted<'a> {
    bytes: &'a [u8],
    read: &'a mut usize,
}

impl std::io::Read for Counted<'_> {
    fn read(&mut self, to: &mut [u8]) -> std::io::Result<usize> {
        let count = self.bytes.read(to)?;
        *self.read += count;
        Ok(count)
    }
}

#[test]
fn a_data_file_without_an_end_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let header = folder.path().join("a.nhdr");
    for data in ["/dev/zero", "."] {
        let text = format!("NRRD0004\n{SMALL}encoding: raw\ndata file: {data}\n");
        std::fs::write(&header, text).unwrap();
        let error = read_label_map(&header, None, None).unwrap_err().to_string();
        assert!(error.contains("a folder, a device or a pipe"), "{error}");
    }
}

#[test]
fn a_header_without_an_end_is_refused() {
    let header = format!("{SMALL}{}", "# nothing\n".repeat(200_000));
    let error = read_as("a.nrrd", &nrrd_text(&header, &LABELS)).unwrap_err();
    assert!(matches!(error, Mistake::LongHeader { .. }), "{error}");
}

#[test]
fn fractions_are_no_labels() {
    let header = format!("{SMALL}encoding: ascii\n").replace("uint8", "float");
    for text in ["0 1 2 3 4 5 6 7.5", "0 1 2 3 4 5 6 -7.5", "0 1 2 3 4 5 6 5e9"] {
        let error = read_as("a.nrrd", &nrrd_text(&header, text.as_bytes())).unwrap_err();
        let is_seven = matches!(
            error,
            Mistake::NotALabel { voxel: 7, .. } | Mistake::LabelTooLarge { voxel: 7, .. }
        );
        assert!(is_seven, "{error}");
    }
    assert!(read_as("a.nrrd", &nrrd_text(&header, b"0 1 2 3 4 5 6 7.0")).is_ok());
}

#[test]
fn negative_numbers_and_nan_are_outside_and_counted() {
    let header = format!("{SMALL}encoding: ascii\n").replace("uint8", "float");
    let read = read_noted("a.nrrd", &nrrd_text(&header, b"-1 1 2 -7 4 5 6 nan"));
    assert_eq!(read.map.labels, [0, 1, 2, 0, 4, 5, 6, 0]);
    assert!(read.notes.iter().any(|note| note.starts_with("3 of 8 voxels")), "{:?}", read.notes);
}

#[test]
fn large_labels_are_read_and_multiples_of_256_are_pointed_out() {
    let header = format!("{SMALL}encoding: raw\nendian: little\n").replace("uint8", "uint32");
    let bytes = |labels: [u32; 8]| nrrd_text(&header, &labels.map(u32::to_le_bytes).concat());
    let allen = [0, 997, 614_454_277, 0, 0, 0, 0, u32::MAX];
    let read = read_noted("a.nrrd", &bytes(allen));
    assert_eq!(read.map.labels, allen);
    let doubts = |notes: &[String]| notes.iter().any(|note| note.contains("multiple of 256"));
    assert!(!doubts(&read.notes), "{:?}", read.notes);
    let swapped = read_noted("a.nrrd", &bytes([0, 256, 512, 0, 0, 0, 0, 65_536]));
    assert!(doubts(&swapped.notes), "{:?}", swapped.notes);
}

#[test]
fn a_file_of_another_kind_is_refused_by_its_name() {
    let error = read_as("a.mha", b"").unwrap_err();
    assert!(matches!(error, Mistake::UnknownImage { .. }));
}

#[test]
fn a_label_map_cut_short_anywhere_is_refused() {
    let raw = nrrd_text(&format!("{SMALL}encoding: raw\n"), &LABELS);
    let zipped = nrrd_text(&format!("{SMALL}encoding: gzip\n"), &gzip(&[3; 8]));
    for (name, bytes, needed) in [
        ("a.nrrd", raw.clone(), raw.len()),
        // The check sum at the end of the stream is not needed.
        ("a.nrrd", zipped.clone(), zipped.len() - 10),
        ("a.nii", nifti_bytes(true, |_| {}), 368),
    ] {
        for end in 0..needed {
            assert!(read_as(name, &bytes[..end]).is_err(), "{name} of {end} bytes");
        }
    }
}
