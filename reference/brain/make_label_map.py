#!/usr/bin/env python3
"""Derive a small label map of one axial brain slice from the ICBM 152 (2009a) template.

Labels: 0 outside, 1 brain, 2 lateral ventricles, 3 tumour (synthetic ellipse).
Inputs are the T1, grey- and white-matter maps (1 mm) inside the nilearn wheel;
nilearn itself is not imported.  All lengths are mm, all areas mm^2, points are in
the template's MNI frame: RAS (x right, y anterior, z superior) unless said LPS.
"""
import argparse
import gzip
import hashlib
import io
import json
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import nibabel as nib
import numpy as np
from scipy import ndimage as ndi
from scipy.spatial import cKDTree

SCRIPT_VERSION = "1"
HERE = Path(__file__).resolve().parent
OUTPUTS = ("slice.nrrd", "slice.nii.gz", "slice.json")
NILEARN_VERSION = "0.14.1"
MEMBER = "nilearn/datasets/data/mni_icbm152_{}_tal_nlin_sym_09a_converted.nii.gz"
INPUT_SHA256 = {
    "t1": "421a10e872fd6cadae7f61d358dffbcc1795a497d61ee76c5dda2503e1a1e9e6",
    "gm": "97a5ca69bd24db37a9cb7b32525e1733a209af904129bf1cd36da06d24243bed",
    "wm": "382d92812de4744f9c86c7a0e4f680dc317a0a50e4da1f0153618a6798c7b7db",
}
NOTICE = "(C) 1993-2004 Louis Collins, McConnell BIC, MNI, McGill University; see COPYING"

# Lengths in mm; radii are those of disk structuring elements.
SET = {
    "tissue_min": 0.4,         # grey + white probability above which a voxel is tissue
    "csf_t1_max": 0.55,        # T1 / max(T1) below which a voxel beside a cavity is fluid
    "csf_grow_voxels": 4,      # how far the cavities may grow into it (horn tips, plexus)
    "z_candidates": [85, 86, 87, 88, 89, 90],  # voxel index of the axial slice
    "outline_radius": 8.0,     # closing and opening of the outline
    "outline_sigma": 2.0,      # Gaussian before the final threshold at one half
    "ventricle_radius": 2.5,   # closing; bridges the septum, so the frontal horns merge
    "ventricle_sigma": 0.7,
    "ventricle_min_area": 30,  # mm^2
    "tumour_offset": [21.0, 51.0],  # target tumour centre minus slice centroid (RAS)
    "tumour_semi_axes": [12.0, 10.0],
    "tumour_min_gap_outline": 6.0,
    "tumour_min_gap_ventricles": 3.0,
    "margin_voxels": 8,        # around the bounding box
    "slices": 5,               # the 2-D map is repeated over this many 1 mm slices
}


def fetch_wheel(folder):
    """Download the pinned nilearn wheel into `folder` with pip; return its path."""
    subprocess.run([sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest",
                    str(folder), f"nilearn=={NILEARN_VERSION}"], check=True)
    return next(Path(folder).glob("nilearn-*.whl"))


def read_inputs(wheel):
    """Return {t1, gm, wm: array in 0..1} and the 4x4 voxel-to-RAS affine (mm)."""
    maps = {}
    with zipfile.ZipFile(wheel) as archive:
        for key, digest in INPUT_SHA256.items():
            raw = archive.read(MEMBER.format(key))
            if hashlib.sha256(raw).hexdigest() != digest:
                sys.exit(f"{MEMBER.format(key)}: not the file of nilearn {NILEARN_VERSION}")
            image = nib.Nifti1Image.from_bytes(gzip.decompress(raw))
            maps[key] = np.asarray(image.dataobj).astype(float) / 255.0
    if not np.array_equal(image.affine[:3, :3], np.eye(3)):
        sys.exit("expected a 1 mm axis-aligned RAS template")
    return maps, image.affine


