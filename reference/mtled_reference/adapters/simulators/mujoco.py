"""Solves a job with MuJoCo: python -m mtled_reference.adapters.simulators.mujoco JOB ANSWER

MuJoCo 4.0.0, pip install mujoco; meshes of bodies other than boxes need pip install netgen-mesher.
Bodies in 3-D, at rest or in motion, in the idiom of the simulator: point masses at the nodes of a
mesh, tied by flexes of linear tetrahedra, six in each cell of an even grid in boxes. What is
prescribed has no joint and is moved with the frame of its body; loads are forces on the bodies.

The material is MuJoCo's, with the E and ν of the job at small strain: for a law of St. Venant and
Kirchhoff its own, and for every other law the only other one that it has, `elastic3d = 1`, the
simplified stable neo-Hookean energy (Smith, De Goes and Kim, ACM Trans. Graph. 37, 12, 2018).
The integrator is `discrete`, the only one that is implicit in positions. A body at rest is found as
in `rest.py`. Reactions are not told. Refused is damping, which flexes have in another form only.
"""

import mujoco
import numpy as np

from ..cases import read_without_contact
from ..files import Refused, answer
from ..nodal import Nodal
from .rest import at_rest

STEPS_PER_WAVE = (32, 128, 512)
"""Steps in the time of a shear wave through the body, tried in turn where MuJoCo's linear solver
does not end; in the double loads and supports of a body at rest grow."""
WAVES = 200
AT_REST = 1e-9
"""Change of the displacements in a step, over the largest one [–]."""
STEPS_PER_INSTANT = 4
"""In motion, at the coarsest level; twice as many at the next but one."""


class Flexes:
    """The model and its state. `u` are displacements (n, 3) [m]."""

    def __init__(self, nodal: Nodal, time_step: float):
        self.nodal = nodal
        spec = mujoco.MjSpec.from_string(_scene(nodal, time_step))
        for flex, region in zip(spec.flexes, nodal.case.regions):
            flex.elastic3d = int(region.material.law != "st_venant_kirchhoff")
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.frames = self.model.body_pos[1:].copy()

    def step(self, t: float, scale: float) -> None:
        """A step to time t [s] with loads and supports times `scale`."""
        self.model.body_pos[1:] = self.frames + self.nodal.prescribed(t, scale)
        self.data.xfrc_applied[1:, :3] = scale * self.nodal.loads(t)
        mujoco.mj_step(self.model, self.data)
        mujoco.mj_kinematics(self.model, self.data)
        if not np.isfinite(self.data.qpos).all() or any(w.number for w in self.data.warning):
            raise Refused("MuJoCo warns of an unstable simulation", "not_converged")

    @property
    def u(self) -> np.ndarray:
        return self.data.xpos[1:] - self.frames


def _scene(nodal: Nodal, time_step: float) -> str:
    """MuJoCo's scene."""
    rows = []
    if nodal.case.time.damping:
        raise Refused("damping")
    for number, (point, mass) in enumerate(zip(nodal.points, nodal.masses().tolist())):
        free = np.flatnonzero(~nodal.fixed[number])
        joints = "".join(f'<joint type="slide" axis="{_words(np.eye(3)[k])}"/>' for k in free)
        inertial = f'<inertial pos="0 0 0" mass="{mass!r}" diaginertia="1 1 1"/>'
        rows.append(f'<body name="{number}" pos="{_words(point)}">{inertial}{joints}</body>')
    flexes = []
    for number, region in enumerate(nodal.case.regions):
        cells = nodal.cells[nodal.owners == number]
        nodes, elements = np.unique(cells, return_inverse=True)
        material = region.material
        flexes.append(
            f'<flex name="{number}" dim="3" radius="1e-6" body="{_words(nodes)}" '
            f'element="{_words(elements.ravel())}"><elasticity '
            f'young="{material.young_modulus!r}" poisson="{material.poisson_ratio!r}"/>'
            '<contact contype="0" conaffinity="0" selfcollide="none"/></flex>'
        )
    return (
        f'<mujoco><option timestep="{float(time_step)!r}" gravity="0 0 0" integrator="discrete">'
        '<flag contact="disable"/></option>'
        f"<worldbody>{''.join(rows)}</worldbody><deformable>{''.join(flexes)}</deformable></mujoco>"
    )


def _words(numbers) -> str:
    return " ".join(str(number) for number in np.asarray(numbers).tolist())


def solve(job: dict) -> dict:
    """The answer to a job."""
    case = read_without_contact(job)
    nodal = Nodal(case, job["spacing_m"], 1, simplices=True)
    states = (_at_rest if case.is_static else _in_motion)(nodal, job)
    content = nodal.answer([(u, None) for u in states])
    del content["reactions_n"]
    return content | {"method": "flexes of linear tetrahedra, discrete integrator"}


def _at_rest(nodal: Nodal, job: dict) -> list:
    size, material = np.ptp(nodal.points, axis=0).max(), nodal.case.regions[0].material
    wave = size / np.sqrt(material.shear_modulus / material.density)
    for steps in STEPS_PER_WAVE:
        try:
            return [_relaxed(Flexes(nodal, wave / steps), steps)]
        except Refused:
            if steps == STEPS_PER_WAVE[-1]:
                raise


def _relaxed(flexes: Flexes, steps: int) -> np.ndarray:
    end = flexes.nodal.case.time.load_end

    def advance(scale: float) -> np.ndarray:
        flexes.step(end, scale)
        return flexes.u

    def stop() -> None:
        flexes.data.qvel[:] = 0.0

    return at_rest(advance, stop, flexes.nodal.masses(), 2 * steps, WAVES * steps, AT_REST)


def _in_motion(nodal: Nodal, job: dict) -> list:
    instants = job["instants_s"]
    count = round(STEPS_PER_INSTANT * 2 ** (job["level"] / 2))
    flexes, states, t = Flexes(nodal, instants[0] / count), [], 0.0
    for _ in instants:
        for _ in range(count):
            t += instants[0] / count
            flexes.step(t, 1.0)
        states.append(flexes.u.copy())
    return states


if __name__ == "__main__":
    answer("MuJoCo", mujoco.mj_versionString, solve)
