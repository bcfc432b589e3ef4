#!/usr/bin/env python3
"""Loads every .vtu and .pvd of a folder with PyVista and meshio and checks the
fields that the solver promises. Usage: check_vtu.py FOLDER"""

import json
import sys
from pathlib import Path

import meshio
import numpy as np
import pyvista

SHAPES = {"displacement": (3,), "J": (), "cauchy_stress": (9,)}
# Further fields of the display mesh.
DRAWN = {
    "von_mises_stress": (),
    "pressure": (),
    "principal_green_lagrange_strain": (3,),
    "nodal_spacing": (),
    "on_boundary": (),
}
TRIANGLE, TETRAHEDRON = 5, 10


def check(path, reader, points, data, shapes=SHAPES):
    assert len(points) > 0, f"{path}: {reader} finds no points"
    assert np.isfinite(points).all(), f"{path}: {reader} reads points that are not finite"
    for name, shape in shapes.items():
        assert name in data, f"{path}: {reader} finds no {name}"
        # meshio folds nine components into 3 x 3 in some versions.
        values = np.asarray(data[name]).reshape((len(points), -1))
        components = int(np.prod(shape, dtype=int))
        assert values.shape[1] == components, f"{path}: {name} has shape {values.shape}"
        assert np.isfinite(values).all(), f"{path}: {name} is not finite"


def check_progress(path, numbers):
    """A dynamic run states its time, a static one its step and how far the load had come."""
    if "TimeValue" in numbers:
        assert np.isfinite(numbers["TimeValue"]).all(), f"{path}: no time"
    else:
        assert 0.0 <= float(numbers["load_fraction"][0]) <= 1.0, f"{path}: no load fraction"
        assert float(numbers["step"][0]) >= 0.0, f"{path}: no step"


def check_body(path, mesh, other, volume):
    """The display mesh has sound cells that fill the body, in both readers."""
    kinds = set(mesh.celltypes)
    assert kinds in ({TRIANGLE}, {TETRAHEDRON}), f"{path}: cells of the types {kinds}"
    plane = kinds == {TRIANGLE}
    measure = mesh.compute_cell_sizes()["Area" if plane else "Volume"]
    assert (measure > 0).all(), f"{path}: cells without a measure or turned inside out"
    (cells,) = [block.data for block in other.cells]
    assert len(cells) == mesh.n_cells, f"{path}: the readers disagree on the cells"
    a, b, c = (other.points[cells[:, n]] for n in range(3))
    if plane:
        own = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        volume /= float(mesh.field_data["slab_thickness_m"][0])
    else:
        own = np.einsum("ij,ij->i", np.cross(b - a, c - a), other.points[cells[:, 3]] - a) / 6
    assert np.allclose(own, measure, rtol=1e-6, atol=0), f"{path}: the readers disagree on volumes"
    assert abs(own.sum() / volume - 1) < 0.02, f"{path}: {own.sum()} of {volume}"
    regions, others = (np.ravel(r) for r in (mesh.cell_data["region"], other.cell_data["region"][0]))
    assert np.array_equal(regions, others), f"{path}: the readers disagree on regions"
    open_edges = 0 if plane else mesh.extract_surface().n_open_edges
    assert open_edges == 0, f"{path}: the boundary has {open_edges} open edges"
    used = np.unique(cells)
    assert len(used) == mesh.n_points, f"{path}: points without a cell"


def main(folder):
    result = json.loads((folder / "result.json").read_text())
    volume = result["discretisation"]["volume_m3"]
    frames = sorted(folder.glob("*.vtu"))
    bodies = [path for path in frames if path.name.startswith("body_")]
    assert len(bodies) * 2 == len(frames), f"{folder}: not as many frames of body and nodes"
    collections = sorted(folder.glob("*.pvd"))
    assert frames, f"no .vtu in {folder}"
    assert collections, f"no .pvd in {folder}"
    for path in frames:
        mesh = pyvista.read(path)
        shapes = SHAPES | DRAWN if path in bodies else SHAPES
        check(path, "pyvista", mesh.points, mesh.point_data, shapes)
        check_progress(path, mesh.field_data)
        other = meshio.read(path)
        check(path, "meshio", other.points, other.point_data, shapes)
        assert np.array_equal(mesh.points, other.points), f"{path}: the readers disagree"
        if path in bodies:
            check_body(path, mesh, other, volume)
            continue
        assert mesh.n_cells == mesh.n_points, f"{path}: points without a vertex cell"
    for path in collections:
        reader = pyvista.PVDReader(path)
        times = reader.time_values
        assert len(times) > 0, f"{path}: no frames"
        assert all(a < b for a, b in zip(times, times[1:])), f"{path}: times do not grow"
        for time in times:
            reader.set_active_time_value(time)
            block = reader.read()[0]
            check(path, "pyvista", block.points, block.point_data)
            if "TimeValue" in block.field_data:
                stated = float(block.field_data["TimeValue"][0])
                assert stated == time, f"{path}: frame at {time} s says {stated} s"
    print(f"{folder}: {len(frames)} frames, {len(collections)} collections, all fields sound")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
