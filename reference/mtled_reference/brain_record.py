"""The run of the brain slice over its instants, recorded, with either code."""

from dataclasses import dataclass

import numpy as np

from .brain_body import Body, Skull
from .brain_contact import Wall
from .brain_motion import Motion
from .case import Case
from .measure import Measurements, resultant

INSTANTS = 20
"""Instants of the history, equally spaced, the last at the end."""
PENALTY = 1e8
"""ε of the contact [Pa/m]."""
STEPS = (4, 6, 9)
"""Steps between two instants, by mesh."""
TIME_SCHEME = (
    "TR-BDF2, of second order; contact by penalty ε = 1e8 Pa/m at four Gauss points per edge; "
    "after the release two short steps of backward Euler"
)
SOLVER = "Newton, residual 1e-7 of the forces, matrix kept while it serves"


@dataclass(frozen=True)
class Outline:
    """The nodes of a code's mesh along the outline, as `Wall` wants them, and the
    nodes that the craniotomy holds."""

    nodes: np.ndarray
    places: np.ndarray
    geometry: np.ndarray
    held: np.ndarray


def solved_mesh(case: Case, body: Body, elements, outline: Outline, level: int, progress) -> dict:
    """Instants [s] and the mesh's part of the result. On the coarsest mesh the run is
    made twice more, with a third of the penalty and with steps half as long: how far
    the centres move then is kept as `penalty_effect_m` and `time_step_effect_m`."""
    runs = 4 if level == 0 else 1

    def share(fraction, message):
        progress(fraction / runs, message)

    times, values, motion = run(case, body, elements, outline, STEPS[level], share)
    mesh = {
        "unknowns": int(elements.mass.shape[0]),
        "time_step_s": times[0] / STEPS[level],
        "load_steps": STEPS[level] * INSTANTS,
        "newton_iterations": motion.iterations,
        "penalty_pa_per_m": PENALTY,
        "penetration_m": motion.deepest,
        "values": values,
    }
    if level == 0:

        def again(start, end, steps, penalty):
            def report(fraction, message):
                progress(start + fraction * (end - start), f"again, {message}")

            return run(case, body, elements, outline, steps, report, penalty)[1]

        softer = again(0.25, 0.5, STEPS[0], PENALTY / 3.0)
        finer = again(0.5, 1.0, 2 * STEPS[0], PENALTY)
        mesh["penalty_effect_m"] = _largest_change(values, softer)
        mesh["time_step_effect_m"] = _largest_change(values, finer)
    return {"times_s": times, "mesh": mesh}


def _largest_change(values: dict, others: dict) -> float:
    """Largest distance [m] between the displacements of two runs."""
    keys = [key for key in values if key.startswith("displacement/")]
    changes = [np.array(values[key]) - np.array(others[key]) for key in keys]
    return float(f"{max(np.linalg.norm(change, axis=1).max() for change in changes):.3g}")


def run(case: Case, body: Body, elements, outline: Outline, steps: int, progress, penalty=PENALTY):
    """Moves the body with `steps` steps between instants; returns the instants [s],
    the values and the motion with its counts.

    `elements` has, beside what `Motion` needs, `positions` (n, 2), `shares` (for
    each region the share of a node in its volume, [m³]), `centres` of the regions
    (m, 2) and `energy(u)` [J].
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

    def held_at(time):
        factor = craniotomy.amplitude(time)
        return craniotomy.values(positions[outline.held], factor)[:, :2].ravel()

    held = (2 * outline.held[:, None] + np.arange(2)).ravel()
    motion = Motion(elements, wall, case.time.damping, held, held_at, craniotomy.release)
    values = Measurements()
    names = [region.name for region in case.regions]
    for probe in case.probes:
        values.centre(probe.name, elements.centres[names.index(probe.centre_of_mass)])
    state = motion.at_rest()
    times = [case.time.end * (n + 1) / INSTANTS for n in range(INSTANTS)]
    for start, end in zip([0.0, *times], times):
        for n in range(steps):
            state = motion.step(state, start + (end - start) * (n + 1) / steps)
            motion.deepest = max(motion.deepest, wall.penetration(state.u))
        _record(case, elements, motion, state, values, names)
        progress(end / case.time.end, f"{end:.2f} s of {case.time.end:g} s")
    return times, values.values, motion


def _record(case, elements, motion, state, values, names) -> None:
    u = state.u.reshape(-1, 2)
    for probe in case.probes:
        share = elements.shares[names.index(probe.centre_of_mass)]
        values.displacement(probe.name, share @ u / share.sum())
    (craniotomy,) = case.prescriptions
    support = state.support if state.time < craniotomy.release - 1e-9 else 0.0 * state.support
    force, moment = resultant(elements.positions, u, support.reshape(-1, 2), case.moment_about)
    values.reaction(craniotomy.name, force, moment)
    values.strain_energy(elements.energy(state.u))
    values.kinetic_energy(0.5 * state.v @ (elements.mass @ state.v))
