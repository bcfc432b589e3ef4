"""Order-2 hexahedra and quadrilaterals in blocks, as scikit-fem meshes.

A block is a smooth map of the unit cube (or square) to space, divided evenly.
Blocks are glued where their corners meet. Nodes on edges, faces and inside lie
on the map, so curved boundaries are followed to order 2.
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


def _element_nodes(block: Block, local: np.ndarray) -> np.ndarray:
    """Positions (e, a, d) of the nodes of the elements of a block."""
    counts = np.array(block.counts)
    cells = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
    cells = cells.reshape(-1, len(counts))
    reference = (cells[:, None] + local[None]) / counts
    positions = block.map(reference.reshape(-1, len(counts))).reshape(reference.shape)
    corners = positions[:, : 2 ** len(counts)]
    if _handedness(corners, local[: 2 ** len(counts)]) < 0.0:
        flipped = local.copy()
        flipped[:, 0] = 1.0 - flipped[:, 0]
        reference = (cells[:, None] + flipped[None]) / counts
        positions = block.map(reference.reshape(-1, len(counts))).reshape(reference.shape)
    return positions


def _handedness(corners: np.ndarray, local: np.ndarray) -> float:
    """Sign of the determinant of the mean gradient of the first element."""
    centred = local - local.mean(axis=0)
    gradient = np.linalg.lstsq(centred, corners[0] - corners[0].mean(axis=0), rcond=None)[0]
    return float(np.sign(np.linalg.det(gradient)))