def components(mask, most=None):
    """The `most` largest face-connected components of `mask` (ties: scan order)."""
    labels, count = ndi.label(mask)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    return [labels == i + 1 for i in np.argsort(-sizes, kind="stable")[:most]]


def disk(radius):
    """Disk structuring element of `radius` (mm = pixels)."""
    r = int(radius)
    x, y = np.mgrid[-r:r + 1, -r:r + 1]
    return x * x + y * y <= radius * radius


def segment(maps):
    """3-D masks (brain with enclosed cavities filled, the two lateral ventricles)."""
    tissue = components(maps["gm"] + maps["wm"] >= SET["tissue_min"], 1)[0]
    brain = ndi.binary_fill_holes(tissue)
    cavities = components(brain & ~tissue, 3)
    core = cavities[0] | cavities[1]
    if maps["t1"][core].max() > SET["csf_t1_max"] or cavities[1].sum() < 10 * cavities[2].sum():
        sys.exit("the lateral ventricles are not the two large dark cavities")
    fluid = brain & (maps["t1"] < SET["csf_t1_max"])
    return brain, ndi.binary_dilation(core, iterations=SET["csf_grow_voxels"], mask=fluid)


def clean_outline(mask):
    """Close sulci and fissure, open necks and smooth a 2-D brain mask."""
    pad = 2 * int(SET["outline_radius"])
    mask = ndi.binary_closing(np.pad(mask, pad), disk(SET["outline_radius"]))
    mask = ndi.binary_opening(ndi.binary_fill_holes(mask), disk(SET["outline_radius"]))
    mask = ndi.gaussian_filter(mask.astype(float), SET["outline_sigma"]) > 0.5
    return components(mask)[0][pad:-pad, pad:-pad]


def clean_ventricles(mask):
    """Merge across the septum, smooth, and keep what is at least 2 pixels wide."""
    mask = ndi.binary_fill_holes(ndi.binary_closing(mask, disk(SET["ventricle_radius"])))
    mask = ndi.gaussian_filter(mask.astype(float), SET["ventricle_sigma"]) > 0.5
    mask = ndi.binary_opening(mask, np.ones((2, 2)))
    kept = [c for c in components(mask) if c.sum() >= SET["ventricle_min_area"]]
    return np.logical_or.reduce(kept)


def choose_slice(brain, ventricles):
    """Candidate z index with a connected brain and the largest ventricle area."""
    usable = [z for z in SET["z_candidates"] if len(components(brain[:, :, z])) == 1]
    return max(usable, key=lambda z: int(ventricles[:, :, z].sum()))


def faces(mask, origin):
    """Centres (mm, RAS) of the faces between pixels of `mask` and its complement."""
    points = []
    for axis in range(mask.ndim):
        at = np.argwhere(np.diff(mask.astype(np.int8), axis=axis) != 0).astype(float)
        at[:, axis] += 0.5
        points.append(at)
    return np.concatenate(points) + origin


def gap(a, b, origin):
    """Smallest distance (mm) between the boundaries of two 2-D masks."""
    return float(cKDTree(faces(b, origin)).query(faces(a, origin))[0].min())


def centroid(mask, origin):
    """Centroid (mm, RAS) of a mask."""
    return np.argwhere(mask).mean(axis=0) + origin


def ellipse(shape, centre, origin):
    """Pixels whose centre lies in the tumour ellipse around `centre` (mm, RAS)."""
    x, y = np.indices(shape) + np.reshape(origin, (2, 1, 1))
    a, b = SET["tumour_semi_axes"]
    return ((x - centre[0]) / a) ** 2 + ((y - centre[1]) / b) ** 2 <= 1.0


