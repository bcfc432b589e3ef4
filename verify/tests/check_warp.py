#!/usr/bin/env python3
"""Deforms an image with the inverse field of `mtled warp` by SimpleITK and compares with the
deformed image of `mtled warp`; the fields are read by nibabel too, and u(X) and X(x) - x must
undo each other. Usage: check_warp.py IMAGE DEFORMED FIELD INVERSE_FIELD [labels]"""

import sys

import nibabel
import numpy as np
import SimpleITK as sitk


def field_transform(path):
    image = sitk.ReadImage(path)
    assert image.GetNumberOfComponentsPerPixel() == 3, f"{path}: no vectors of three"
    assert image.GetDimension() == 3, f"{path}: {image.GetDimension()} axes"
    vectors = sitk.Cast(image, sitk.sitkVectorFloat64)
    if ".nii" in path:
        header = nibabel.load(path).header
        assert header.get_intent()[0] == "vector", f"{path}: {header.get_intent()}"
        assert header.get_data_shape()[3:] == (1, 3), f"{path}: {header.get_data_shape()}"
    return image, sitk.DisplacementFieldTransform(vectors)


def same_space(image, other, name):
    assert image.GetSize() == other.GetSize(), f"{name}: {other.GetSize()}"
    for what in ("GetOrigin", "GetSpacing", "GetDirection"):
        one, two = np.array(getattr(image, what)()), np.array(getattr(other, what)())
        assert np.abs(one - two).max() < 1e-4, f"{name}: {what} {two}, of the image {one}"


def main(path, deformed_path, field_path, inverse_path, kind="linear"):
    image, deformed = sitk.ReadImage(path), sitk.ReadImage(deformed_path)
    assert image.GetPixelID() == deformed.GetPixelID(), "the data type has changed"
    field, forward = field_transform(field_path)
    inverse_field, inverse = field_transform(inverse_path)
    for name, other in (("deformed", deformed), ("field", field), ("inverse", inverse_field)):
        same_space(image, other, name)

    how = sitk.sitkNearestNeighbor if kind == "labels" else sitk.sitkLinear
    real = image if kind == "labels" else sitk.Cast(image, sitk.sitkFloat64)
    ours = sitk.GetArrayFromImage(deformed).astype(float)
    theirs = sitk.GetArrayFromImage(sitk.Resample(real, image, inverse, how, 0.0)).astype(float)
    range_ = np.ptp(sitk.GetArrayFromImage(image).astype(float))
    # Whole numbers are rounded; a place on the outermost face may fall on either side of it.
    whole = "integer" in image.GetPixelIDTypeAsString()
    tolerance = 1e-4 * range_ + (0.5 if whole and kind != "labels" else 0.0)
    difference = np.abs(ours - theirs)
    differing = int((difference > tolerance).sum())
    print(f"{difference.size} voxels: {differing} differ, largest difference of the others "
          f"{difference[difference <= tolerance].max():.3g} of a range of {range_:.6g}")
    assert differing <= 1e-4 * difference.size, "SimpleITK makes another image"

    rest = []
    size = image.GetSize()
    for index in np.ndindex(*(min(n, 12) for n in size)):
        place = [int(i * (n - 1) / max(min(n, 12) - 1, 1)) for i, n in zip(index, size)]
        x = image.TransformIndexToPhysicalPoint(place)
        there = inverse.TransformPoint(x)
        inside = image.TransformPhysicalPointToContinuousIndex(there)
        if all(0 <= c <= n - 1 for c, n in zip(inside, size)):
            rest.append(np.linalg.norm(np.subtract(forward.TransformPoint(there), x)))
    print(f"forward after inverse at {len(rest)} voxels, u interpolated between voxels: "
          f"median {np.median(rest):.3g} mm, largest {np.max(rest):.3g} mm")
    assert np.median(rest) < 0.05 * max(image.GetSpacing()), "the fields do not undo each other"


if __name__ == "__main__":
    if len(sys.argv) not in (5, 6):
        sys.exit(__doc__)
    main(*sys.argv[1:])
