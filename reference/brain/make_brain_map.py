#!/usr/bin/env python3
"""Derive a label map of a whole brain in voxels of 2 mm from the ICBM 152 (2009a) template.

Labels: 0 outside, 1 brain, 2 ventricles, 3 tumour (synthetic ellipsoid).  The template,
its segmentation and the file format are those of make_label_map.py.  All lengths are mm,
all volumes ml, points are in the template's MNI frame (RAS) unless said LPS.
"""
import json
import sys
from pathlib import Path

import numpy as np
from make_label_map import (both, centroid, components, faces, nrrd_bytes, provenance,
                            read_inputs, segment, write_or_check)
from scipy import ndimage as ndi

SCRIPT_VERSION = "1"
OUTPUTS = ("brain.nrrd", "brain.json")

# Lengths in mm; radii are those of balls.
SET = {
    "voxel": 2,
    "close_radius": 8.0,          # sulci and fissures of the outline
    "open_radius": 5.0,           # spurs of the outline
    "outline_sigma": 2.5,         # Gaussian before the threshold at one half
    "stem_z": -55.0,              # the brain stem is cut here
    "ventricle_radius": 3.0,      # closing
    "ventricle_sigma": 1.2,       # Gaussian; the threshold keeps the volume
    "ventricle_min_volume": 0.5,  # ml
    "ventricle_min_depth": 6.0,   # below the outline
    "tumour_offset": [27.0, 38.0, 12.0],  # target centre minus the centroid of the brain
    "tumour_semi_axes": [13.0, 11.0, 11.0],
    "tumour_min_depth": 20.0,     # of the centre below the outline
    "tumour_min_gap": 16.0,       # of the centre from the ventricles
    "craniotomy_min_height": 5.0,  # above the centre of the tumour
    "normal_sigma": 5.0,          # Gaussian before the gradient that gives the normal
    "margin_voxels": 4,
}


def closed(mask, radius):
    """Closing of a 3-D mask by a ball of `radius` voxels, by distance transforms."""
    pad = int(radius) + 2
    grown = ndi.distance_transform_edt(~np.pad(mask, pad)) <= radius
    return (ndi.distance_transform_edt(grown) > radius)[(slice(pad, -pad),) * 3]


def opened(mask, radius):
    """Opening of a 3-D mask by a ball of `radius` voxels; the mask goes on at its edges."""
    pad = 2 * int(radius) + 10
    return ~closed(~np.pad(mask, pad, mode="edge"), radius)[(slice(pad, -pad),) * 3]


def clean_outline(mask, z):
    """Smooth outline of the brain: closed, opened, cut below; `z` are those of the layers."""
    mask = ndi.binary_fill_holes(closed(mask, SET["close_radius"]))
    smooth = ndi.gaussian_filter(opened(mask, SET["open_radius"]).astype(np.float32),
                                 SET["outline_sigma"])
    smooth[:, :, z < SET["stem_z"]] = 0.0
    return components(smooth > 0.5, 1)[0]


def clean_ventricles(mask, outline):
    """Smooth ventricles of the same volume, without small parts, deep inside the outline."""
    smooth = ndi.gaussian_filter(closed(mask, SET["ventricle_radius"]).astype(np.float32),
                                 SET["ventricle_sigma"])
    smooth = smooth > np.sort(smooth.ravel())[-int(mask.sum())]
    large = [c for c in components(smooth, 4) if c.sum() > 1000 * SET["ventricle_min_volume"]]
    return np.logical_or.reduce(large) & (
        ndi.distance_transform_edt(outline) > SET["ventricle_min_depth"])


