use super::files::{LABELS, SMALL, nrrd_text, read_as, read_noted};
use super::nifti_files::nifti_bytes;
use crate::files::read_label_map;
use mtled::algebra::tensor::{Matrix3, Vector3};

#[test]
fn an_image_that_does_not_say_where_it_lies_is_pointed_out() {
    let codes = |qform: i16, sform: i16, x: f32| {
        let bytes = nifti_bytes(false, |put| {
            put(252, &qform.to_le_bytes());
            put(254, &sform.to_le_bytes());
            // The sform has steps of 1, 2, 3 mm from x; the qform begins at 0.
            for (at, value) in [(280, 1.0f32), (292, x), (300, 2.0), (320, 3.0)] {
                put(at, &value.to_le_bytes());
            }
        });
        read_noted("a.nii", &bytes).notes
    };
    assert!(codes(0, 0, 0.0)[0].contains("neither `sform_code` nor `qform_code`"));
    assert!(codes(1, 1, 0.2)[0].contains("sform and qform disagree, by 0.2000"));
    let none: Vec<Vec<String>> =
        [codes(1, 1, 0.05), codes(1, 0, 9.0), codes(0, 1, 9.0)].into_iter().collect();
    assert!(none.iter().all(Vec::is_empty), "{none:?}");
    let nrrd = read_noted("a.nrrd", &nrrd_text(&format!("{SMALL}encoding: raw\n"), &LABELS));
    assert!(nrrd.notes[0].contains("no `space`"), "{:?}", nrrd.notes);
}

#[test]
fn a_pair_of_header_and_image_is_read_by_either_name() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = nifti_bytes(true, |put| {
        put(344, b"ni1\0");
        put(108, &0.0f32.to_be_bytes());
    });
    std::fs::write(folder.path().join("a.hdr"), &bytes[..348]).unwrap();
    std::fs::write(folder.path().join("a.img"), &bytes[352..]).unwrap();
    for name in ["a.hdr", "a.img"] {
        let read = read_label_map(&folder.path().join(name), None, None).unwrap();
        assert_eq!(read.map.labels, LABELS.map(u32::from));
        assert!(read.files[0].ends_with(name) && read.files.len() == 2, "{:?}", read.files);
    }
    std::fs::remove_file(folder.path().join("a.img")).unwrap();
    let error = read_label_map(&folder.path().join("a.hdr"), None, None).unwrap_err().to_string();
    assert!(error.contains("a.img"), "{error}");
}

/// The same file in NIfTI-2, its steps turned by a sform.
fn nifti2_bytes(big: bool) -> Vec<u8> {
    let mut bytes = vec![0u8; 544];
    let turned = |mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        bytes
    };
    let mut put = |at: usize, data: Vec<u8>| {
        bytes[at..at + data.len()].copy_from_slice(&turned(data));
    };
    put(0, 540i32.to_le_bytes().to_vec());
    put(12, 4i16.to_le_bytes().to_vec());
    for (n, size) in [3i64, 2, 2, 2, 1, 1, 1, 1].into_iter().enumerate() {
        put(16 + 8 * n, size.to_le_bytes().to_vec());
    }
    put(168, 544i64.to_le_bytes().to_vec());
    put(348, 1i32.to_le_bytes().to_vec());
    for (at, value) in [(408, -2.0f64), (424, 7.0), (432, 1.0), (480, 3.0)] {
        put(at, value.to_le_bytes().to_vec());
    }
    put(500, 2i32.to_le_bytes().to_vec());
    bytes[4..12].copy_from_slice(b"n+2\0\r\n\x1a\n");
    let word = |label: u8| turned(i16::from(label).to_le_bytes().to_vec());
    bytes.extend(LABELS.iter().flat_map(|&label| word(label)));
    bytes
}

#[test]
fn nifti_2_is_read_in_both_byte_orders() {
    for big in [false, true] {
        let bytes = nifti2_bytes(big);
        let map = read_as("a.nii", &bytes).unwrap();
        assert_eq!(map.labels, LABELS.map(u32::from));
        let expected = Matrix3::new(0.0, -2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 3.0) * 1e-3;
        assert!((map.directions - expected).norm() < 1e-9, "{}", map.directions);
        assert!((map.origin.x - 0.007).abs() < 1e-12);
        for end in [3, 100, 400, 539, 550] {
            assert!(read_as("a.nii", &bytes[..end]).is_err(), "{end}");
        }
    }
}

#[test]
fn the_labels_of_a_sheared_image_keep_their_place_and_volume() {
    // A bar of 20 x 4 x 4 voxels whose second index leans by a tenth.
    let mut labels = Vec::new();
    for n in 0..30 * 20 * 10 {
        let [i, j, k] = [n % 30, n / 30 % 20, n / 600];
        labels.push(u8::from((5..25).contains(&i) && (8..12).contains(&j) && (3..7).contains(&k)));
    }
    let header = "type: uint8\ndimension: 3\nspace: RAS\nsizes: 30 20 10\nencoding: raw\n\
                  space directions: (1,0,0) (0.1,1,0) (0,0,1)\nspace origin: (3,4,5)\n";
    let read = read_noted("a.nrrd", &nrrd_text(header, &labels));
    assert!(read.notes[0].contains("not perpendicular"), "{:?}", read.notes);
    let map = read.map;
    let own: Vec<usize> = (0..map.labels.len()).filter(|&n| map.labels[n] == 1).collect();
    let [nx, ny, _] = map.size;
    let centre = |n: &usize| map.centre(n % nx, n / nx % ny, n / (nx * ny));
    let mean: Vector3 = own.iter().map(centre).sum::<Vector3>() / own.len() as f64;
    // The middle of the bar has the index (14.5, 9.5, 4.5).
    let right = Vector3::new(3.0 + 14.5 + 0.95, 4.0 + 9.5, 5.0 + 4.5) * 1e-3;
    // Voxels of 1 mm are taken whole.
    assert!((mean - right).norm() < 0.25e-3, "{mean} {right}");
    let volume = own.len() as f64 * map.directions.determinant().abs() * 1e9;
    assert!((volume / 320.0 - 1.0).abs() < 0.05, "{volume}");
}
