"""Body forces of the manufactured solutions, derived from the strain energies.

A displacement field u(X) on the unit cube and a strain energy psi(F) give
P = d psi / d F and the body force per mass that balances u, b = -Div P / rho.
Everything is differentiated symbolically and evaluated with 40 digits at a few
points; tests compare the implementations in Rust and NumPy with the result.

    python derive.py            writes body_force.json
    python derive.py --check    compares with it instead
"""

import argparse
import itertools
import json
import pathlib
import sys

import mpmath
import sympy as sp

FILE = pathlib.Path(__file__).with_name("body_force.json")
YOUNG_MODULUS, DENSITY = 3000, 1000  # Pa, kg/m3
CASES = [
    ("general", "neo_hookean_log_j", "0.3"),
    ("general", "neo_hookean_isochoric", "0.3"),
    *(
        ("nearly_isochoric", law, ratio)
        for law in ("neo_hookean_log_j", "neo_hookean_isochoric", "mooney_rivlin")
        for ratio in ("0.49", "0.499")
    ),
]
POINTS = [("1/5", "7/10", "2/5"), ("9/10", "1/10", "3/5"), ("1/2", "1", "1"), ("0", "1/4", "3/4")]

x, y, z = X = sp.symbols("x y z", real=True)


def general(x, y, z):
    return [sp.sin(sp.pi * x) / 20, y**2 * z / 4, x * sp.log(1 + y) / 10]


def shears(x, y, z):
    """Three shears one after the other: the determinant of the map is 1."""
    u = z * sp.sin(sp.pi * y) / 10
    v = z * (x + u) ** 2 / 10
    w = (y + v) * sp.sin(sp.pi * (x + u)) / 10
    return [u, v, w]


def displacement(field, mu, lam):
    if field == "general":
        return sp.Matrix(general(*X))
    return sp.Matrix(shears(*X)) + mu / lam * sp.Matrix(general(*X))


def strain_energy(law, F, mu, lam, nu):
    J = F.det()
    C = F.T * F
    first = C.trace()
    if law == "neo_hookean_log_j":
        return mu / 2 * (first - 3) - mu * sp.log(J) + lam / 2 * sp.log(J) ** 2
    if law == "neo_hookean_isochoric":
        bulk = lam + sp.Rational(2, 3) * mu
        return mu / 2 * (J ** sp.Rational(-2, 3) * first - 3) + bulk / 2 * (J - 1) ** 2
    a, b = sp.Rational(2, 5) * mu, sp.Rational(1, 10) * mu
    c = a / 2 + b
    d = (a * (5 * nu - 2) + b * (11 * nu - 5)) / (2 * (1 - 2 * nu))
    second, third = (first**2 - (C * C).trace()) / 2, J**2
    return a * (first - 3) + b * (second - 3) + c * (third**-2 - 1) + d * (third - 1) ** 2


def derive(field, law, ratio):
    """Values of u, F and b at a point, from symbolic derivatives of u and psi:
    Div P_i = sum d2 psi/(dF_iJ dF_kL) d2 u_k/(dX_L dX_J)."""
    nu = sp.Rational(ratio)
    mu, lam = YOUNG_MODULUS / (2 * (1 + nu)), YOUNG_MODULUS * nu / ((1 + nu) * (1 - 2 * nu))
    u = displacement(field, mu, lam)
    gradient = sp.eye(3) + u.jacobian(X)
    slopes = [gradient.diff(X[j]) for j in range(3)]
    F = sp.Matrix(3, 3, sp.symbols("F:3:3"))
    psi = strain_energy(law, F, mu, lam, nu)
    stress = F.applyfunc(psi.diff)
    tangents = [stress[i, j].diff(f) for i in range(3) for j in range(3) for f in F]
    in_space = sp.lambdify(X, [u, gradient, *slopes], "mpmath", cse=True)
    stiffness = sp.lambdify(list(F), tangents, "mpmath", cse=True)

    def at(point):
        with mpmath.workdps(40):
            u, F, *slopes = in_space(*point)
            A = stiffness(*F)
            b = [0, 0, 0]
            for n, (i, j, k, l) in enumerate(itertools.product(range(3), repeat=4)):
                b[i] -= A[n] * slopes[j][k, l] / DENSITY
            F = [[float(F[i, j]) for j in range(3)] for i in range(3)]
            return [float(v) for v in u], F, [float(v) for v in b]

    return at


def rows():
    for field, law, ratio in CASES:
        at = derive(field, law, ratio)
        for point in POINTS:
            position = [mpmath.mpf(sp.Rational(s).p) / sp.Rational(s).q for s in point]
            u, F, b = at(position)
            yield {
                "field": field,
                "law": law,
                "poisson_ratio": float(ratio),
                "position": [float(s) for s in position],
                "displacement": u,
                "deformation_gradient": F,
                "body_force": b,
            }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare with the committed file")
    arguments = parser.parse_args()
    derived = {
        "made_by": "reference/manufactured/derive.py",
        "sympy": sp.__version__,
        "young_modulus": float(YOUNG_MODULUS),
        "density": float(DENSITY),
        "rows": list(rows()),
    }
    if not arguments.check:
        lines = ",\n".join("    " + json.dumps(row) for row in derived.pop("rows"))
        head = json.dumps(derived, indent=2)[:-2]
        FILE.write_text(f'{head},\n  "rows": [\n{lines}\n  ]\n}}\n')
        return 0
    committed = json.loads(FILE.read_text())
    same = committed["rows"] == derived["rows"]
    print(f"{len(derived['rows'])} rows: {'the same' if same else 'DIFFERENT'}")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