def coarse(mask):
    """Voxels of the coarser map of which at least half is in the mask (1 mm)."""
    n = SET["voxel"]
    a, b, c = (size // n for size in mask.shape)
    fractions = mask[:a * n, :b * n, :c * n].reshape(a, n, b, n, c, n).mean(axis=(1, 3, 5))
    return fractions >= 0.5


def place_tumour(outline, ventricles, positions):
    """Mask and centre (mm) of the ellipsoid whose centre is nearest to the target."""
    edge = SET["voxel"]
    target = positions[outline].mean(axis=0) + SET["tumour_offset"]
    feasible = ((ndi.distance_transform_edt(outline) * edge > SET["tumour_min_depth"])
                & (ndi.distance_transform_edt(~ventricles) * edge > SET["tumour_min_gap"]))
    candidates = positions[feasible]
    centre = candidates[np.argmin(((candidates - target) ** 2).sum(axis=1))]
    reduced = (positions - centre) / SET["tumour_semi_axes"]
    return (reduced ** 2).sum(axis=-1) <= 1.0, centre


def craniotomy(labels, origin, tumour_centre):
    """Voxel of the outline nearest to the tumour from above, and the outward normal there."""
    edge, outline = SET["voxel"], labels > 0
    points = np.argwhere(outline & ~ndi.binary_erosion(outline)) * edge + origin
    points = points[points[:, 2] > tumour_centre[2] + SET["craniotomy_min_height"]]
    point = points[np.argmin(((points - tumour_centre) ** 2).sum(axis=1))]
    smooth = ndi.gaussian_filter(outline.astype(float), SET["normal_sigma"] / edge)
    at = ((point - origin) / edge).reshape(3, 1)
    slope = [ndi.map_coordinates(g, at, order=1)[0] for g in np.gradient(smooth)]
    return point, -np.array(slope) / np.linalg.norm(slope)


def make_labels(maps, affine):
    """Cropped labels, the RAS position (mm) of the first voxel and the tumour's centre."""
    brain, hollow = segment(maps)
    outline = clean_outline(brain, np.arange(brain.shape[2]) + affine[2, 3])
    hollow = coarse(clean_ventricles(hollow, outline))
    outline = components(coarse(outline), 1)[0]
    edge = SET["voxel"]
    origin = affine[:3, 3] + 0.5 * (edge - 1)
    positions = np.stack(np.indices(outline.shape), axis=-1) * float(edge) + origin
    tumour, centre = place_tumour(outline, hollow, positions)
    labels = outline.astype(np.uint8)
    labels[hollow & outline] = 2
    labels[tumour] = 3
    filled = np.argwhere(outline)
    low = filled.min(axis=0) - SET["margin_voxels"]
    high = filled.max(axis=0) + SET["margin_voxels"] + 1
    if (low < 0).any() or (high > labels.shape).any():
        sys.exit("the margin leaves the template")
    cropped = labels[tuple(slice(a, b) for a, b in zip(low, high))]
    return np.ascontiguousarray(cropped), origin + low * edge, centre


def describe(labels, origin, centre):
    """Provenance and measures (mm, ml) as a JSON-ready dictionary."""
    edge = SET["voxel"]
    parts = {"body": labels > 0, "brain": labels == 1, "ventricles": labels == 2,
             "tumour": labels == 3}
    point, normal = craniotomy(labels, origin, centre)
    corners = faces(parts["body"], np.zeros(3)) * edge + origin
    return {
        "source": provenance(),
        "script_version": SCRIPT_VERSION,
        "settings": SET,
        "labels": {"0": "outside", "1": "brain", "2": "ventricles", "3": "tumour"},
        "grid": {"sizes": list(labels.shape), "spacing_mm": [edge] * 3,
                 "first_voxel_mm": both(origin)},
        "volume_ml": {name: round(float(mask.sum()) * edge ** 3 / 1000, 3)
                      for name, mask in parts.items()},
        "centroid_mm": {name: both(centroid(mask, origin / edge) * edge)
                        for name, mask in parts.items()},
        "bounding_box_ras_mm": {"min": corners.min(axis=0).tolist(),
                                "max": corners.max(axis=0).tolist()},
        "tumour": {"ellipsoid_centre_mm": both(centre)},
        "craniotomy": {"outline_point_mm": both(point), "outward_normal": both(normal),
                       "distance_to_tumour_centre_mm":
                           round(float(np.linalg.norm(point - centre)), 4)},
    }


def build(wheel, folder):
    """Write the two output files into `folder`; return the description."""
    labels, origin, centre = make_labels(*read_inputs(wheel))
    info = describe(labels, origin, centre)
    contents = (nrrd_bytes(labels, origin, SET["voxel"]),
                (json.dumps(info, indent=1) + "\n").encode("ascii"))
    for name, data in zip(OUTPUTS, contents):
        (Path(folder) / name).write_bytes(data)
    return info


if __name__ == "__main__":
    write_or_check(__doc__.splitlines()[0], OUTPUTS, build)
