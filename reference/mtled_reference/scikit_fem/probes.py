"""Points in the mesh: the element that contains a point, and its shape functions there."""

import numpy as np
from scipy.spatial import KDTree

from .model import Model

CANDIDATES = 12
"""Number of elements, nearest by their centres, in which a point is searched."""

OVERSHOOT = 0.02
"""How far outside its element a point may lie, in reference coordinates [–]: near a curved
boundary the mesh runs slightly inside the body."""


def located(model: Model, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (p, a) and shape functions (p, a) of the elements that contain points (p, d)."""
    dofs = model.basis.element_dofs.T
    centres = model.nodes[dofs].mean(axis=1)
    count = min(CANDIDATES, len(centres))
    candidates = KDTree(centres).query(points, k=count)[1].reshape(len(points), count)
    elements = candidates.ravel()
    targets = np.repeat(points, count, axis=0)
    reference, shapes = _inverse_map(model, elements, targets)
    outside = np.maximum(-reference, reference - 1.0).max(axis=1)
    error = np.einsum("pa,pad->pd", shapes, model.nodes[dofs[elements]]) - targets
    size = np.ptp(model.nodes, axis=0).max()
    outside[~(np.linalg.norm(error, axis=1) < 1e-9 * size)] = np.inf
    outside = outside.reshape(len(points), count)
    best = outside.argmin(axis=1)
    if np.any(outside[np.arange(len(points)), best] > OVERSHOOT):
        raise ValueError("a probe lies outside the mesh")
    chosen = np.arange(len(points)) * count + best
    return dofs[elements[chosen]], shapes[chosen]


def _inverse_map(model: Model, elements, targets) -> tuple[np.ndarray, np.ndarray]:
    """Reference coordinates (p, d) of positions in elements, by Newton's method, and the
    shape functions there."""
    nodes = model.nodes[model.basis.element_dofs.T[elements]]
    reference = np.full(targets.shape, 0.5)
    for _ in range(20):
        shapes, slopes = _shapes(model, reference)
        error = targets - np.einsum("pa,pad->pd", shapes, nodes)
        jacobian = np.einsum("pai,pad->pdi", slopes, nodes)
        step = np.linalg.solve(jacobian, error[..., None])[..., 0]
        reference = np.clip(reference + step, -1.0, 2.0)
        if np.abs(step).max() < 1e-12:
            break
    return reference, _shapes(model, reference)[0]


def _shapes(model: Model, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions (p, a) and their reference gradients (p, a, d)."""
    element = model.basis.elem
    pairs = [element.lbasis(reference.T, i) for i in range(model.basis.Nbfun)]
    values = np.stack([np.broadcast_to(pair[0], len(reference)) for pair in pairs], axis=1)
    return values, np.stack([np.asarray(pair[1]).T for pair in pairs], axis=1)
