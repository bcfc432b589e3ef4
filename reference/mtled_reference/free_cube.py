"""Natural frequencies of a free isotropic cube (Demarest, J. Acoust. Soc. Am. 49, 768, 1971), by two
ways: Rayleigh and Ritz's method in products of Legendre polynomials, as in resonant ultrasound
spectroscopy (Ohno, J. Phys. Earth 24, 355, 1976; Migliori et al., Physica B 183, 1, 1993), and
triquadratic hexahedra of scikit-fem with consistent masses. Both are bounds from above.

    python -m mtled_reference.free_cube --poisson-ratio 0.3 --degree 20 --cells 8
"""

import argparse
from itertools import product

import numpy as np
from numpy.polynomial import legendre

RIGID = 1e-5
"""Frequencies below this are those of rigid motions."""


def ritz(poisson_ratio: float, degree: int) -> np.ndarray:
    """Frequencies times edge over √(E/density), in ascending order and without the rigid motions, with
    polynomials up to a total degree. Each of the eight symmetries has a problem of its own."""
    one, slope = _integrals(degree)
    found = []
    for parity in product((0, 1), repeat=3):
        rows = [(c, powers) for c in range(3) for powers in _powers(degree, c, parity)]
        component = np.array([c for c, _ in rows])
        powers = np.array([powers for _, powers in rows])
        stiffness = _stiffness(poisson_ratio, component, powers, (one, slope))
        found.extend(np.linalg.eigvalsh(stiffness))
    frequencies = np.sqrt(np.maximum(found, 0.0)) / (2.0 * np.pi)
    return np.sort(frequencies[frequencies > RIGID])


def _powers(degree: int, component: int, parity: tuple):
    """Degrees along the axes of a component: displacements along an axis are odd where others are even."""
    own = [p ^ (axis == component) for axis, p in enumerate(parity)]
    for powers in product(range(degree + 1), repeat=3):
        if sum(powers) <= degree and all(n % 2 == p for n, p in zip(powers, own, strict=True)):
            yield powers


def _integrals(degree: int):
    """∫ P_i' P_j and ∫ P_i' P_j' over the edge [−½, ½], for polynomials with ∫ P_i P_j = δ_ij."""
    x, w = legendre.leggauss(degree + 2)
    unit = np.eye(degree + 1) * np.sqrt(2.0 * np.arange(degree + 1) + 1.0)
    values = np.array([legendre.legval(x, own) for own in unit])
    slopes = np.array([2.0 * legendre.legval(x, legendre.legder(own)) for own in unit])
    return slopes * (w / 2.0) @ values.T, slopes * (w / 2.0) @ slopes.T


def _stiffness(poisson_ratio, component, powers, integrals):
    """∫ λ div u div v + 2 μ ε(u) : ε(v) with E = 1."""
    lame = poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))
    shear = 0.5 / (1.0 + poisson_ratio)
    mixed, both = integrals
    same = np.eye(len(mixed))

    def slopes(k: int, l: int):
        """∫ ∂_k f_i ∂_l f_j of all pairs."""
        result = 1.0
        for axis in range(3):
            p = powers[:, axis]
            factor = {2: both, 0: same}.get((axis == k) + (axis == l))
            if factor is None:
                factor = mixed if axis == k else mixed.T
            result = result * factor[np.ix_(p, p)]
        return result

    pairs = {(k, l): slopes(k, l) for k in range(3) for l in range(3)}
    of = [component == c for c in range(3)]
    laplacian = sum(pairs[k, k] for k in range(3))
    stiffness = shear * (component[:, None] == component[None, :]) * laplacian
    for i, j in pairs:
        mask = np.outer(of[i], of[j])
        stiffness = stiffness + mask * (lame * pairs[i, j] + shear * pairs[j, i])
    return 0.5 * (stiffness + stiffness.T)


def finite_elements(poisson_ratio: float, cells: int, count: int) -> np.ndarray:
    """The same of cells³ triquadratic hexahedra."""
    import skfem
    from scipy.sparse.linalg import eigsh
    from skfem.helpers import ddot, dot, sym_grad, trace

    edge = np.linspace(0.0, 1.0, cells + 1)
    mesh = skfem.MeshHex2.from_mesh(skfem.MeshHex.init_tensor(edge, edge, edge))
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex2()), intorder=4)
    lame = poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))
    shear = 0.5 / (1.0 + poisson_ratio)

    @skfem.BilinearForm
    def energy(u, v, _):
        e, f = sym_grad(u), sym_grad(v)
        return lame * trace(e) * trace(f) + 2.0 * shear * ddot(e, f)

    @skfem.BilinearForm
    def mass(u, v, _):
        return dot(u, v)

    stiffness, masses = energy.assemble(basis), mass.assemble(basis)
    start = np.random.default_rng(1).standard_normal(stiffness.shape[0])
    values = eigsh(stiffness, k=count + 6, M=masses, sigma=-0.1, v0=start)[0]
    return np.sqrt(np.sort(values)[6:]) / (2.0 * np.pi)


def main() -> None:
    """Prints the lowest frequencies and how much they change from the degree two lower."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poisson-ratio", type=float, required=True)
    parser.add_argument("--degree", type=int, default=16)
    parser.add_argument("--cells", type=int, help="also by finite elements")
    parser.add_argument("--count", type=int, default=14)
    options = parser.parse_args()
    here = ritz(options.poisson_ratio, options.degree)[: options.count]
    below = ritz(options.poisson_ratio, options.degree - 2)[: options.count]
    columns = [here, below - here]
    if options.cells:
        columns.append(finite_elements(options.poisson_ratio, options.cells, options.count))
    for row in zip(*columns, strict=True):
        print("  ".join(f"{value:.8f}" for value in row))


if __name__ == "__main__":
    main()