def place_tumour(outline, ventricles, origin):
    """Feasible ellipse closest to the target centre: (mask, centre, shift), mm."""
    target = centroid(outline, origin) + SET["tumour_offset"]
    steps = np.mgrid[-60:61, -60:61].reshape(2, -1).T * 0.5
    for shift in steps[np.argsort(np.hypot(*steps.T), kind="stable")]:
        mask = ellipse(outline.shape, target + shift, origin)
        inside = not (mask & (~outline | ventricles)).any()
        if (inside and gap(mask, outline, origin) >= SET["tumour_min_gap_outline"]
                and gap(mask, ventricles, origin) >= SET["tumour_min_gap_ventricles"]):
            return mask, target + shift, shift
    sys.exit("the tumour does not fit")


def craniotomy(outline, centre, origin):
    """Outline point nearest to `centre` (mm, RAS x y) and the outward unit normal there."""
    points = faces(outline, origin)
    point = points[np.argmin(np.hypot(*(points - centre).T))]
    smooth = ndi.gaussian_filter(outline.astype(float), 3.0)
    at = (point - origin).reshape(2, 1)
    normal = -np.array([ndi.map_coordinates(g, at, order=1)[0] for g in np.gradient(smooth)])
    return point, normal / np.hypot(*normal)


def make_labels(brain, ventricles, affine, z):
    """Cropped 2-D label image and the RAS position (mm) of its first pixel."""
    outline = clean_outline(brain[:, :, z])
    hollow = clean_ventricles(ventricles[:, :, z]) & outline
    tumour, centre, shift = place_tumour(outline, hollow, affine[:2, 3])
    labels = outline.astype(np.uint8)
    labels[hollow] = 2
    labels[tumour] = 3
    corner = np.argwhere(outline).min(axis=0) - SET["margin_voxels"]
    stop = np.argwhere(outline).max(axis=0) + SET["margin_voxels"] + 1
    if (corner < 0).any() or (stop > labels.shape).any():
        sys.exit("the margin leaves the template")
    return labels[corner[0]:stop[0], corner[1]:stop[1]], corner + affine[:2, 3], centre, shift


def deflate(data):
    """gzip `data` with no time stamp and no file name."""
    out = io.BytesIO()
    with gzip.GzipFile(filename="", mode="wb", fileobj=out, compresslevel=9, mtime=0) as f:
        f.write(data)
    return out.getvalue()


def nrrd_bytes(volume, origin, edge=1):
    """NRRD of `volume` (x fastest, RAS order, voxels of `edge` mm) from RAS `origin` (mm)."""
    x, y, z = (-origin[0], -origin[1], origin[2])
    header = ["NRRD0005", f"# {NOTICE}", "type: unsigned char", "dimension: 3",
              "space: left-posterior-superior", "sizes: {} {} {}".format(*volume.shape),
              f"space directions: (-{edge},0,0) (0,-{edge},0) (0,0,{edge})",
              "kinds: domain domain domain",
              "encoding: gzip", f"space origin: ({x:g},{y:g},{z:g})", "", ""]
    return "\n".join(header).encode("ascii") + deflate(volume.tobytes(order="F"))


def nifti_bytes(volume, origin):
    """The same map as gzipped NIfTI-1 (RAS, mm, sform and qform code 4 = MNI)."""
    affine = np.eye(4)
    affine[:3, 3] = origin
    image = nib.Nifti1Image(volume, affine)
    image.header.set_xyzt_units("mm")
    image.header["descrip"] = NOTICE[:79].encode("ascii")
    image.set_sform(affine, code=4)
    image.set_qform(affine, code=4)
    return deflate(image.to_bytes())


def both(vector):
    """A vector or point (mm) in RAS and LPS, rounded to 1e-4."""
    ras = np.round(np.asarray(vector, dtype=float), 4) + 0.0
    lps = ras * [-1.0, -1.0, 1.0][:len(ras)] + 0.0
    return {"ras": ras.tolist(), "lps": lps.tolist()}


