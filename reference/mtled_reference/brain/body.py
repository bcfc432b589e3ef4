"""The geometry of the brain slice: outline, regions, craniotomy and skull."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RectBivariateSpline
from scipy.ndimage import gaussian_filter
from scipy.optimize import brentq
from scipy.spatial import cKDTree

from ..shared.case import Case
from .image import Slice, read_slice, signed_distance
from .outline import Curve, curves_around

OUTLINE_SMOOTHING = 0.0005
"""Smoothing along the outline [m]. It leaves traces of the voxels, about 0.1 mm: the body
slides along the skull, and without them its centres of mass move 0.05 mm (at 1 s) to
0.1 mm (at 2 s) farther."""
BORDER_SMOOTHING = 0.0015
"""Smoothing along the borders of the regions [m]."""


@dataclass(frozen=True)
class Body:
    """Outline, inner borders with the regions inside them, and the arc of the outline
    in the craniotomy: from `craniotomy[0]` to `craniotomy[1]` [m] along it."""

    outline: Curve
    borders: list[tuple[Curve, int]]
    outer_region: int
    craniotomy: tuple[float, float]
    image: Slice


def read_body(case: Case) -> Body:
    """The body in the cross-section of the case."""
    label_map = case.shape["label_map"]
    image = read_slice(case.folder / label_map["file"], case.plane_z)
    (outline,) = _curves(image, label_map["labels"], OUTLINE_SMOOTHING)
    borders, outer = [], None
    for index, region in enumerate(case.regions):
        if region.selector == "all":
            outer = index
            continue
        label = region.selector["label"]["value"]
        curves = _curves(image, [label], BORDER_SMOOTHING)
        borders += [(curve, index) for curve in curves]
    (prescription,) = case.prescriptions
    craniotomy = _arc_in_sphere(outline, prescription.selector["sphere"], case.plane_z)
    return Body(outline, borders, outer, craniotomy, image)


def _curves(image: Slice, labels: list[int], smoothing: float) -> list[Curve]:
    return curves_around(signed_distance(image, labels), image.axes(), smoothing)


def _arc_in_sphere(outline: Curve, sphere: dict, z: float) -> tuple[float, float]:
    """Where the outline enters and leaves the sphere; the end may exceed the length."""
    centre, radius = np.array(sphere["centre"]), sphere["radius"]
    reach = np.sqrt(radius**2 - (z - centre[2]) ** 2)

    def outside(s):
        return np.linalg.norm(outline.at(s) - centre[:2], axis=-1) - reach

    s = np.linspace(0.0, outline.length, 2001)
    sign = np.sign(outside(s))
    crossings = [
        (brentq(outside, s[n], s[n + 1]), sign[n] > 0.0)
        for n in np.nonzero(sign[1:] * sign[:-1] < 0.0)[0]
    ]
    if len(crossings) != 2:
        raise ValueError("the craniotomy is not one arc of the outline")
    ((first, enters), (second, _)) = crossings
    return (first, second) if enters else (second, first + outline.length)


class Skull:
    """The skull around the body: the outline of some labels grown by an offset.

    The gap is g(x) = offset − d(x) [m], open if positive, with the signed distance d to
    the outline computed on a grid of 1 mm and interpolated by cubic splines.
    """

    def __init__(self, case: Case, body: Body):
        (obstacle,) = case.obstacles
        same = obstacle.shape == case.shape
        if not same or obstacle.side != "inside" or obstacle.friction != "frictionless":
            raise ValueError("the skull must be frictionless, around the outline of the body")
        axes = body.image.axes()
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        # Slight smoothing rounds the ridges of the distance near concave parts.
        distance = _distance_to_polygon(grid.reshape(-1, 2), body.outline.polygon(2.5e-4))
        labels = case.shape["label_map"]["labels"]
        inner = RectBivariateSpline(*axes, signed_distance(body.image, labels), kx=1, ky=1)
        sign = np.where(inner(*axes) < 0.0, -1.0, 1.0)
        signed = gaussian_filter(sign * distance.reshape(sign.shape), 0.5)
        self.spline = RectBivariateSpline(*axes, obstacle.offset - signed)

    def gap(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps (n,) [m] at points (n, 2) and their gradients (n, 2), which point
        from the wall towards the body."""
        x, y = points.T
        gradient = [self.spline.ev(x, y, dx=1), self.spline.ev(x, y, dy=1)]
        return self.spline.ev(x, y), np.column_stack(gradient)


def _distance_to_polygon(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Distance [m] of points to a closed polygon of short edges."""
    _, nearest = cKDTree(corners).query(points)
    best = np.full(len(points), np.inf)
    for step in (-1, 1):
        start, end = corners[nearest], corners[(nearest + step) % len(corners)]
        edge = end - start
        along = np.sum((points - start) * edge, axis=1) / np.sum(edge * edge, axis=1)
        foot = start + np.clip(along, 0.0, 1.0)[:, None] * edge
        best = np.minimum(best, np.linalg.norm(points - foot, axis=1))
    return best
