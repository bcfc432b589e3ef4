"""Blocks of bodies: box, quadrilateral, disc in a square or ball in a cube, half disc."""

import numpy as np

from .mesh_blocks import Block


def even(s):
    """A map of [0, 1] onto itself with equal intervals."""
    return s


def towards_one(power: float):
    """A map of [0, 1] onto itself whose intervals shrink towards 1."""
    return lambda s: 1.0 - (1.0 - s) ** power


def towards_zero(power: float):
    """A map of [0, 1] onto itself whose intervals shrink towards 0."""
    return lambda s: s**power


def towards_both(power: float):
    """A map of [0, 1] onto itself whose intervals shrink towards 0 and 1."""

    def graded(s):
        half = 0.5 * np.minimum(2.0 * s, 2.0 - 2.0 * s) ** power
        return np.where(s < 0.5, half, 1.0 - half)

    return graded


def box(low, high, counts, gradings=None) -> list[Block]:
    """A box or rectangle, graded along each axis."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    gradings = gradings or [None] * len(low)

    def placed(s):
        columns = [s[:, i] if g is None else g(s[:, i]) for i, g in enumerate(gradings)]
        return low + np.stack(columns, axis=1) * (high - low)

    return [Block(placed, tuple(counts))]


def bilinear(corners, counts, gradings) -> list[Block]:
    """A quadrilateral with the corners (0,0), (1,0), (0,1), (1,1)."""
    a, b, c, d = (np.asarray(corner, float) for corner in corners)

    def placed(s):
        x, y = (g(s[:, [i]]) for i, g in enumerate(gradings))
        return (1 - x) * (1 - y) * a + x * (1 - y) * b + (1 - x) * y * c + x * y * d

    return [Block(placed, tuple(counts))]


def _between(inner, outer, grading):
    """Straight lines from a curve or surface `inner` to `outer`, along the first
    coordinate."""

    def placed(s):
        t = grading(s[:, [0]])
        return (1.0 - t) * inner(s[:, 1:]) + t * outer(s[:, 1:])

    return placed


def _direction(axis: int, across: np.ndarray) -> np.ndarray:
    """Points with 1 on the axis and tan(π/4 s) across it: a face of the cube whose
    projection from the origin is spaced evenly in angle."""
    return np.insert(np.tan(0.25 * np.pi * across), axis, 1.0, axis=1)


def _sphere(axis: int, radius: float):
    """The part of a circle or sphere in front of a face across the axis."""

    def placed(s):
        far = _direction(axis, s)
        return radius * far / np.linalg.norm(far, axis=1, keepdims=True)

    return placed


def core_and_shells(
    size: int, core: float, radii: tuple, outer: float, counts, gradings
) -> list[Block]:
    """The part of a square or cube around the origin in the positive quadrant or octant:
    a core, shells to the circles or spheres of `radii` [m] in turn, and shells from the
    last one to the faces at distance `outer` [m].

    `counts` is the number of cells across the core and across each shell, `gradings`
    act outwards in each shell. `core` is the half-width of the core on an axis over
    the first radius [–].
    """
    across = counts[0]
    width = core * radii[0]

    def bulged(points):
        """The cube of the core, its corners moved in towards a sphere."""
        square = np.tan(0.25 * np.pi * points)
        length = np.linalg.norm(square, axis=1, keepdims=True)
        largest = square.max(axis=1, keepdims=True)
        with np.errstate(invalid="ignore", divide="ignore"):
            round_ = np.where(length > 0.0, square * largest / length, 0.0)
        return width * (0.5 * square + 0.5 * round_)

    blocks = [Block(bulged, (across,) * size)]
    for axis in range(size):

        def surface(s, axis=axis):
            return bulged(np.insert(s, axis, 1.0, axis=1))

        def face(s, axis=axis):
            return outer * _direction(axis, s)

        surfaces = [surface, *(_sphere(axis, radius) for radius in radii), face]
        for inner, outside, count, graded in zip(surfaces, surfaces[1:], counts[1:], gradings):
            cells = (count, *(across,) * (size - 1))
            blocks.append(Block(_between(inner, outside, graded), cells))
    return blocks


def extruded(blocks: list[Block], low: float, high: float, count: int, grading) -> list[Block]:
    """Plane blocks extruded along z."""

    def raised(block):
        def placed(s):
            height = low + grading(s[:, [2]]) * (high - low)
            return np.concatenate([block.map(s[:, :2]), height], axis=1)

        return placed

    return [Block(raised(block), (*block.counts, count)) for block in blocks]


def half_disc(
    radius: float, foot_angle: float, counts, power: float, cut: bool = False
) -> list[Block]:
    """The half x ≥ 0 of a disc around the origin: a rectangle and three shells, of
    which the lowest reaches from −π/2 to `foot_angle` [rad] along the circle, or, where
    the disc is `cut` there, along the chord.

    `counts` is the number of cells along a shell's arc and across a shell; `power`
    grades them towards the point of the circle at `foot_angle`.
    """
    along, across = counts
    top_angle = 0.25 * np.pi
    low, high = 0.5 * radius * np.sin(foot_angle), 0.5 * radius * np.sin(top_angle)
    width = 0.45 * radius * np.cos(foot_angle)
    # The three sides of the rectangle, each with the angles of its arc.
    sides = [
        ((0.0, low), (width, low), -0.5 * np.pi, foot_angle),
        ((width, low), (width, high), foot_angle, top_angle),
        ((0.0, high), (width, high), 0.5 * np.pi, top_angle),
    ]
    towards = [towards_one(power), towards_zero(power), towards_one(power)]
    blocks = box((0.0, low), (width, high), (along, along), towards[:2])
    for (start, end, first, last), graded in zip(sides, towards):

        def side(s, start=np.array(start), end=np.array(end), graded=graded):
            return start + graded(s) * (end - start)

        def arc(s, first=first, last=last, graded=graded):
            if cut and last == foot_angle:
                end = radius * np.array([np.cos(last), np.sin(last)])
                return np.stack([graded(s[:, 0]) * end[0], np.full(len(s), end[1])], axis=1)
            angle = first + graded(s[:, 0]) * (last - first)
            return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)

        blocks.append(Block(_between(side, arc, towards_one(power)), (across, along)))
    return blocks
