"""Blocks of boxes, discs, cylinders and balls, and of the material around them.

A plane patch is a map from (n, 2) in [0, 1] to (n, 2). A disc is an O-grid: an inner
square, and patches between it and the circle.
"""

import numpy as np

from .mesh import Block

QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])

SQUARE = 0.5
"""Half-width of the inner square of a disc over the radius [–]."""


def towards_both_ends(strength: float):
    """A division of [0, 1] that is finer at both ends by 1 − strength."""
    return lambda s: s - strength * np.sin(2.0 * np.pi * s) / (2.0 * np.pi)


def towards_end(strength: float):
    """A division of [0, 1] that is finer at 1 by 1 − strength and even at 0."""
    return lambda s: s + strength * np.sin(np.pi * s) / np.pi


def towards_start(strength: float):
    """A division of [0, 1] that is finer at 0 by 1 − strength and coarser at 1."""
    return lambda s: s - strength * np.sin(np.pi * s) / np.pi


def evenly(s):
    """An even division of [0, 1]."""
    return s


def equal_angles(s):
    """A division of [0, 1] that is even in the angle, seen from the distance 1."""
    return np.tan(0.25 * np.pi * s)


def both_ways(division):
    """A division of [0, 1] that follows `division` from the middle to both ends."""

    def place(s):
        t = 2.0 * s - 1.0
        return 0.5 * (1.0 + np.sign(t) * division(np.abs(t)))

    return place


def box_block(low, high, counts, divisions=None) -> Block:
    """An axis-parallel box (or rectangle) divided along each axis."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    divisions = divisions or [evenly] * len(low)

    def place(r: np.ndarray) -> np.ndarray:
        divided = np.stack([divide(r[:, i]) for i, divide in enumerate(divisions)], axis=1)
        return low + divided * (high - low)

    return Block(place, tuple(counts))


def inner_square(r: np.ndarray) -> np.ndarray:
    """The quarter x, y ≥ 0 of the inner square of the unit disc; its outer corner is
    moved inward, so that angles stay near a right angle."""
    return SQUARE * r * (1.0 - 0.12 * r[:, ::-1] ** 2)


def outer_patch(r: np.ndarray) -> np.ndarray:
    """The patch of the unit disc between the side x = SQUARE of the inner square and
    the circle, over angles 0 to 45°; r = (from square to circle, angle)."""
    side = inner_square(np.stack([np.ones(len(r)), r[:, 1]], axis=1))
    angle = 0.25 * np.pi * r[:, 1]
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return side + r[:, :1] * (circle - side)


def beyond_patch(reach: float, division=evenly):
    """The patch between the unit circle and the square of half-width `reach`, over
    angles 0 to 45°; r = (from circle to square, angle)."""

    def place(r: np.ndarray) -> np.ndarray:
        angle = 0.25 * np.pi * r[:, 1]
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        square = reach * np.stack([np.ones(len(r)), np.tan(angle)], axis=1)
        return circle + division(r[:, :1]) * (square - circle)

    return place


def mirrored(patch):
    """The patch over angles 90° to 45° that mirrors a patch over 0 to 45°."""
    return lambda r: patch(r)[:, ::-1]


def rotated(patch, quarters: int):
    """A patch rotated by quarter turns about the origin."""
    matrix = np.linalg.matrix_power(QUARTER_TURN, quarters)
    return lambda r: patch(r) @ matrix.T


def quarter_disc(across: int, around: int) -> list:
    """Patches of the quarter x, y ≥ 0 of the unit disc with their counts: `around`
    elements along each 45°, `across` elements between inner square and circle."""
    return [
        (inner_square, (around, around)),
        (outer_patch, (across, around)),
        (mirrored(outer_patch), (across, around)),
    ]


def whole(patches: list) -> list:
    """The patches of a quarter rotated into all four quarters."""
    return [(rotated(patch, q), counts) for q in range(4) for patch, counts in patches]


def extruded(patches: list, scale: float, z, count: int, division=evenly) -> list[Block]:
    """Blocks over plane patches scaled by `scale` [m], between two heights z [m]."""

    def block(patch, counts) -> Block:
        def place(r: np.ndarray) -> np.ndarray:
            height = z[0] + division(r[:, 2]) * (z[1] - z[0])
            return np.column_stack([scale * patch(r[:, :2]), height])

        return Block(place, (*counts, count))

    return [block(patch, counts) for patch, counts in patches]


def between(inner: Block, outer, count: int, division=evenly) -> Block:
    """A layer between two surfaces, along straight lines between equal parameters."""

    def place(r: np.ndarray) -> np.ndarray:
        start, end = inner.map(r[:, :2]), outer(r[:, :2])
        return start + division(r[:, 2:]) * (end - start)

    return Block(place, (*inner.counts, count))


def on_sphere(radius: float):
    """The central projection of positions [m] on the sphere around the origin."""
    return lambda X: radius * X / np.linalg.norm(X, axis=1, keepdims=True)


def cube_face(half: float, n: int, axis: int, sign: int, division) -> Block:
    """The face across `axis` of the part x, y ≥ 0 of the cube [−half, half]³, as a
    surface; n elements over a half-width, spaced by `division`."""
    others = [i for i in range(3) if i != axis]

    def place(r: np.ndarray) -> np.ndarray:
        X = np.empty((len(r), 3))
        X[:, axis] = sign
        for column, other in enumerate(others):
            s = r[:, column]
            X[:, other] = 2.0 * both_ways(division)(s) - 1.0 if other == 2 else division(s)
        return half * X

    return Block(place, tuple(2 * n if other == 2 else n for other in others))


def quadrilateral(corners, counts, divisions=(evenly, evenly)) -> Block:
    """A quadrilateral with corners (0,0), (1,0), (1,1), (0,1) of the square."""
    a, b, c, d = (np.asarray(corner, float) for corner in corners)

    def place(r: np.ndarray) -> np.ndarray:
        s, t = divisions[0](r[:, :1]), divisions[1](r[:, 1:])
        return (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d

    return Block(place, tuple(counts))


def moved(block: Block, offset) -> Block:
    """A block moved by an offset [m]."""
    return Block(lambda r: block.map(r) + np.asarray(offset), block.counts)
