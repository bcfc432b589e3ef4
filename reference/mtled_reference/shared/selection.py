"""Selections and shapes of a case file as predicates on arrays of positions."""

import numpy as np

from .polygon import inside_polygon


def selected(selector, positions: np.ndarray, tolerance: float) -> np.ndarray:
    """Which of the positions (n, 3) [m] lie in the selection, as booleans (n,).

    `tolerance` [m] applies where the selection has none of its own.
    """
    if selector == "all":
        return np.ones(len(positions), dtype=bool)
    ((kind, content),) = selector.items()
    if kind in ("union", "intersection"):
        parts = [selected(part, positions, tolerance) for part in content]
        return np.logical_or.reduce(parts) if kind == "union" else np.logical_and.reduce(parts)
    if kind == "not":
        return ~selected(content, positions, tolerance)
    if kind == "shape":
        return inside(content, positions, tolerance)
    own = content.get("tolerance")
    own = tolerance if own is None else own
    if kind == "plane":
        return np.abs(_height(content, positions)) <= own
    if kind in ("half_space", "box", "sphere"):
        return inside({kind: content}, positions, own)
    raise ValueError(f"selection {kind} is not supported by the reference codes")


def inside(shape: dict, positions: np.ndarray, tolerance: float = 0.0) -> np.ndarray:
    """Which of the positions (n, 3) [m] lie in the shape or within `tolerance` [m]."""
    ((kind, content),) = shape.items()
    if kind in ("union", "intersection"):
        parts = [inside(part, positions, tolerance) for part in content]
        return np.logical_or.reduce(parts) if kind == "union" else np.logical_and.reduce(parts)
    if kind == "difference":
        whole, hole = content
        return inside(whole, positions, tolerance) & ~inside(hole, positions, -tolerance)
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
    raise ValueError(f"shape {kind} is not supported by the reference codes")


def bounding_box(shape: dict) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner [m] of a box, cylinder, sphere or polygon; of an intersection or
    a difference that of its first member, which contains it."""
    ((kind, content),) = shape.items()
    if kind in ("intersection", "difference"):
        return bounding_box(content[0])
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
    raise ValueError(f"no bounding box for shape {kind}")


def cut_of_ball(shape: dict) -> tuple[float, float]:
    """Radius [m] of the ball around the origin in an intersection with a half-space, and how
    far below its centre the plane cuts it [m]."""
    ball, above = shape["intersection"]
    return ball["sphere"]["radius"], -above["half_space"]["point"][2]


def radii_of_quarter_ring(shape: dict) -> tuple[float, float] | None:
    """Inner and outer radius [m] of a quarter of a ring around the z axis, the difference of two
    cylinders in a box with x ≥ 0 and y ≥ 0; None of another shape."""
    try:
        ring, quarter = shape["intersection"]
        outer, inner = (member["cylinder"] for member in ring["difference"])
        low = quarter["box"]["min"]
    except (KeyError, TypeError, ValueError):
        return None
    axes = [cylinder["axis"][:2] + cylinder["base"][:2] for cylinder in (outer, inner)]
    if np.any(axes) or np.any(low[:2]):
        return None
    return inner["radius"], outer["radius"]


def on_quarter_ring(radii: tuple[float, float], s: np.ndarray) -> np.ndarray:
    """Points (n, 2) [m] of a quarter of a ring at s (n, 2) in [0, 1] across it and around."""
    inner, outer = radii
    radius, angle = inner + (outer - inner) * s[:, 0], 0.5 * np.pi * s[:, 1]
    points = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    # On the axes, up to round-off.
    return np.where(np.abs(points) < 1e-12 * outer, 0.0, points)


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
    """Points within `tolerance` of an edge count as inside, or as outside where it is
    negative."""
    odd = inside_polygon(points, corners)
    nearest = np.full(len(points), np.inf)
    for start, end in zip(corners, np.roll(corners, -1, axis=0)):
        edge = end - start
        along = np.clip((points - start) @ edge / (edge @ edge), 0.0, 1.0)
        gap = np.linalg.norm(points - start - np.outer(along, edge), axis=1)
        nearest = np.minimum(nearest, gap)
    return odd | (nearest <= tolerance) if tolerance >= 0.0 else odd & (nearest > -tolerance)
