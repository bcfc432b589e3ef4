"""Selections and shapes of a case file as predicates on arrays of positions."""

from typing import Callable

import numpy as np

Labels = Callable[[np.ndarray], np.ndarray]
"""From positions (n, 3) [m] to the labels (n,) of the body's label map."""


def selected(
    selector, positions: np.ndarray, tolerance: float, labels: Labels | None = None
) -> np.ndarray:
    """Which of the positions (n, 3) [m] lie in the selection, as booleans (n,).

    `tolerance` [m] counts where the selection states none of its own.
    """
    if selector == "all":
        return np.ones(len(positions), dtype=bool)
    ((kind, content),) = selector.items()
    if kind in ("union", "intersection"):
        parts = [selected(part, positions, tolerance, labels) for part in content]
        return np.logical_or.reduce(parts) if kind == "union" else np.logical_and.reduce(parts)
    if kind == "not":
        return ~selected(content, positions, tolerance, labels)
    if kind == "shape":
        return inside(content, positions, tolerance, labels)
    if kind == "label":
        return _labelled(content.get("file"), [content["value"]], positions, labels)
    own = content.get("tolerance")
    own = tolerance if own is None else own
    if kind == "plane":
        return np.abs(_height(content, positions)) <= own
    if kind in ("half_space", "box", "sphere"):
        return inside({kind: content}, positions, own)
    raise ValueError(f"unknown selection {kind}")


def inside(
    shape: dict, positions: np.ndarray, tolerance: float = 0.0, labels: Labels | None = None
) -> np.ndarray:
    """Which of the positions (n, 3) [m] lie in the shape or within `tolerance` [m]."""
    ((kind, content),) = shape.items()
    if kind == "union":
        return np.logical_or.reduce([inside(s, positions, tolerance, labels) for s in content])
    if kind == "difference":
        whole, hole = content
        return inside(whole, positions, tolerance, labels) & ~inside(
            hole, positions, -tolerance, labels
        )
    if kind == "half_space":
        return _height(content, positions) <= tolerance
    if kind == "box":
        low, high = np.asarray(content["min"]), np.asarray(content["max"])
        return np.all((positions >= low - tolerance) & (positions <= high + tolerance), axis=1)
    if kind == "sphere":
        distance = np.linalg.norm(positions - np.asarray(content["centre"]), axis=1)
        return distance <= content["radius"] + tolerance
    if kind == "ellipsoid":
        radii = np.asarray(content["radii"]) + tolerance
        return (((positions - np.asarray(content["centre"])) / radii) ** 2).sum(axis=1) <= 1.0
    if kind == "cylinder":
        return _in_cylinder(content, positions, tolerance)
    if kind == "polygon":
        low, high = content["z"]
        between = (positions[:, 2] >= low - tolerance) & (positions[:, 2] <= high + tolerance)
        return between & _in_polygon(np.asarray(content["points"]), positions[:, :2], tolerance)
    if kind == "label_map":
        return _labelled(content["file"], content["labels"], positions, labels)
    raise ValueError(f"the shape {kind} is not known to the references")


def bounding_box(shape: dict) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner [m] of a box, cylinder along z, sphere or polygon."""
    ((kind, content),) = shape.items()
    if kind == "box":
        return np.array(content["min"], float), np.array(content["max"], float)
    if kind == "sphere":
        centre = np.asarray(content["centre"], float)
        return centre - content["radius"], centre + content["radius"]
    if kind == "cylinder":
        base, axis = np.asarray(content["base"]), np.asarray(content["axis"])
        axis = axis / np.linalg.norm(axis)
        reach = content["radius"] * np.sqrt(np.maximum(0.0, 1.0 - axis**2))
        ends = np.stack([base, base + content["height"] * axis])
        return ends.min(axis=0) - reach, ends.max(axis=0) + reach
    if kind == "polygon":
        points, z = np.asarray(content["points"]), content["z"]
        return np.append(points.min(axis=0), z[0]), np.append(points.max(axis=0), z[1])
    raise ValueError(f"no bounding box of the shape {kind}")


def _height(plane: dict, positions: np.ndarray) -> np.ndarray:
    """Signed distance [m] to a plane, positive on the side of the normal."""
    normal = np.asarray(plane["normal"], float)
    return (positions - np.asarray(plane["point"])) @ (normal / np.linalg.norm(normal))


def _in_cylinder(cylinder: dict, positions: np.ndarray, tolerance: float) -> np.ndarray:
    axis = np.asarray(cylinder["axis"], float)
    axis = axis / np.linalg.norm(axis)
    arm = positions - np.asarray(cylinder["base"])
    height = arm @ axis
    radius = np.linalg.norm(arm - np.outer(height, axis), axis=1)
    within = (height >= -tolerance) & (height <= cylinder["height"] + tolerance)
    return within & (radius <= cylinder["radius"] + tolerance)


def _in_polygon(corners: np.ndarray, points: np.ndarray, tolerance: float) -> np.ndarray:
    """Even–odd rule; points within `tolerance` of an edge count as inside (as
    outside where it is negative)."""
    odd = np.zeros(len(points), dtype=bool)
    nearest = np.full(len(points), np.inf)
    for start, end in zip(corners, np.roll(corners, -1, axis=0)):
        crosses = (start[1] > points[:, 1]) != (end[1] > points[:, 1])
        edge = end - start
        with np.errstate(divide="ignore", invalid="ignore"):
            x = start[0] + (points[:, 1] - start[1]) / edge[1] * edge[0]
        odd ^= crosses & (points[:, 0] < x)
        along = np.clip((points - start) @ edge / (edge @ edge), 0.0, 1.0)
        gap = np.linalg.norm(points - start - np.outer(along, edge), axis=1)
        nearest = np.minimum(nearest, gap)
    return odd | (nearest <= tolerance) if tolerance >= 0.0 else odd & (nearest > -tolerance)


def _labelled(file, values, positions: np.ndarray, labels: Labels | None) -> np.ndarray:
    if labels is None:
        raise ValueError(f"no label map at hand for the labels {values} of {file or 'the body'}")
    return np.isin(labels(positions), values)
