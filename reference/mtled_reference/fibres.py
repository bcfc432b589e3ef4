"""Boxes, most with fibres, by FEniCSx: hexahedra with quadratic displacements and a linear pressure
in each, ψ̄(C̄) + p (J − 1) − U*(p) (Simo, Taylor and Pister, Comput. Methods Appl. Mech. Eng. 51,
177, 1985), which is ψ̄(C̄) + U(J) for a pressure that is free at each point: U = K/2 (J − 1)² with
U* = p²/2K, or the volumetric energy `simo_taylor`, K/4 (J² − 1 − 2 ln J)."""

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
from .shared.errors import NotConverged
from .shared.resources import processor_time
from .shared.selection import selected

CELL = "hexahedron"
QUADRATURE = 5
"""Degree to which the energy is integrated [–]."""
STEPS = 8
"""Parts of the load, unless Newton's method asks for smaller ones."""
SMALLEST_STEP = 1.0 / 256.0
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
    fibre = _direction(material.get("fibres", {"direction": [1.0, 0.0, 0.0]}), x)
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


def _neo_hookean(constants: dict, C):
    return 0.5 * constants["shear_modulus"] * (ufl.tr(C) - 3)


def _demiray(constants: dict, C):
    mu, b = constants["mu"], constants["b"]
    return mu / (2 * b) * (ufl.exp(b * (ufl.tr(C) - 3)) - 1)


def _yeoh(constants: dict, C):
    first = ufl.tr(C) - 3
    return sum(constants[f"C{power}"] * first**power for power in (1, 2, 3))


LAWS: dict[str, Callable] = {
    "demiray": _demiray,
    "guccione": _guccione,
    "holzapfel_gasser_ogden": _holzapfel_gasser_ogden,
    "holzapfel_ogden": _holzapfel_ogden,
    "neo_hookean_isochoric": _neo_hookean,
    "yeoh": _yeoh,
}


def _volumetric(material: dict, J, p):
    """The part of the energy with the pressure `p`, and U for the J that belongs to it."""
    bulk_modulus = material["bulk_modulus"]
    if material.get("volumetric") == "simo_taylor":
        theta = p / bulk_modulus + ufl.sqrt(1 + (p / bulk_modulus) ** 2)
        stored = 0.25 * bulk_modulus * (theta**2 - 1 - 2 * ufl.ln(theta))
        return p * (J - theta) + stored, stored
    stored = p**2 / (2 * bulk_modulus)
    return p * (J - 1) - stored, stored


class Model:
    """A case on a mesh of hexahedra: the residual of displacements and pressures. Pressures on
    faces follow them, tractions do not; `active` is a stress [Pa] along the fibres, second
    Piola–Kirchhoff, that grows with the load. Subclasses have other kinematics."""

    three_fields = True
    cell = CELL

    def __init__(self, case: dict, domain, frame: Callable | None = None, active: float = 0.0):
        self.domain = domain
        element = [versions.vector_element(self.cell, 2, 3)]
        element.append(versions.discontinuous_element(self.cell))
        self.space = versions.function_space(self.domain, versions.mixed_element(element))
        self.unknown = fem.Function(self.space)
        self.u_space, dofs = self.space.sub(0).collapse()
        self.fields = np.asarray(dofs, dtype=np.int32).reshape(-1, 3)
        self.points = self.positions(self.u_space.tabulate_dof_coordinates())
        self.loads = []
        material = next(iter(case["material"].values()))
        axes = frame(domain) if frame else _frame(material, ufl.SpatialCoordinate(domain))
        self._make_forms(case, material, axes, active)

    def _make_forms(self, case: dict, material: dict, axes, active: float) -> None:
        dx = ufl.Measure("dx", self.domain, metadata={"quadrature_degree": QUADRATURE})
        u, p = ufl.split(self.unknown)
        F, volume = self.gradient(u), self.volume_factor()
        J = ufl.det(F)
        Q = ufl.as_matrix([[axis[i] for i in range(3)] for axis in axes]).T
        C = Q.T * (J ** (-2.0 / 3.0) * F.T * F) * Q
        shape = LAWS[material["law"]](material.get("constants", material), C)
        mixed, stored = _volumetric(material, J, p)
        energy = shape + mixed
        if active:
            along = F * axes[0]
            energy += 0.5 * self._load(active) * (ufl.inner(along, along) - 1)
        residual = ufl.derivative(energy * volume * dx, self.unknown)
        v, _ = ufl.TestFunctions(self.space)
        v, normal = self.virtual(v, u), self.normal()
        for row in case.get("pressure", []):
            force = self._load(row["pressure"]) * J * ufl.dot(ufl.inv(F).T, normal)
            residual += ufl.inner(force, v) * volume * self._on(row["where"])
        for row in case.get("traction", []):
            size = self._load(1.0)
            force = ufl.as_vector([size * float(part) for part in row["traction"]])
            residual -= ufl.inner(force, v) * volume * self._on(row["where"])
        self.residual_form = versions.form(residual)
        self.jacobian_form = versions.form(ufl.derivative(residual, self.unknown))
        self.energy_form = versions.form((shape + stored) * volume * dx)

    def gradient(self, u):
        """F."""
        return ufl.Identity(3) + ufl.grad(u)

    def volume_factor(self):
        """dV/dx, which is also dA/ds."""
        return 1.0

    def virtual(self, v, u):
        """The virtual displacements of a test function."""
        return v

    def normal(self):
        """The normal of facets."""
        return ufl.FacetNormal(self.domain)

    def positions(self, points: np.ndarray) -> np.ndarray:
        """Positions (n, 3) [m] of points (n, 3) of the mesh."""
        return points

    def _load(self, value: float):
        """A load that grows to the value."""
        load = fem.Constant(self.domain, 0.0)
        self.loads.append((load, value))
        return load

    def _on(self, where: dict):
        """The measure of the facets of a selection."""

        def on(x):
            return selected(where, self.positions(x.T), ON_PLANE)

        size = self.domain.topology.dim - 1
        facets = mesh.locate_entities_boundary(self.domain, size, on)
        tags = mesh.meshtags(self.domain, size, np.sort(facets), np.ones(len(facets), np.int32))
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


