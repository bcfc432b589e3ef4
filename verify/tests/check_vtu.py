#!/usr/bin/env python3
"""Loads every .vtu and .pvd of a folder with PyVista and meshio and checks the
fields that the solver promises. Usage: check_vtu.py FOLDER"""

import sys
from pathlib import Path

import meshio
import numpy as np
import pyvista

SHAPES = {"displacement": (3,), "J": (), "cauchy_stress": (9,)}


def check(path, reader, points, data):
    assert len(points) > 0, f"{path}: {reader} finds no points"
    assert np.isfinite(points).all(), f"{path}: {reader} reads points that are not finite"
    for name, shape in SHAPES.items():
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


def main(folder):
    frames = sorted(folder.glob("*.vtu"))
    collections = sorted(folder.glob("*.pvd"))
    assert frames, f"no .vtu in {folder}"
    assert collections, f"no .pvd in {folder}"
    for path in frames:
        mesh = pyvista.read(path)
        check(path, "pyvista", mesh.points, mesh.point_data)
        assert mesh.n_cells == mesh.n_points, f"{path}: points without a vertex cell"
        check_progress(path, mesh.field_data)
        other = meshio.read(path)
        check(path, "meshio", other.points, other.point_data)
        assert np.array_equal(mesh.points, other.points), f"{path}: the readers disagree"
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
