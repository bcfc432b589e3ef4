"""Closed forms of the problems in this folder, by quadrature; Python's own library is enough.

`python derive.py` prints them; `python derive.py --check` compares them with `*/numbers.toml`
and with the pressures of the cases, and ends with exit code 1 where one differs."""

import math
import sys
import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path

HERE = Path(__file__).parent
STEPS = 400
"""Steps of the integrals [–]: eight digits of each."""
SAME = 1e-4
"""Relative difference up to which stored and derived values are the same: printed digits."""


def elastica(along: float, across: float) -> tuple[float, float]:
    """Displacements of the end of an inextensible clamped rod over its length, along it and across
    it, under an end force with these components over EI/L² [–]. The slope θ obeys
    θ'' = along sin θ − across cos θ, θ(0) = 0, θ'(1) = 0 (Bisshopp and Drucker 1945)."""

    def from_tip(tip: float) -> tuple[float, float, float]:
        """Slope at the clamp, and x and y of the tip, from the slope at the tip."""
        step = 1.0 / STEPS
        state = [tip, 0.0, 0.0, 0.0]

        def rate(s: list[float]) -> list[float]:
            bending = along * math.sin(s[0]) - across * math.cos(s[0])
            return [s[1], bending, math.cos(s[0]), math.sin(s[0])]

        for _ in range(STEPS):
            a = rate(state)
            b = rate([s + 0.5 * step * r for s, r in zip(state, a)])
            c = rate([s + 0.5 * step * r for s, r in zip(state, b)])
            d = rate([s + step * r for s, r in zip(state, c)])
            state = [
                s + step / 6 * (p + 2 * q + 2 * r + t)
                for s, p, q, r, t in zip(state, a, b, c, d)
            ]
        return state[0], state[2], state[3]

    # The branch with the largest slope of the tip below a half turn.
    scan = [math.pi * (1 - k / 200) for k in range(200)]
    high = low = scan[0]
    for angle in scan:
        if from_tip(angle)[0] * from_tip(high)[0] < 0:
            low = angle
            break
        high = angle
    for _ in range(60):
        middle = 0.5 * (low + high)
        if from_tip(middle)[0] * from_tip(high)[0] < 0:
            low = middle
        else:
            high = middle
    _, x, y = from_tip(high)
    return x - 1.0, y


def hollow(
    derivative: Callable[[float], float], inner: float, outer: float, stretch: float, power: int
) -> tuple[float, float]:
    """Pressure [Pa] that stretches the inner radius of an incompressible cylinder (`power` 2, held
    lengthwise) or sphere (3), and the displacement of the outer radius [m]:
    p = ∫ W'(λ) λ dr/r over the deformed wall, λ = r/R, W(λ) the energy (Ogden 1984, 5.3)."""
    grown = (stretch**power - 1) * inner**power

    def integrand(R: float) -> float:
        r = (R**power + grown) ** (1 / power)
        # dr/r = (R/r)^power dR/R.
        return r / R * derivative(r / R) * (R / r) ** power / R

    step = (outer - inner) / STEPS
    total = sum(
        (1 if k in (0, STEPS) else 4 if k % 2 else 2) * integrand(inner + k * step)
        for k in range(STEPS + 1)
    )
    return total * step / 3, (outer**power + grown) ** (1 / power) - outer


def of_invariants(first: Callable[[float], float], second: Callable[[float], float], power: int):
    """dW/dλ from ∂W/∂I₁ and ∂W/∂I₂ as functions of I₁ − 3, for a cylinder or a sphere."""
    if power == 2:
        invariants = lambda s: (s**2 + s**-2 - 2, 2 * s - 2 * s**-3, 2 * s - 2 * s**-3)
    else:
        invariants = lambda s: (2 * s**2 + s**-4 - 3, 4 * s - 4 * s**-5, 4 * s**3 - 4 * s**-3)

    def derivative(s: float) -> float:
        x, of_first, of_second = invariants(s)
        return first(x) * of_first + second(x) * of_second

    return derivative


def none(_: float) -> float:
    return 0.0


def twisting_column() -> dict[str, float]:
    """Kinetic energy [J] and angular momentum [kg·m²/s] of a column of 1 m × 1 m × 6 m and
    1100 kg/m³ that turns about its axis with 105 sin(πz/12) rad/s."""
    of_length, rate = 1100.0 / 6.0, 105.0
    return {
        "energy/kinetic start": 0.5 * of_length * rate**2 * 3.0,
        "angular_momentum/z start": of_length * rate * 12.0 / math.pi,
    }