def provenance():
    """Where the template comes from, as a JSON-ready dictionary."""
    return {
        "package": "nilearn", "version": NILEARN_VERSION,
        "files": [{"name": MEMBER.format(k), "sha256": v} for k, v in INPUT_SHA256.items()],
        "template": "ICBM 152 2009a nonlinear symmetric, 1 mm", "notice": NOTICE}


def describe(labels, origin, centre, shift, z):
    """Provenance and measures (mm, mm^2) as a JSON-ready dictionary."""
    xy = origin[:2]
    outline, hollow, tumour = labels > 0, labels == 2, labels == 3
    parts = {"slice": outline, "brain": labels == 1, "ventricles": hollow, "tumour": tumour}
    point, normal = craniotomy(outline, centroid(tumour, xy), xy)
    edge = faces(outline, xy)
    return {
        "source": provenance(),
        "script_version": SCRIPT_VERSION,
        "z_index": z, "settings": SET,
        "labels": {"0": "outside", "1": "brain", "2": "ventricles", "3": "tumour"},
        "grid": {"sizes": [*labels.shape, SET["slices"]], "spacing_mm": [1.0, 1.0, 1.0],
                 "first_voxel_mm": both(origin),
                 "template_slice_z_mm": float(origin[2] + SET["slices"] // 2)},
        "area_mm2": {name: int(mask.sum()) for name, mask in parts.items()},
        "centroid_mm": {name: both(centroid(mask, xy)) for name, mask in parts.items()},
        "bounding_box_ras_mm": {"min": edge.min(axis=0).tolist(), "max": edge.max(axis=0).tolist()},
        "ventricle_regions": [{"area_mm2": int(p.sum()), "centroid_mm": both(centroid(p, xy))}
                              for p in components(hollow)],
        "tumour": {
            "ellipse_centre_mm": both(centre), "shift_ras_mm": shift.tolist(),
            "offset_mm": both(centroid(tumour, xy) - centroid(outline, xy)),
            "gap_to_outline_mm": round(gap(tumour, outline, xy), 4),
            "gap_to_ventricles_mm": round(gap(tumour, hollow, xy), 4)},
        "craniotomy": {"outline_point_mm": both(point), "outward_normal": both(normal),
                       "distance_to_tumour_centroid_mm":
                           round(float(np.hypot(*(point - centroid(tumour, xy)))), 4)},
    }


def build(wheel, folder):
    """Write the three output files into `folder`; return the description."""
    maps, affine = read_inputs(wheel)
    brain, ventricles = segment(maps)
    z = choose_slice(brain, ventricles)
    labels, corner, centre, shift = make_labels(brain, ventricles, affine, z)
    origin = np.array([*corner, z + affine[2, 3] - SET["slices"] // 2])
    volume = np.repeat(labels[:, :, None], SET["slices"], axis=2)
    info = describe(labels, origin, centre, shift, z)
    contents = (nrrd_bytes(volume, origin), nifti_bytes(volume, origin),
                (json.dumps(info, indent=1) + "\n").encode("ascii"))
    for name, data in zip(OUTPUTS, contents):
        (Path(folder) / name).write_bytes(data)
    return info


def write_or_check(description, outputs, build):
    """Command line of a script: `build(wheel, folder)` writes the files `outputs` and returns
    their description, of which some entries are printed."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--wheel", type=Path, help="nilearn wheel (default: pip download)")
    parser.add_argument("--check", action="store_true", help="compare with the committed files")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        wheel = args.wheel or fetch_wheel(scratch)
        info = build(wheel, scratch if args.check else HERE)
        differing = [n for n in outputs if args.check
                     and (Path(scratch) / n).read_bytes() != (HERE / n).read_bytes()]
    for key in [k for k in info if k not in ("source", "script_version", "settings", "labels")]:
        print(f"{key}: {json.dumps(info[key])}")
    if differing:
        sys.exit("differs from the committed files: " + ", ".join(differing))


if __name__ == "__main__":
    write_or_check(__doc__.splitlines()[0], OUTPUTS, build)
