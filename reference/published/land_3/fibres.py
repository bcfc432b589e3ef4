"""Fibres of Land's third problem at points 1 mm apart, as ``python fibres.py > fibres.csv``.

The wall is r_s sin u cos v, r_s sin u sin v, r_l cos u with r_s = 7 + 3 t and r_l = 17 + 3 t mm; fibres lie at
90° - 180° t from the circumference (Land et al. 2015, section 3).
"""

from math import acos, atan2, cos, hypot, pi, sin

SPACING_MM = 1.0


def depth(radius: float, z: float) -> float:
    """t of the ellipsoid through a place, from the inner surface (0) to the outer one (1)."""
    low, high = -0.4, 1.4
    for _ in range(80):
        t = 0.5 * (low + high)
        outside = (radius / (7 + 3 * t)) ** 2 + (z / (17 + 3 * t)) ** 2 > 1
        low, high = (t, high) if outside else (low, t)
    return 0.5 * (low + high)


def fibre(x: float, y: float, z: float) -> list[float]:
    """Of length 1."""
    radius = hypot(x, y)
    t = depth(radius, z)
    short, long = 7 + 3 * t, 17 + 3 * t
    angle = 0.5 * pi - pi * t
    u, v = -acos(max(-1.0, min(1.0, z / long))), atan2(-y, -x)
    along = [short * cos(u) * cos(v), short * cos(u) * sin(v), -long * sin(u)]
    size = hypot(*along)
    around = [sin(v), -cos(v), 0.0]
    return [sin(angle) * a / size + cos(angle) * b for a, b in zip(along, around)]


def points():
    """A lattice over the wall and a little beyond, away from its axis."""
    count = round(21 / SPACING_MM)
    for i in range(-count, count + 1):
        for j in range(-count, count + 1):
            for k in range(-count, round(6 / SPACING_MM)):
                x, y, z = (i + 0.013) * SPACING_MM, (j + 0.007) * SPACING_MM, (k + 0.003) * SPACING_MM
                out = 0.3 * SPACING_MM
                within = hypot(hypot(x, y) / (10 + out), z / (20 + out)) <= 1
                if within and hypot(hypot(x, y) / (7 - out), z / (17 - out)) >= 1:
                    yield x, y, z


print("x,y,z,ux,uy,uz")
for place in points():
    print(",".join(f"{number:.5g}" for number in (*place, *fibre(*place))))
