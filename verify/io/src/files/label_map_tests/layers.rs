//! Layers of segments that overlap, as 3D Slicer writes them.

use super::files::{gzip, nrrd_text};
use crate::files::{FileError, LabelMapFile, read_label_map};

const HEADER: &str = "type: uint8\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 2 2 2\nspace \
                      directions: none (1,0,0) (0,2,0) (0,0,3)\nkinds: list domain domain \
                      domain\nspace origin: (4,5,6)\nSegment0_Name:=lung\nSegment0_Layer:=0\n\
                      Segment0_LabelValue:=5\nSegment1_Name:=tumour: left\nSegment1_Layer:=1\n\
                      Segment1_LabelValue:=1\n";

/// Layer 0 is 5 everywhere, layer 1 marks the last voxel.
const VOXELS: [u8; 16] = [5, 0, 5, 0, 5, 0, 5, 0, 5, 0, 5, 0, 5, 0, 5, 1];

fn read_layer(
    encoding: &str,
    data: &[u8],
    layer: Option<usize>,
) -> Result<LabelMapFile, FileError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.seg.nrrd");
    let header = format!("{HEADER}encoding: {encoding}\n");
    std::fs::write(&path, nrrd_text(&header, data)).unwrap();
    read_label_map(&path, None, layer)
}

#[test]
fn a_layer_of_overlapping_segments_is_read_by_its_number() {
    let text = VOXELS.map(|n| n.to_string()).join(" ");
    for (encoding, data) in
        [("raw", VOXELS.to_vec()), ("gzip", gzip(&VOXELS)), ("ascii", text.into_bytes())]
    {
        let first = read_layer(encoding, &data, Some(0)).unwrap().map;
        let second = read_layer(encoding, &data, Some(1)).unwrap().map;
        assert_eq!((first.size, first.labels), ([2; 3], vec![5; 8]));
        assert_eq!(second.labels, [0, 0, 0, 0, 0, 0, 0, 1]);
        // From L and P to R and A.
        assert!((second.origin.x + 0.004).abs() < 1e-15 && second.directions[(1, 1)] == -0.002);
    }
}

#[test]
fn several_layers_without_a_number_are_refused_with_their_segments() {
    let error = read_layer("raw", &VOXELS, None).unwrap_err().to_string();
    assert!(error.contains("2 layers of segments"), "{error}");
    assert!(error.contains("layer 0 (5 lung); layer 1 (1 tumour: left)"), "{error}");
    let error = read_layer("raw", &VOXELS, Some(2)).unwrap_err().to_string();
    assert!(error.contains("no layer 2; the file has 2, counted from 0"), "{error}");
}

#[test]
fn four_axes_that_are_no_layers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nrrd");
    let header = HEADER.replace("none (1,0,0)", "(1,0,0)");
    std::fs::write(&path, nrrd_text(&format!("{header}encoding: raw\n"), &VOXELS)).unwrap();
    let error = read_label_map(&path, None, Some(0)).unwrap_err().to_string();
    assert!(error.contains("`dimension` is `4`; expected 3, one label per voxel"), "{error}");
}
