"""Boxes with fibres by FEniCSx: hexahedra with quadratic displacements and a linear pressure in
each, ψ̄(C̄) + p (J − 1) − p²/2K (Simo, Taylor and Pister, Comput. Methods Appl. Mech. Eng. 51, 177,
1985), which is ψ̄(C̄) + K/2 (J − 1)² for a pressure that is free at each point."""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import ufl
from dolfinx import fem, mesh

from .fenicsx import versions
from .fenicsx.mesh_blocks import mesh_of_blocks
from .fenicsx.mesh_shapes import box
from .fenicsx.newton import Newton
from .shared.selection import selected

CELL = "hexahedron"
QUADRATURE = 5
"""Degree to which the energy is integrated [–]."""
STEPS = 8
"""Parts of the load."""
ON_PLANE = 1e-9
"""Distance from a plane [m] within which a point lies on it."""


def _direction(table: dict, x):
    """The direction of a `fibres` or `sheets` table at the coordinates `x`."""
    if "direction" in table:
        return ufl.as_vector([float(part) for part in table["direction"]])
    names = {"x": x[0], "y": x[1], "z": x[2], "PI": np.pi}
    names |= {name: getattr(ufl, name) for name in ("sin", "cos", "sqrt", "exp", "ln", "atan")}
    parts = [table["formula"][axis].replace("^", "**") for axis in "xyz"]
    # Formulas of the files in this repository.
    return ufl.as_vector([eval(part, {"__builtins__": {}}, names) for part in parts])


def _frame(material: dict, x):
    """Directions of fibres, of sheets normal to them, and normal to both."""
    fibre = _direction(material["fibres"], x)
    fibre = fibre / ufl.sqrt(ufl.inner(fibre, fibre))
    # Without sheets any normals to the fibres do; no body here has fibres along z.
    sheet = _direction(material.get("sheets", {"direction": [0.0, 0.0, 1.0]}), x)
    sheet = sheet - ufl.inner(sheet, fibre) * fibre
    sheet = sheet / ufl.sqrt(ufl.inner(sheet, sheet))
    return fibre, sheet, ufl.cross(fibre, sheet)


def _guccione(constants: dict, C):
    E = 0.5 * (C - ufl.Identity(3))
    along, across, beside = constants["b_f"], constants["b_t"], constants["b_fs"]
    Q = along * E[0, 0] ** 2 + across * (E[1, 1] ** 2 + E[2, 2] ** 2 + 2 * E[1, 2] ** 2)
    Q += 2 * beside * (E[0, 1] ** 2 + E[0, 2] ** 2)
    return 0.5 * constants["C"] * (ufl.exp(Q) - 1)


def _holzapfel_ogden(constants: dict, C):
    def term(a: str, b: str, x):
        return constants[a] / (2 * constants[b]) * (ufl.exp(constants[b] * x) - 1)

    def stretched(square):
        return ufl.conditional(ufl.gt(square, 1.0), (square - 1.0) ** 2, 0.0)

    energy = term("a", "b", ufl.tr(C) - 3) + term("a_f", "b_f", stretched(C[0, 0]))
    if "a_s" in constants:
        energy += term("a_s", "b_s", stretched(C[1, 1]))
    if "a_fs" in constants:
        energy += term("a_fs", "b_fs", C[0, 1] ** 2)
    return energy


def _holzapfel_gasser_ogden(constants: dict, C):
    kappa, angle = constants.get("kappa", 0.0), constants.get("angle", 0.0)
    first = ufl.tr(C) - 3
    energy = 0.5 * constants["mu"] * first
    for sign in (1.0, -1.0):
        along = [np.cos(angle), sign * np.sin(angle)]
        square = sum(along[i] * along[j] * C[i, j] for i in (0, 1) for j in (0, 1))
        strain = kappa * first + (1 - 3 * kappa) * (square - 1)
        carried = ufl.conditional(ufl.gt(strain, 0.0), strain**2, 0.0)
        k1, k2 = constants["k1"], constants["k2"]
        energy += k1 / (2 * k2) * (ufl.exp(k2 * carried) - 1)
    return energy


LAWS: dict[str, Callable] = {
    "guccione": _guccione,
    "holzapfel_gasser_ogden": _holzapfel_gasser_ogden,
    "holzapfel_ogden": _holzapfel_ogden,
}


