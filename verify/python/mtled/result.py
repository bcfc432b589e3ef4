"""Results: what a run has come to."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from . import _mtled

if TYPE_CHECKING:
    import pandas
    import pyvista

Array = npt.NDArray[np.float64]
_AXES = ("x", "y", "z")


class WarpedImage:
    """An image after the deformation, on its own grid."""

    def __init__(self, core: _mtled.WarpedImage) -> None:
        self._core = core

    @property
    def voxels(self) -> np.ndarray:
        """The stored numbers by their three indices, a view on the memory of the warp."""
        return self._core.bytes.view(self._core.dtype).reshape(self._core.shape, order="F")

    @property
    def origin_m(self) -> Array:
        """Centre of the voxel (0, 0, 0) [m] along R, A and S."""
        return np.array(self._core.origin_m)

    @property
    def directions_m(self) -> Array:
        """Steps from one voxel to the next [m], a column for each index."""
        return self._core.directions_m

    @property
    def source_vectors_m(self) -> np.ndarray:
        """The vectors X − x [m] from each voxel to where it came from, (i, j, k, 3)."""
        vectors = self._core.source_vectors_m
        nx, ny, nz = self._core.shape
        return vectors.reshape(nz, ny, nx, 3).transpose(2, 1, 0, 3)

    @property
    def unconverged(self) -> int:
        """Voxels for which no place was found that moved there: the body has folded."""
        return self._core.unconverged

    @property
    def from_outside(self) -> int:
        """Voxels that came from outside of the image; they are 0."""
        return self._core.from_outside

    @property
    def nodes_outside(self) -> int:
        """Nodes of the body that lie outside of the image."""
        return self._core.nodes_outside

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the image as .nii, .nii.gz or .nrrd; NIfTI to NIfTI and NRRD to NRRD keep the header."""
        self._core.write(path)

    def write_inverse_field(self, path: str | os.PathLike[str]) -> None:
        """Writes the vectors X − x as a displacement field that ITK, SimpleITK and ANTs read."""
        self._core.write_inverse_field(path)


class Result:
    """What a run has come to. Displacements are those of the field, not nodal parameters."""

    def __init__(self, core: _mtled.Result) -> None:
        self._core = core
        self._json: dict[str, Any] | None = None

    @property
    def nodes_m(self) -> Array:
        """Reference positions of the nodes [m], (nodes, 3)."""
        return self._core.nodes_m

    @property
    def displacement_m(self) -> Array:
        """The displacement field at the nodes [m], (nodes, 3)."""
        return self._core.displacement_m

    def displacement_at(self, points_m: npt.ArrayLike) -> Array:
        """The displacement field [m] at reference positions [m] in the body, (points, 3)."""
        points = np.ascontiguousarray(np.atleast_2d(points_m), dtype=np.float64)
        return self._core.displacement_at(points)

    @property
    def json(self) -> dict[str, Any]:
        """What ``mtled solve`` writes as ``result.json``."""
        if self._json is None:
            self._json = json.loads(self._core.json())
        return self._json

    @property
    def probes(self) -> dict[str, tuple[Array, Array]]:
        """Reference positions and displacements [m] at the end by probe, (points, 3) each."""
        return {
            probe["name"]: (np.array(probe["reference_m"]), np.array(probe["displacement_m"]))
            for probe in self.json["probes"]
        }

    @property
    def reactions_n(self) -> dict[str, Array]:
        """The force that each condition exerts on the body at the end [N]."""
        return {row["condition"]: np.array(row["force_n"]) for row in self.json["reactions"]}

    @property
    def history(self) -> dict[str, Array]:
        """Samples by quantity, with the units in the names."""
        names, samples = self._core.history()
        return dict(zip(names, samples.T, strict=True))

    @property
    def warnings(self) -> list[str]:
        """Reasons to doubt the result."""
        return list(self.json["warnings"])

    @property
    def doubts(self) -> list[str]:
        """What the run has noticed by itself: what was asked that was not done, with advice."""
        rows = [row for row in self.json.get("audit", {}).get("rows", []) if row["doubtful"]]
        return [
            f"{row['label']} {row['of']}: asked {row['asked']}, done {row['done']} {row['unit']}"
            + (f"; {row['advice']}" if row.get("advice") else "")
            for row in rows
        ]

    @property
    def doubtful(self) -> bool:
        """Whether something of what was asked was not done; :attr:`doubts` says what."""
        return bool(self.doubts)

    def to_pandas(self, table: Literal["history", "probes", "reactions"] = "history") -> pandas.DataFrame:
        """The histories, or the values at the end of probes or reactions, as a data frame."""
        import pandas

        if table == "history":
            return pandas.DataFrame(self.history)
        if table == "probes":
            columns = [f"{axis}_m" for axis in _AXES] + [f"u{axis}_m" for axis in _AXES]
            rows = [
                (name, number, *place, *moved)
                for name, (places, displacements) in self.probes.items()
                for number, (place, moved) in enumerate(zip(places, displacements, strict=True))
            ]
            return pandas.DataFrame(rows, columns=["probe", "position", *columns])
        if table == "reactions":
            columns = [f"f{axis}_n" for axis in _AXES] + [f"m{axis}_n_m" for axis in _AXES]
            rows = [(row["condition"], *row["force_n"], *row["moment_n_m"]) for row in self.json["reactions"]]
            return pandas.DataFrame(rows, columns=["condition", *columns])
        raise ValueError(f'there is no table "{table}"; there are history, probes and reactions')

    def to_pyvista(self, *, deformed: bool = False) -> pyvista.UnstructuredGrid:
        """The body at the end on the mesh to look at, which was not computed on.

        Point data are displacement, J, stresses and strains, cell data the regions. ``deformed``
        puts the points where they have moved to.
        """
        import pyvista

        vertices, cells, regions, fields = self._core.mesh()
        kind = pyvista.CellType.TETRA if cells.shape[1] == 4 else pyvista.CellType.TRIANGLE
        points = vertices + fields["displacement"] if deformed else vertices
        grid = pyvista.UnstructuredGrid({kind: cells.astype(np.int64)}, points)
        for name, values in fields.items():
            grid.point_data[name] = values
        grid.cell_data["region"] = regions
        return grid

    def picture(self, path: str | os.PathLike[str] | None = None, *, field: str = "displacement") -> Picture:
        """The body before and after, coloured by a field, as SVG; written to ``path`` if that is given."""
        drawn = Picture(self._core.picture(field))
        if path is not None:
            with open(path, "w", encoding="utf-8") as file:
                file.write(drawn.svg)
        return drawn

    def warp(
        self,
        image: str | os.PathLike[str],
        *,
        labels: bool = False,
        decay_m: float | None = None,
        unit: Literal["m", "mm", "um"] | None = None,
    ) -> WarpedImage:
        """An image of the space of the case (NIfTI or NRRD) after the deformation.

        ``labels`` takes the nearest voxel instead of a linear interpolation. Outside of the body
        the displacement decays over ``decay_m``, by default three times the largest
        displacement. ``unit`` is that of the image where its file states a wrong one.
        """
        return WarpedImage(self._core.warp(image, labels, decay_m, unit))

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes the files of ``mtled solve`` to a folder: a page, VTU, CSV and JSON."""
        self._core.write(folder)

    def __str__(self) -> str:
        return self._core.text()


class Picture:
    """A picture as SVG, which notebooks show."""

    def __init__(self, svg: str) -> None:
        self.svg = svg

    def _repr_svg_(self) -> str:
        return self.svg
