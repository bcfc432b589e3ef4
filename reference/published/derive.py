"""Closed forms of the problems in this folder, by quadrature; Python's own library is enough.

`python derive.py` prints them; `python derive.py --check` compares them with `*/numbers.toml`
and with the pressures of the cases, and ends with exit code 1 where one differs."""

import math
import sys
import tomllib
from collections.abc import Callable
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
    return values


def stored() -> dict[str, dict[str, float]]:
    """Values of the closed forms in the files, and pressures of their cases."""
    values: dict[str, dict[str, float]] = {}
    for problem in {name.split("/")[0] for name in [*RODS, *WALLS]}:
        for row in tomllib.loads((HERE / problem / "numbers.toml").read_text())["number"]:
            name = f"{problem}/{row['case']}"
            values.setdefault(name, {})[row["answer"]] = row["value"]
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
    for name, answers in stored().items():
        for answer, value in answers.items():
            known = values[name].get(answer)
            # Other answers, such as those beside the axes, are not derived.
            if known is not None and abs(value - known) > SAME * abs(known):
                print(f"{name}: {answer} is {value}, derived {known}")
                wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