def bouncing_ball(radius: float, modulus: float, density: float, speed: float) -> dict[str, float]:
    """Impact of a quarter of an elastic ball [m, E/(1 − ν²) in Pa, kg/m³, m/s] on a rigid wall (Hertz
    1882; Johnson 1985, eq. 11.23 and 11.24): δ is greatest where F's work is the kinetic energy, and
    half of the time is ∫ dδ/v."""
    mass = 4.0 / 3.0 * math.pi * radius**3 * density
    deepest = (15.0 * mass * speed**2 / (16.0 * math.sqrt(radius) * modulus)) ** 0.4
    force = 4.0 / 3.0 * modulus * math.sqrt(radius) * deepest**1.5
    # ∫ dx/√(1 − x^2.5) from 0 to 1 is √π Γ(1.4)/Γ(0.9).
    half = math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9) * deepest / speed
    return {
        "contact/floor/z maximum": force / 4.0,
        "contact/floor/z duration": 2.0 * half,
        "displacement/centre/z minimum": -deepest,
        "displacement/centre/z time_of_minimum": half,
        "momentum/z": mass * speed / 4.0,
    }


def gauss_points(count: int) -> list[tuple[float, float]]:
    """Places and weights of the Gauss–Legendre quadrature of [0, 1], by Newton's method."""
    points = []
    for k in range(count):
        x = math.cos(math.pi * (k + 0.75) / (count + 0.5))
        for _ in range(20):
            before, value = 1.0, x
            for degree in range(2, count + 1):
                next_one = ((2 * degree - 1) * x * value - (degree - 1) * before) / degree
                before, value = value, next_one
            slope = count * (x * value - before) / (x * x - 1.0)
            x -= value / slope
        points.append((0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope**2)))
    return points


def solve(matrix: list[list[float]], right: list[list[float]]) -> list[list[float]]:
    """Solutions of a diagonally dominant system, by elimination."""
    for k, (pivot_row, pivot_right) in enumerate(zip(matrix, right)):
        for row, own in zip(matrix[k + 1 :], right[k + 1 :]):
            factor = row[k] / pivot_row[k]
            row[k:] = [a - factor * b for a, b in zip(row[k:], pivot_row[k:])]
            own[:] = [a - factor * b for a, b in zip(own, pivot_right)]
    for k in reversed(range(len(matrix))):
        for column in range(len(right[k])):
            rest = sum(a * x[column] for a, x in zip(matrix[k][k + 1 :], right[k + 1 :]))
            right[k][column] = (right[k][column] - rest) / matrix[k][k]
    return right


def layer_force(modulus: float, ratio: float, radius: float, height: float, depth: float) -> float:
    """Force [N] of a rigid, smooth sphere of so much radius [m] at a depth [m] in an elastic layer of
    so much height [m] that is bonded to a rigid base, at small strains. The pressure's Hankel
    transform is ∫ φ(t) cos kt dt over the radius a of the contact, where φ(a) = 0 and
    π/2 φ(x) − ∫ φ(t) S(x, t) dt = E* (δ − x²/R)/2, S = ∫ (1 − L(kh)) cos kx cos kt dk
    (Lebedev and Ufliand 1958; Hayes, Keer, Herrmann and Mockros 1972)."""
    q, steps, end = 3.0 - 4.0 * ratio, 400, 25.0

    def rest(k: float) -> float:
        """1 − L(k): what the base takes from the flexibility of a half-space."""
        e = math.exp(-2.0 * k)
        return 1.0 - (q * (1 - e * e) - 4 * k * e) / (q * (1 + e * e) + e * (4 * k * k + 1 + q * q))

    places = [(j + 0.5) * end / steps for j in range(steps)]
    waves = [(k / height, rest(k) * end / steps / height) for k in places]
    points, plane = gauss_points(12), modulus / (1.0 - ratio**2)

    def kernel(x: float) -> float:
        return 0.5 * sum(weight * math.cos(k * x) for k, weight in waves)

    def contact(a: float) -> tuple[float, float]:
        """Depth and force where the contact has the radius a."""
        at = [(a * x, a * w) for x, w in points] + [(a, 0.0)]
        matrix = [
            [0.5 * math.pi * (x == t) - w * (kernel(x - t) + kernel(x + t)) for t, w in at]
            for x, _ in at
        ]
        found = solve(matrix, [[0.5 * plane, 0.5 * plane * x * x / radius] for x, _ in at])
        reached = found[-1][1] / found[-1][0]
        total = sum(w * (reached * one - two) for (_, w), (one, two) in zip(at, found))
        return reached, 2.0 * math.pi * total

    low, high = 0.5 * math.sqrt(radius * depth), 2.0 * math.sqrt(radius * depth)
    for _ in range(25):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if contact(middle)[0] < depth else (low, middle)
    return contact(high)[1]


