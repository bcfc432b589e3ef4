use super::files::{LABELS, gzip, read_as};
use crate::files::Mistake;
use mtled::algebra::tensor::{Matrix3, Vector3};

/// A NIfTI file of int16 voxels 0 to 7 in either byte order.
pub(super) fn nifti_bytes(big: bool, change: impl Fn(&mut dyn FnMut(usize, &[u8]))) -> Vec<u8> {
    let mut bytes = vec![0u8; 352];
    let word = |n: i16| if big { n.to_be_bytes() } else { n.to_le_bytes() };
    let float = |x: f32| if big { x.to_be_bytes() } else { x.to_le_bytes() };
    let mut put = |at: usize, data: &[u8]| bytes[at..at + data.len()].copy_from_slice(data);
    put(0, &if big { 348i32.to_be_bytes() } else { 348i32.to_le_bytes() });
    for (n, size) in [3, 2, 2, 2, 1, 1, 1, 1].into_iter().enumerate() {
        put(40 + 2 * n, &word(size));
    }
    put(70, &word(4));
    put(72, &word(16));
    for (n, step) in [1.0, 1.0, 2.0, 3.0].into_iter().enumerate() {
        put(76 + 4 * n, &float(step));
    }
    put(108, &float(352.0));
    put(344, b"n+1\0");
    change(&mut put);
    bytes.extend(LABELS.iter().flat_map(|&label| word(i16::from(label))));
    bytes
}

#[test]
fn nifti_is_read_in_both_byte_orders() {
    for big in [false, true] {
        let map = read_as("a.nii", &nifti_bytes(big, |_| {})).unwrap();
        assert_eq!(map.labels, LABELS.map(u32::from));
        assert!((map.directions[(2, 2)] - 0.003).abs() < 1e-12);
    }
}

#[test]
fn nifti_prefers_the_sform_to_the_qform_and_turns_the_qform() {
    // A quarter turn about z with the third axis flipped.
    let qform = |put: &mut dyn FnMut(usize, &[u8])| {
        put(76, &(-1.0f32).to_le_bytes());
        put(252, &1i16.to_le_bytes());
        put(264, &0.5f32.sqrt().to_le_bytes());
        put(268, &10.0f32.to_le_bytes());
    };
    let map = read_as("a.nii", &nifti_bytes(false, qform)).unwrap();
    let expected = Matrix3::new(0.0, -2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -3.0) * 1e-3;
    assert!((map.directions - expected).norm() < 1e-8);
    assert!((map.origin.x - 0.01).abs() < 1e-12);
    let both = |put: &mut dyn FnMut(usize, &[u8])| {
        qform(put);
        put(254, &1i16.to_le_bytes());
        for (at, value) in [(280, 4.0f32), (292, 7.0), (300, 5.0), (320, 6.0)] {
            put(at, &value.to_le_bytes());
        }
        put(123, &[1]);
    };
    let map = read_as("a.nii", &nifti_bytes(false, both)).unwrap();
    assert_eq!(map.directions, Matrix3::from_diagonal(&Vector3::new(4.0, 5.0, 6.0)));
    assert_eq!(map.origin.x, 7.0);
}

#[test]
fn damaged_nifti_files_are_refused_with_a_reason() {
    let good = nifti_bytes(false, |_| {});
    let cases: [(Vec<u8>, &str); 6] = [
        (good[..good.len() - 3].to_vec(), "states 16 bytes of data, there are 13"),
        (good[..100].to_vec(), "the header ends after 100 bytes"),
        (nifti_bytes(false, |put| put(344, b"abc\0")), "this is not a NIfTI file"),
        (nifti_bytes(false, |put| put(344, b"ni1\0")), "name the .hdr file of a pair"),
        (nifti_bytes(false, |put| put(40, &2i16.to_le_bytes())), "three axes"),
        (nifti_bytes(false, |put| put(70, &128i16.to_le_bytes())), "`datatype` is `128`"),
    ];
    for (bytes, reason) in cases {
        let message = read_as("a.nii", &bytes).unwrap_err().to_string();
        assert!(message.contains(reason), "{message} does not say {reason}");
    }
    let zipped = gzip(&good);
    let error = read_as("a.nii.gz", &zipped[..zipped.len() - 12]).unwrap_err();
    assert!(
        matches!(error, Mistake::Truncated { .. } | Mistake::TruncatedHeader { .. }),
        "{error}"
    );
}

#[test]
fn nifti_fields_without_a_meaning_are_named() {
    let nan = f32::NAN.to_le_bytes();
    let qform = |put: &mut dyn FnMut(usize, &[u8])| put(252, &1i16.to_le_bytes());
    let sform = |put: &mut dyn FnMut(usize, &[u8])| put(254, &1i16.to_le_bytes());
    let cases: [(Vec<u8>, &str); 9] = [
        (nifti_bytes(false, |put| put(108, &nan)), "vox_offset"),
        (nifti_bytes(false, |put| put(108, &(-352.0f32).to_le_bytes())), "vox_offset"),
        (nifti_bytes(false, |put| put(80, &nan)), "pixdim"),
        (nifti_bytes(false, |put| put(84, &0.0f32.to_le_bytes())), "pixdim"),
        (nifti_bytes(false, |put| put(88, &(-3.0f32).to_le_bytes())), "pixdim"),
        (
            nifti_bytes(false, |put| {
                qform(put);
                put(268, &f32::INFINITY.to_le_bytes());
            }),
            "qoffset",
        ),
        (
            nifti_bytes(false, |put| {
                qform(put);
                put(256, &nan);
            }),
            "quatern",
        ),
        (
            nifti_bytes(false, |put| {
                sform(put);
                put(284, &nan);
            }),
            "srow_x",
        ),
        (nifti_bytes(false, sform), "srow_x, srow_y, srow_z"),
    ];
    for (bytes, field) in cases {
        let message = read_as("a.nii", &bytes).unwrap_err().to_string();
        assert!(message.contains(&format!("header field `{field}` is")), "{message}: {field}");
    }
}
