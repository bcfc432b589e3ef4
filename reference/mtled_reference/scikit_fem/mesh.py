"""Meshes of hexahedra or quadrilaterals of order 2 from blocks.

A block is a smooth map of the unit cube or square to space, divided evenly. Blocks are
joined where corners of their elements coincide. All nodes lie on the map, so that
curved boundaries are approximated to order 2.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import skfem


@dataclass(frozen=True)
class Block:
    """A map from reference coordinates (n, d) in [0, 1] to positions (n, d) [m]
    and the number of elements along each reference direction."""

    map: Callable[[np.ndarray], np.ndarray]
    counts: tuple[int, ...]


def mesh_of_blocks(blocks: list[Block]) -> skfem.Mesh:
    """MeshHex2 or MeshQuad2 of the blocks."""
    dimension = len(blocks[0].counts)
    linear, quadratic = {
        2: (skfem.MeshQuad1, skfem.MeshQuad2),
        3: (skfem.MeshHex1, skfem.MeshHex2),
    }[dimension]
    local = quadratic.elem.doflocs
    positions = np.concatenate([_element_nodes(block, local) for block in blocks])
    corners = positions[:, : 2**dimension].reshape(-1, dimension)
    extent = np.ptp(corners, axis=0).max()
    keys = np.round(corners / (1e-7 * extent)).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    t = np.ascontiguousarray(inverse.reshape(-1, 2**dimension).T.astype(np.int32))
    mesh = linear(np.ascontiguousarray(corners[first].T), t)
    curved = quadratic.from_mesh(mesh)
    nodes = skfem.CellBasis(mesh, quadratic.elem(), intorder=1).element_dofs
    doflocs = np.empty((dimension, nodes.max() + 1))
    doflocs[:, nodes.T] = positions.transpose(2, 0, 1)
    return quadratic(doflocs, curved.t)


def interpolated(
    coarse: list[Block], fine: list[Block], bases: tuple, values: np.ndarray
) -> np.ndarray:
    """Nodal values (n, k) on the mesh of the coarse blocks, interpolated at the nodes
    of the same blocks with finer divisions; `bases` are those of the two meshes."""
    below, above = bases
    element = below.elem
    fine_values = np.zeros((above.element_dofs.max() + 1, values.shape[1]))
    first_coarse = first_fine = 0
    for old, new in zip(coarse, fine):
        counts = np.array(old.counts)
        reference = _references(new, element.doflocs)
        cells = np.minimum((reference * counts).astype(int), counts - 1)
        local = (reference * counts - cells).reshape(-1, len(counts))
        if _is_left_handed(old, element.doflocs):
            local[:, 0] = 1.0 - local[:, 0]
        elements = first_coarse + np.ravel_multi_index(tuple(np.moveaxis(cells, -1, 0)), old.counts)
        nodes = below.element_dofs[:, elements.ravel()]
        shapes = np.stack([element.lbasis(local.T, i)[0] for i in range(below.Nbfun)])
        targets = above.element_dofs.T[first_fine : first_fine + len(reference)]
        fine_values[targets.ravel()] = np.einsum("ap,apk->pk", shapes, values[nodes])
        first_coarse += int(np.prod(old.counts))
        first_fine += len(reference)
    return fine_values


def _element_nodes(block: Block, local: np.ndarray) -> np.ndarray:
    """Positions (e, a, d) of the nodes of the elements of a block."""
    reference = _references(block, local)
    return block.map(reference.reshape(-1, reference.shape[2])).reshape(reference.shape)


def _references(block: Block, local: np.ndarray) -> np.ndarray:
    """Coordinates (e, a, d) in the block of the nodes of its elements, ordered so that
    the volumes are positive."""
    if _is_left_handed(block, local):
        local = local.copy()
        local[:, 0] = 1.0 - local[:, 0]
    return (_cells(block)[:, None] + local[None]) / np.array(block.counts)


def _cells(block: Block) -> np.ndarray:
    """Indices (e, d) of the elements of a block."""
    cells = np.stack(np.meshgrid(*map(np.arange, block.counts), indexing="ij"), axis=-1)
    return cells.reshape(-1, len(block.counts))


def _is_left_handed(block: Block, local: np.ndarray) -> bool:
    """Whether the map reverses orientation."""
    corners = local[: 2 ** len(block.counts)]
    centred = corners - corners.mean(axis=0)
    positions = block.map(corners / np.array(block.counts))
    gradient = np.linalg.lstsq(centred, positions - positions.mean(axis=0), rcond=None)[0]
    return bool(np.linalg.det(gradient) < 0.0)
