"""Body forces above the level of a fluid, integrated over cells that the level cuts."""

import numpy as np

from ..shared.case import Case
from ..shared.selection import selected
from .mesh import Tetrahedra, quadratic

FINE = 3
"""Halvings of the edges of a cell that is cut: 512 parts, each with one point."""


def parts_of_the_reference_cell(halvings: int) -> np.ndarray:
    """Centres (8^halvings, 3) of equal parts of the reference tetrahedron."""
    corners = np.vstack([np.zeros(3), np.eye(3)])[None]
    for _ in range(halvings):
        a, b, c, d = (corners[:, k] for k in range(4))
        ab, ac, ad, bc, bd, cd = (
            0.5 * (p + q) for p, q in ((a, b), (a, c), (a, d), (b, c), (b, d), (c, d))
        )
        parts = [
            (a, ab, ac, ad),
            (b, ab, bc, bd),
            (c, ac, bc, cd),
            (d, ad, bd, cd),
            (ab, ac, ad, bd),
            (ab, ac, bc, bd),
            (ac, ad, bd, cd),
            (ac, bc, bd, cd),
        ]
        corners = np.concatenate([np.stack(part, axis=1) for part in parts])
    return corners.mean(axis=1)


def body_forces(case: Case, mesh: Tetrahedra) -> np.ndarray:
    """Forces on the nodes (3 n,) [N] at the end of loading."""
    at = parts_of_the_reference_cell(FINE)
    values, slopes = quadratic(at)
    density = np.array([region.material.density for region in case.regions])[mesh.region]
    total = np.zeros_like(mesh.nodes)
    for force in case.body_forces:
        acceleration = force.amplitude(case.time.load_end) * np.asarray(force.acceleration)
        for start in range(0, len(mesh.cells), 500):
            cells = mesh.cells[start : start + 500]
            nodes = mesh.nodes[cells]
            position = np.einsum("qa,eai->eqi", values, nodes, optimize=True)
            chosen = selected(force.selector, position.reshape(-1, 3), 0.0).reshape(len(cells), -1)
            jacobian = np.einsum("qaj,eai->eqij", slopes, nodes, optimize=True)
            volumes = np.linalg.det(jacobian) / (6.0 * len(at)) * chosen
            weights = (volumes @ values) * density[start : start + 500, None]
            np.add.at(total, cells, weights[..., None] * acceleration)
    return total.ravel()