INNER, OUTER = 0.01, 0.02
WALLS = {
    # name of the case: (∂W/∂I₁, ∂W/∂I₂, stretch of the inner radius, power)
    "thick_cylinder/neo_hookean": (lambda x: 5e3, none, 1.5, 2),
    "thick_cylinder/yeoh": (lambda x: 5e3 + 2 * 1e3 * x + 3 * 200 * x**2, none, 1.5, 2),
    "thick_cylinder/demiray": (lambda x: 5e3 * math.exp(x), none, 1.5, 2),
    "thick_sphere/neo_hookean": (lambda x: 5e3, none, 1.5, 3),
    "thick_sphere/mooney_rivlin": (lambda x: 4e3, lambda x: 1e3, 1.5, 3),
    "thick_sphere/demiray": (lambda x: 5e3 * math.exp(0.5 * x), none, 1.4, 3),
}
RODS = {
    # name of the case: (force along, force across) over EI/L²
    "elastica/load_1": (0.0, 1.0),
    "elastica/load_5": (0.0, 5.0),
    "elastica/load_10": (0.0, 10.0),
    "euler_column/below": (-0.9 * math.pi**2 / 4, 0.009 * math.pi**2 / 4),
    "euler_column/above": (-1.152 * math.pi**2 / 4, 1.152e-3 * math.pi**2 / 4),
    "euler_column/far_above": (-1.518 * math.pi**2 / 4, 1.518e-3 * math.pi**2 / 4),
}


def derived() -> dict[str, dict[str, float]]:
    """Values by answer, by case; lengths of rods are 1 m."""
    values = {}
    for name, (along, across) in RODS.items():
        x, y = elastica(along, across)
        values[name] = {"displacement/tip/x": x, "displacement/tip/y": y}
    for name, (first, second, stretch, power) in WALLS.items():
        energy = of_invariants(first, second, power)
        pressure, outside = hollow(energy, INNER, OUTER, stretch, power)
        values[name] = {
            "pressure": pressure,
            "displacement/inner/x": (stretch - 1) * INNER,
            "displacement/outer/x": outside,
        }
    values["twisting_column/case"] = twisting_column()
    values["bouncing_ball/case"] = bouncing_ball(0.01, 1e6 / 0.91, 1000.0, 0.02)
    force = layer_force(3000.0, 0.45, 0.05, 0.01, 0.0003)
    values["indented_layer/case"] = {"contact/sphere/z": -force / 4.0}
    return values


def stored(names: Iterable[str]) -> dict[str, dict[str, float]]:
    """Values of the closed forms in the files, and pressures of their cases."""
    values: dict[str, dict[str, float]] = {}
    for problem in {name.split("/")[0] for name in names}:
        for row in tomllib.loads((HERE / problem / "numbers.toml").read_text())["number"]:
            name = f"{problem}/{row['case']}"
            answer = f"{row['answer']} {row['when']}" if "when" in row else row["answer"]
            values.setdefault(name, {})[answer] = row["value"]
            case = tomllib.loads((HERE / f"{name}.toml").read_text())
            for load in case.get("pressure", []):
                values[name]["pressure"] = load["pressure"]
    return values


def main() -> int:
    values = derived()
    if "--check" not in sys.argv:
        for name, answers in values.items():
            print(name, *(f"{answer} {value:.8g}" for answer, value in answers.items()), sep="\n  ")
        return 0
    wrong = 0
    for name, answers in stored(values).items():
        for answer, value in answers.items():
            known = values[name].get(answer)
            # Other answers, such as those beside the axes, are not derived.
            if known is not None and abs(value - known) > SAME * abs(known):
                print(f"{name}: {answer} is {value}, derived {known}")
                wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
