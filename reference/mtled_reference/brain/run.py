"""The run of the brain slice and the values that are recorded, with either code."""

from dataclasses import dataclass

import numpy as np

from ..shared.case import Case
from ..shared.measurements import Measurements, recorded_times, resultant
from .body import Body, Skull
from .contact import Wall
from .motion import Motion

INSTANTS = 20
"""Instants of the history, equally spaced, the last at the end."""
PENALTY = 1e8
"""Penalty ε of the contact [Pa/m]."""
STEPS = (4, 6, 9)
"""Time steps between two instants, by level."""
TIME_SCHEME = (
    "TR-BDF2, of second order; contact by penalty ε = 1e8 Pa/m at four Gauss points per edge; "
    "after the release two short steps of backward Euler"
)
SOLVER = "Newton, residual 1e-7 of the forces, matrix kept while it serves"


@dataclass(frozen=True)
class Outline:
    """The nodes of a mesh along the outline with their coordinates and the geometry of the
    edges, as in `Wall`, and the nodes in the craniotomy."""

    nodes: np.ndarray
    places: np.ndarray
    geometry: np.ndarray
    constrained: np.ndarray


def solved_mesh(case: Case, body: Body, elements, outline: Outline, level: int, progress) -> dict:
    """Instants [s] and what is stored of the mesh. On the coarsest mesh there are two more
    runs, with a third of the penalty and with half the time step; the largest change of the
    displacements is stored as `penalty_effect_m` and `time_step_effect_m`."""
    runs = 4 if level == 0 else 1

    def report(fraction, message):
        progress(fraction / runs, message)

    history = run(case, body, elements, outline, STEPS[level], report)
    mesh = {
        "unknowns": int(elements.mass.shape[0]),
        "time_step_s": history.times[0] / STEPS[level],
        "load_steps": STEPS[level] * INSTANTS,
        "newton_iterations": history.newton_iterations,
        "penalty_pa_per_m": PENALTY,
        "penetration_m": history.penetration,
        "values": history.values,
    }
    if level == 0:

        def again(start, end, steps, penalty):
            def report(fraction, message):
                progress(start + fraction * (end - start), f"again, {message}")

            return run(case, body, elements, outline, steps, report, penalty).values

        softer = again(0.25, 0.5, STEPS[0], PENALTY / 3.0)
        finer = again(0.5, 1.0, 2 * STEPS[0], PENALTY)
        mesh["penalty_effect_m"] = _largest_change(history.values, softer)
        mesh["time_step_effect_m"] = _largest_change(history.values, finer)
    return {"times_s": history.times, "mesh": mesh}


def _largest_change(values: dict, others: dict) -> float:
    """Largest distance [m] between the displacements of two runs."""
    keys = [key for key in values if key.startswith("displacement/")]
    changes = [np.array(values[key]) - np.array(others[key]) for key in keys]
    return float(f"{max(np.linalg.norm(change, axis=1).max() for change in changes):.3g}")


@dataclass(frozen=True)
class History:
    """Instants [s], values, Newton iterations and the largest penetration [m] of a run."""

    times: list[float]
    values: dict[str, list]
    newton_iterations: int
    penetration: float


def run(
    case: Case, body: Body, elements, outline: Outline, steps: int, progress, penalty=PENALTY
) -> History:
    """Integrates the motion with `steps` time steps between two instants.

    `elements` has, beside what `Motion` needs, `positions` (n, 2) [m], `node_volumes` (of
    each region, (n,) [m³]), `centres` of the regions (m, 2) [m] and `energy(u)` [J].
    """
    (craniotomy,) = case.prescriptions
    wall = Wall(
        Skull(case, body),
        outline.nodes,
        outline.places,
        outline.geometry,
        len(elements.positions),
        case.thickness,
        penalty,
    )
    positions = case.positions(elements.positions)

    def values_at(time):
        factor = craniotomy.amplitude(time)
        return craniotomy.values(positions[outline.constrained], factor)[:, :2].ravel()

    prescribed = (2 * outline.constrained[:, None] + np.arange(2)).ravel()
    motion = Motion(elements, wall, case.time.damping, prescribed, values_at, craniotomy.release)
    values = Measurements()
    names = [region.name for region in case.regions]
    for probe in case.probes:
        values.centre(probe.name, elements.centres[names.index(probe.centre_of_mass)])
    state, penetration = motion.at_rest(), 0.0
    times = recorded_times(case, INSTANTS)
    for start, end in zip([0.0, *times], times):
        for n in range(steps):
            state = motion.step(state, start + (end - start) * (n + 1) / steps)
            penetration = max(penetration, wall.penetration(state.u))
        _record(case, elements, state, values, names)
        progress(end / case.time.end, f"{end:.2f} s of {case.time.end:g} s")
    return History(times, values.values, motion.iterations, penetration)


def _record(case, elements, state, values, names) -> None:
    u = state.u.reshape(-1, 2)
    for probe in case.probes:
        volumes = elements.node_volumes[names.index(probe.centre_of_mass)]
        values.displacement(probe.name, volumes @ u / volumes.sum())
    (craniotomy,) = case.prescriptions
    released = state.time >= craniotomy.release - 1e-9
    reactions = 0.0 * state.reactions if released else state.reactions
    force, moment = resultant(elements.positions, u, reactions.reshape(-1, 2), case.moment_about)
    values.reaction(craniotomy.name, force, moment)
    values.strain_energy(elements.energy(state.u))
    values.kinetic_energy(0.5 * state.v @ (elements.mass @ state.v))