def box_mesh(case: dict, size: float):
    """The box of a case in cells of about `size` [m]."""
    low, high = (np.asarray(case["geometry"]["shape"]["box"][end]) for end in ("min", "max"))
    counts = tuple(max(1, round(length / size)) for length in high - low)
    points, cells = mesh_of_blocks(box(low, high, counts), CELL)
    return versions.create_mesh(CELL, 2, points, cells)


def equilibrium(model: Model, case: dict, steps: int = STEPS) -> np.ndarray:
    """Loads a body in steps, halved where Newton's method fails; returns the residual
    (nodes, 3) [N], which is the reaction at supports."""
    newton = Newton(model)
    unknown = model.unknown.x.array
    reached, step = 0.0, 1.0 / steps
    while reached < 1.0 - 1e-9:
        fraction = min(1.0, reached + step)
        for load, value in model.loads:
            load.value = fraction * value
        fixed, values = model.prescribed(case, fraction)
        start = unknown.copy()
        try:
            residual = newton.solve(fixed, values, np.zeros((len(model.points), 3)))
        except NotConverged:
            unknown[:] = start
            step *= 0.5
            if step < SMALLEST_STEP:
                raise
            continue
        reached = fraction
    return residual


def answers_of(model: Model, case: dict, residual: np.ndarray) -> dict[str, float]:
    """Displacements of probes [m], forces [N] and the strain energy [J]."""
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


def seconds_apart_from_compiling() -> float:
    """Processor time [s] of this process so far, without that of compiling forms."""
    return processor_time() - versions.compile_seconds()


def solve(case: dict, size: float, steps: int = STEPS) -> dict[str, float]:
    """Answers of a case on cells of about `size` [m], loaded in steps."""
    model = Model(case, box_mesh(case, size))
    return answers_of(model, case, equilibrium(model, case, steps))


def solve_on_meshes(path: Path, sizes: list[float], out: Path, steps: int = STEPS) -> None:
    """Writes the answers on meshes of falling size, with packages."""
    case = tomllib.loads(path.read_text())
    meshes = []
    for size in sizes:
        start = seconds_apart_from_compiling()
        answers = solve(case, size, steps)
        cpu = round(seconds_apart_from_compiling() - start, 2)
        meshes.append({"size_m": size, "cpu_s": cpu, "answers": answers})
        print(json.dumps(meshes[-1]), flush=True)
    result = {"problem": path.stem, "packages": versions.packages(), "meshes": meshes}
    out.write_text(json.dumps(result, indent=1) + "\n")
