"""A case file (TOML) read into plain records. SI units."""

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .formula import evaluated
from .materials import Material, material_from_table

Triple = tuple[float, float, float]

NOT_SOLVED = ("initial_velocity", "spring", "cavity")
"""Tables of a case file that the references leave to the meshless solver."""


@dataclass(frozen=True)
class Amplitude:
    """A factor over time: constant, linear, smooth or a table of rows."""

    kind: str = "constant"
    duration: float = 1.0
    rows: tuple = ()

    def __call__(self, t: float) -> float:
        """The factor at time t [s] (smooth: 10s³ − 15s⁴ + 6s⁵, s = t/duration)."""
        if self.kind == "constant":
            return 1.0
        if self.kind == "table":
            times, factors = zip(*self.rows)
            return float(np.interp(t, times, factors))
        s = min(max(t / self.duration, 0.0), 1.0)
        return s if self.kind == "linear" else s**3 * (10.0 - 15.0 * s + 6.0 * s * s)


@dataclass(frozen=True)
class Rotation:
    """A rotation by `angle` [rad] about an axis through `point` [m]."""

    point: Triple
    axis: Triple
    angle: float

    def displacements(self, positions: np.ndarray, factor: float) -> np.ndarray:
        """Displacements [m] of positions (n, 3) at `factor` times the angle."""
        arm = positions - np.asarray(self.point)
        axis = np.asarray(self.axis) / np.linalg.norm(self.axis)
        sine, cosine = np.sin(factor * self.angle), np.cos(factor * self.angle)
        along = np.outer(arm @ axis, axis)
        return (cosine - 1.0) * (arm - along) + sine * np.cross(axis, arm)


@dataclass(frozen=True)
class Prescription:
    """A prescribed displacement [m], rotation or formula of the position, until `release`
    [s]. A formula is three texts and a factor."""

    name: str
    of: str
    selector: object
    displacement: tuple
    rotation: Rotation | None
    amplitude: Amplitude
    release: float
    formula: tuple | None = field(default=None, kw_only=True)

    def components(self, dimension: int) -> list[int]:
        """Indices of the prescribed components."""
        if self.rotation is not None or self.formula is not None:
            return list(range(dimension))
        return [i for i in range(dimension) if self.displacement[i] is not None]

    def values(self, positions: np.ndarray, factor: float) -> np.ndarray:
        """Displacements [m] of positions (n, 3) when the amplitude is `factor`;
        0 in components that are free."""
        if self.rotation is not None:
            return self.rotation.displacements(positions, factor)
        if self.formula is not None:
            *texts, scale = self.formula
            return factor * scale * np.stack([evaluated(t, positions) for t in texts], axis=1)
        full = np.array([component or 0.0 for component in self.displacement])
        return np.tile(factor * full, (len(positions), 1))


@dataclass(frozen=True)
class Region:
    """A part of the body with one material. Where regions overlap the first one counts."""

    name: str
    selector: object
    material: Material


@dataclass(frozen=True)
class BodyForce:
    """A force per mass [m/s²] on a part of the body."""

    acceleration: Triple
    amplitude: Amplitude
    selector: object = field(default="all", kw_only=True)


@dataclass(frozen=True)
class Traction:
    """A dead force per reference area [Pa] on a part of the boundary."""

    name: str
    selector: object
    traction: Triple
    amplitude: Amplitude


@dataclass(frozen=True)
class Pressure:
    """A pressure [Pa] that follows a part of the boundary."""

    name: str
    selector: object
    pressure: float
    amplitude: Amplitude


@dataclass(frozen=True)
class Obstacle:
    """A rigid obstacle: a shape grown by `offset` [m]."""

    name: str
    shape: dict
    offset: float
    side: str
    friction: str


@dataclass(frozen=True)
class Time:
    """Method (static or dynamic), end of the motion or of loading [s], damping [1/s]."""

    method: str
    end: float
    load_end: float
    damping: float


@dataclass(frozen=True)
class Probe:
    """Where displacements are recorded: reference positions (n, 3) [m], or the
    centre of mass of a region."""

    name: str
    positions: np.ndarray | None
    centre_of_mass: str | None