class _Model:
    """A case on a mesh of cells of about `size` [m]: the residual of displacements and pressures,
    with pressures on faces that follow them."""

    three_fields = True

    def __init__(self, case: dict, size: float):
        low, high = (np.asarray(case["geometry"]["shape"]["box"][end]) for end in ("min", "max"))
        counts = tuple(max(1, round(length / size)) for length in high - low)
        points, cells = mesh_of_blocks(box(low, high, counts), CELL)
        self.domain = versions.create_mesh(CELL, 2, points, cells)
        element = [versions.vector_element(CELL, 2, 3), versions.discontinuous_element(CELL)]
        self.space = versions.function_space(self.domain, versions.mixed_element(element))
        self.unknown = fem.Function(self.space)
        self.u_space, dofs = self.space.sub(0).collapse()
        self.fields = np.asarray(dofs, dtype=np.int32).reshape(-1, 3)
        self.points = self.u_space.tabulate_dof_coordinates()
        self.loads = []
        self._make_forms(case)

    def _make_forms(self, case: dict) -> None:
        material = next(iter(case["material"].values()))
        dx = ufl.Measure("dx", self.domain, metadata={"quadrature_degree": QUADRATURE})
        u, p = ufl.split(self.unknown)
        F = ufl.Identity(3) + ufl.grad(u)
        J = ufl.det(F)
        x = ufl.SpatialCoordinate(self.domain)
        Q = ufl.as_matrix([[axis[i] for i in range(3)] for axis in _frame(material, x)]).T
        C = Q.T * (J ** (-2.0 / 3.0) * F.T * F) * Q
        shape = LAWS[material["law"]](material["constants"], C)
        bulk_modulus = material["bulk_modulus"]
        energy = (shape + p * (J - 1) - p**2 / (2 * bulk_modulus)) * dx
        residual = ufl.derivative(energy, self.unknown)
        v, _ = ufl.TestFunctions(self.space)
        normal = ufl.FacetNormal(self.domain)
        for row in case.get("pressure", []):
            load = fem.Constant(self.domain, 0.0)
            self.loads.append((load, row["pressure"]))
            force = J * ufl.dot(ufl.inv(F).T, normal)
            residual += load * ufl.inner(force, v) * self._on(row["where"])
        self.residual_form = versions.form(residual)
        self.jacobian_form = versions.form(ufl.derivative(residual, self.unknown))
        self.energy_form = versions.form((shape + p**2 / (2 * bulk_modulus)) * dx)

    def _on(self, where: dict):
        """The measure of the facets of a selection."""

        def on(x):
            return selected(where, x.T, ON_PLANE)

        facets = mesh.locate_entities_boundary(self.domain, 2, on)
        tags = mesh.meshtags(self.domain, 2, np.sort(facets), np.ones(len(facets), np.int32))
        metadata = {"quadrature_degree": QUADRATURE}
        return ufl.Measure("ds", self.domain, subdomain_data=tags, metadata=metadata)(1)

    def prescribed(self, case: dict, fraction: float) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns with their values."""
        fixed: dict[int, float] = {}
        for row in case["prescribe"]:
            nodes = np.flatnonzero(selected(row["where"], self.points, ON_PLANE))
            for axis, value in row["displacement"].items():
                for node in nodes:
                    fixed[int(self.fields[node]["xyz".index(axis)])] = fraction * value
        return np.array(list(fixed), np.int32), np.array(list(fixed.values()))

    def displacement(self, point) -> np.ndarray:
        """u [m] at a reference position [m]."""
        nearest = int(np.argmin(np.linalg.norm(self.points - point, axis=1)))
        if np.linalg.norm(self.points[nearest] - point) > ON_PLANE:
            raise ValueError(f"no node lies at {point}")
        return self.unknown.x.array[self.fields[nearest]]


def solve(case: dict, size: float) -> dict[str, float]:
    """Answers of a case on cells of about `size` [m]: displacements of probes [m], forces [N] and
    the strain energy [J]."""
    model = _Model(case, size)
    newton = Newton(model)
    for step in range(1, STEPS + 1):
        fraction = step / STEPS
        for load, value in model.loads:
            load.value = fraction * value
        fixed, values = model.prescribed(case, fraction)
        residual = newton.solve(fixed, values, np.zeros((len(model.points), 3)))
    answers = {}
    for probe in case["probe"]:
        for axis, value in zip("xyz", model.displacement(np.asarray(probe["point"]))):
            answers[f"displacement/{probe['name']}/{axis}"] = float(value)
    for row in case["prescribe"]:
        force = residual[selected(row["where"], model.points, ON_PLANE)].sum(axis=0)
        for axis in row["displacement"]:
            answers[f"force/{row['name']}/{axis}"] = float(force["xyz".index(axis)])
    answers["strain_energy"] = float(fem.assemble_scalar(model.energy_form))
    return answers


def solve_on_meshes(path: Path, sizes: list[float], out: Path) -> None:
    """Writes the answers on meshes of falling size, with packages."""
    case = tomllib.loads(path.read_text())
    meshes = []
    for size in sizes:
        meshes.append({"size_m": size, "answers": solve(case, size)})
        print(json.dumps(meshes[-1]), flush=True)
    result = {"problem": path.stem, "packages": versions.packages(), "meshes": meshes}
    out.write_text(json.dumps(result, indent=1) + "\n")
