"""Meshes of order 2 from blocks: maps of the unit square or cube into the body.

A block is covered by a lattice with two intervals per cell, so that midpoints
lie on the body's curved surfaces. Blocks that share a face must have the same
directions along it; then their simplices match too.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import basix
import numpy as np

MERGED = 1e-8
"""Points closer than this over the size of the body [–] are merged."""


@dataclass
class Block:
    """`map` takes coordinates (n, d) in [0, 1] to points (n, d) [m]; `counts` is the
    number of cells along each coordinate."""

    map: Callable[[np.ndarray], np.ndarray]
    counts: tuple[int, ...]


def mesh_of_blocks(blocks: list[Block], cell: str) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, d) [m] and cells of order 2, in the order of Basix."""
    template = _template(cell, len(blocks[0].counts))
    points, cells, start = [], [], 0
    for block in blocks:
        lattice, numbers = _lattice(block)
        points.append(lattice)
        cells.append(start + _cells(numbers, template))
        start += len(lattice)
    points, cells = np.concatenate(points), np.concatenate(cells)
    tolerance = MERGED * np.ptp(points, axis=0).max()
    _, first, merged = np.unique(
        np.round(points / tolerance).astype(np.int64),
        axis=0,
        return_index=True,
        return_inverse=True,
    )
    cells = np.ravel(merged)[cells]
    used, cells = np.unique(cells, return_inverse=True)
    return points[first[used]], np.reshape(cells, (-1, template.shape[1]))


def _lattice(block: Block) -> tuple[np.ndarray, np.ndarray]:
    """Points of a block's lattice, and their numbers as an array over its axes."""
    shape = tuple(2 * count + 1 for count in block.counts)
    axes = np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in shape), indexing="ij")
    points = block.map(np.stack([axis.ravel() for axis in axes], axis=1))
    return points, np.arange(len(points)).reshape(shape)


def _cells(numbers: np.ndarray, template: np.ndarray) -> np.ndarray:
    """All cells of a block: the template (m, nodes, d) placed at every other lattice point."""
    corners = np.meshgrid(*(np.arange(0, n - 1, 2) for n in numbers.shape), indexing="ij")
    corners = np.stack([corner.ravel() for corner in corners], axis=1)
    nodes = corners[:, None, None, :] + template[None]
    cells = numbers[tuple(np.moveaxis(nodes, -1, 0))]
    return cells.reshape(-1, template.shape[1])


def _template(cell: str, size: int) -> np.ndarray:
    """Cells (m, nodes, d) of order 2 that fill a square or cube of two lattice intervals."""
    if cell in ("quadrilateral", "hexahedron"):
        corners = basix.geometry(getattr(basix.CellType, cell))
        return _with_midpoints(cell, 2.0 * corners)[None]
    paths = []
    for order in itertools.permutations(range(size)):
        corners = np.zeros((size + 1, size))
        for step, axis in enumerate(order):
            corners[step + 1 :, axis] = 2.0
        paths.append(_with_midpoints(cell, corners))
    return np.stack(paths)


def _with_midpoints(cell: str, corners: np.ndarray) -> np.ndarray:
    """Nodes of order 2 of a cell: its corners, then the midpoints of its edges, and for
    quadrilaterals and hexahedra also of its faces and of the cell."""
    entities = basix.topology(getattr(basix.CellType, cell))
    whole = cell in ("quadrilateral", "hexahedron")
    dimensions = range(1, len(entities)) if whole else (1,)
    middles = [corners[entity].mean(axis=0) for dim in dimensions for entity in entities[dim]]
    return np.round(np.concatenate([corners, np.array(middles)])).astype(int)
