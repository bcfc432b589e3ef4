"""The element kernel against finite differences and against invariance."""

import numpy as np
import pytest

skfem = pytest.importorskip("skfem")

from mtled_reference.scikit_fem.hexahedra import box_block
from mtled_reference.scikit_fem.kernel import Elements, evaluate
from mtled_reference.scikit_fem.mesh import mesh_of_blocks
from mtled_reference.shared.materials import Material, material_from_table

MATERIALS = {
    "log_j": {"law": "neo_hookean_log_j", "young_modulus": 3.0, "poisson_ratio": 0.3},
    "isochoric": {"law": "neo_hookean_isochoric", "young_modulus": 3.0, "poisson_ratio": 0.45},
    "simo_taylor": {
        "law": "neo_hookean_isochoric",
        "volumetric": "simo_taylor",
        "young_modulus": 3.0,
        "poisson_ratio": 0.4,
    },
    "st_venant": {"law": "st_venant_kirchhoff", "lame_modulus": 2.0, "shear_modulus": 1.0},
    "rubber": {"law": "mooney_rivlin", "A": 0.8, "B": 0.3, "poisson_ratio": 0.47},
}


def elements_of(dimension: int, material: Material, mixed: bool) -> Elements:
    """Two skewed elements in a row."""
    skew = np.eye(dimension) + 0.1 * np.arange(dimension**2).reshape(dimension, dimension) / 9.0
    block = box_block([0.0] * dimension, [1.0] * dimension, [2] + [1] * (dimension - 1))
    mesh = mesh_of_blocks([type(block)(lambda r: block.map(r) @ skew.T, block.counts)])
    basis = skfem.CellBasis(mesh, mesh.elem(), intorder=4)
    points = np.asarray(basis.global_coordinates()).transpose(1, 2, 0)
    arms = points - points.mean(axis=1, keepdims=True)
    functions = np.concatenate([np.ones_like(arms[..., :1]), arms], axis=2)
    gradients = np.stack([b[0].grad.transpose(1, 2, 0) for b in basis.basis], axis=2)
    return Elements(
        material, basis.element_dofs.T, gradients, basis.dx, functions if mixed else None
    )


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize("name", MATERIALS)
def test_residual_and_tangent_are_derivatives_of_the_energy(name, mixed, dimension):
    material = material_from_table(name, MATERIALS[name] | {"density": 1.0})
    elements = elements_of(dimension, material, mixed)
    random = np.random.default_rng(1)
    count = elements.nodes.max() + 1
    u = 0.03 * random.standard_normal((count, dimension))
    way = random.standard_normal((count, dimension))
    step = 1e-5
    state = evaluate(elements, u, True)
    plus, minus = (evaluate(elements, u + s * way, False) for s in (step, -step))
    local = way[elements.nodes]
    slope = (state.residual * local).sum(axis=(1, 2))
    difference = (plus.energy - minus.energy) / (2.0 * step)
    assert np.allclose(slope, difference, rtol=0.0, atol=2e-6 * np.abs(slope).max())
    product = np.einsum("exy,ey->ex", state.tangent, local.reshape(len(local), -1))
    difference = (plus.residual - minus.residual) / (2.0 * step)
    scale = np.abs(product).max()
    assert np.allclose(product, difference.reshape(product.shape), atol=2e-6 * scale)
    assert np.allclose(state.tangent, state.tangent.swapaxes(1, 2), atol=1e-12 * scale)


@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize("name", MATERIALS)
def test_a_rotated_element_has_no_energy_and_no_force(name, mixed):
    material = material_from_table(name, MATERIALS[name] | {"density": 1.0})
    elements = elements_of(3, material, mixed)
    angle = 0.7
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    skewed = _positions(elements)
    state = evaluate(elements, skewed @ (turn - np.eye(3)).T, False)
    assert np.abs(state.energy).max() < 1e-13
    assert np.abs(state.residual).max() < 1e-13


def _positions(elements: Elements) -> np.ndarray:
    """Nodal values of x, y, z, from the gradients that they must have."""
    count = elements.nodes.max() + 1
    rows, right = [], []
    for nodes, gradients in zip(elements.nodes, elements.gradients):
        for gradient in gradients:
            row = np.zeros((3, count))
            row[:, nodes] = gradient.T
            rows.append(row)
            right.append(np.eye(3))
    return np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=None)[0]