@dataclass(frozen=True)
class Case:
    """One problem as its file states it."""

    name: str
    folder: Path
    document: dict
    dimension: int
    thickness: float
    plane_z: float
    shape: dict
    regions: list[Region]
    prescriptions: list[Prescription]
    body_forces: list[BodyForce]
    tractions: list[Traction]
    pressures: list[Pressure]
    obstacles: list[Obstacle]
    time: Time
    probes: list[Probe]
    moment_about: np.ndarray

    @property
    def is_static(self) -> bool:
        return self.time.method == "static"

    def positions(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the slice or (n, 3) as positions (n, 3) in space [m]."""
        points = np.asarray(points, dtype=float)
        if points.shape[-1] == 3:
            return points
        z = np.full(points.shape[:-1] + (1,), self.plane_z)
        return np.concatenate([points, z], axis=-1)

    def uniform_body_forces(self) -> list[BodyForce]:
        """The body forces, each of which acts on the whole body."""
        if any(force.selector != "all" for force in self.body_forces):
            raise ValueError("a body force on a part of the body is not solved here")
        return self.body_forces


def read_case(path: str | Path) -> Case:
    """The case in the TOML file at `path`."""
    path = Path(path)
    with path.open("rb") as file:
        return case_of(tomllib.load(file), path.stem, path.parent)


def case_of(document: dict, name: str, folder: Path = Path(".")) -> Case:
    """The case of tables; names of other files count from `folder`."""
    for key in NOT_SOLVED:
        if document.get(key):
            raise ValueError(f"{key} is not solved by the references")
    plane = document.get("plane", {})
    plane_strain = document.get("dimension", "3d") == "plane_strain"
    about = document.get("output", {}).get("moment_about", [0.0, 0.0, 0.0])
    if any(row.get("motion") for row in document.get("obstacle", [])):
        raise ValueError("obstacles that move are not solved by the references")
    for table in ("body_force", "traction"):
        if any("formula" in row for row in document.get(table, [])):
            raise ValueError(f"{table}: formulas are not solved by the references")
    return Case(
        name=name,
        folder=folder,
        document=document,
        dimension=2 if plane_strain else 3,
        thickness=float(plane["thickness"]) if plane_strain else 1.0,
        plane_z=float(plane.get("z", 0.0)),
        shape=document["geometry"]["shape"],
        regions=_regions(document),
        prescriptions=[_prescription(row) for row in document.get("prescribe", [])],
        body_forces=[
            BodyForce(tuple(row["acceleration"]), _amplitude(row), selector=row.get("where", "all"))
            for row in document.get("body_force", [])
        ],
        tractions=[
            Traction(row["name"], row["where"], tuple(row["traction"]), _amplitude(row))
            for row in document.get("traction", [])
        ],
        pressures=[
            Pressure(row["name"], row["where"], float(row["pressure"]), _amplitude(row))
            for row in document.get("pressure", [])
        ],
        obstacles=[_obstacle(row) for row in document.get("obstacle", [])],
        time=_time(document["time"]),
        probes=[_probe(row) for row in document.get("probe", [])],
        moment_about=np.array(about, dtype=float),
    )


def _regions(document: dict) -> list[Region]:
    materials = {
        name: material_from_table(name, table) for name, table in document["material"].items()
    }
    rows = document.get("region", [])
    if not rows:
        (material,) = materials.values()
        return [Region("body", "all", material)]
    return [Region(row["name"], row["where"], materials[row["material"]]) for row in rows]


def _amplitude(row: dict) -> Amplitude:
    amplitude = row.get("amplitude", "constant")
    if amplitude == "constant":
        return Amplitude()
    ((kind, content),) = amplitude.items()
    if kind == "table":
        return Amplitude("table", rows=tuple(map(tuple, content)))
    return Amplitude(kind, duration=float(content["duration"]))


def _prescription(row: dict) -> Prescription:
    if "data" in row:
        raise ValueError(f"prescribe.{row['name']}: data is not solved by the references")
    formula = row.get("formula")
    displacement = row.get("displacement", {})
    rotation = row.get("rotation")
    return Prescription(
        name=row["name"],
        of=row["of"],
        selector=row["where"],
        displacement=tuple(displacement.get(axis) for axis in "xyz"),
        rotation=Rotation(tuple(rotation["point"]), tuple(rotation["axis"]), rotation["angle"])
        if rotation
        else None,
        amplitude=_amplitude(row),
        release=float(row.get("release", np.inf)),
        formula=(*(formula.get(k, "0") for k in "xyz"), float(formula.get("factor", 1.0)))
        if formula
        else None,
    )


def _obstacle(row: dict) -> Obstacle:
    return Obstacle(
        row["name"],
        row["shape"],
        float(row.get("offset", 0.0)),
        row.get("side", "outside"),
        row.get("friction", "frictionless"),
    )


def _time(table: dict) -> Time:
    return Time(
        table["method"],
        float(table.get("end", 0.0)),
        float(table.get("load_end", 1.0)),
        float(table.get("damping", 0.0)),
    )


def _probe(row: dict) -> Probe:
    if "centre_of_mass" in row:
        return Probe(row["name"], None, row["centre_of_mass"])
    if "point" in row:
        return Probe(row["name"], np.array([row["point"]], dtype=float), None)
    lattice = row["lattice"]
    axes = [
        np.linspace(low, high, count)
        for low, high, count in zip(lattice["min"], lattice["max"], lattice["counts"])
    ]
    return Probe(row["name"], lattice_positions(*axes), None)


def lattice_positions(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Positions (n, 3) of all combinations of the coordinates, x varying fastest."""
    z, y, x = np.meshgrid(z, y, x, indexing="ij")
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()])
