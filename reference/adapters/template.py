"""An adapter of the solver protocol in few lines: boxes of neo-Hookean tissue between planes, by
trilinear hexahedra. Written from README.md alone: python3 template.py JOB ANSWER"""

import json
import sys
import time

import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

STEPS, ITERATIONS, RESIDUAL = 8, 12, 1e-8
job = json.load(open(sys.argv[1]))
problem, about = job["problem"], {"protocol": 1, "solver": {"name": "template", "version": "1"}}


def reply(**content):
    json.dump(about | content, open(sys.argv[2], "w"), allow_nan=False)
    sys.exit()


def refuse(what, reason="unsupported"):
    reply(refused={"reason": reason, "what": what})


solved = {"title", "description", "source", "dimension", "geometry", "region", "material"}
solved |= {"discretisation", "prescribe", "time", "probe", "output"}
for key, table in problem.items():
    if table and key not in solved:
        refuse(key)
body, regions = problem["geometry"]["shape"], problem["region"]
if problem["dimension"] != "3d" or "box" not in body or len(regions) > 1:
    refuse("anything but a box of one material")
name = regions[0]["material"]
law, material = problem["material"][name], job["materials"][name]
if law["law"] != "neo_hookean_log_j" or {"prony", "active_stress"} & set(law):
    refuse(f"the law {law['law']}, viscosity or active stress")
if problem["time"]["method"] != "static":
    refuse("motion in time")
if any(probe["kind"] != "positions" for probe in job["probes"]):
    refuse("centres of mass")

# Nodes X[n, 3] of a grid, x slowest; corners[e, 8] of its cells; Grad N[q, 8, 3] at Gauss points.
low, high = np.array(body["box"]["min"]), np.array(body["box"]["max"])
cells = np.maximum(1, np.round((high - low) / job["spacing_m"])).astype(int)
axes = [np.linspace(low[k], high[k], cells[k] + 1) for k in range(3)]
X = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
numbers = np.arange(len(X)).reshape(cells + 1)
offsets = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), -1).reshape(8, 3)
first = np.stack(np.meshgrid(*map(np.arange, cells), indexing="ij"), -1).reshape(-1, 1, 3)
corners = numbers[tuple(np.moveaxis(first + offsets, -1, 0))]
signs, size = 2.0 * offsets - 1.0, (high - low) / cells
N1 = 0.5 * (1.0 + (signs / np.sqrt(3.0))[:, None] * signs)  # [q, a, axis]
grad = np.stack([signs[:, k] / size[k] * N1[..., k - 1] * N1[..., k - 2] for k in range(3)], -1)
weight, mu, lam = size.prod() / 8.0, material["shear_modulus_pa"], material["lame_modulus_pa"]

full, fixed, owned = np.zeros_like(X), np.zeros(X.shape, bool), []
for row, factors in zip(problem["prescribe"], job["factors"]["prescribe"]):
    if "plane" not in row["where"] or "displacement" not in row or "release" in row:
        refuse(f"support {row['name']}: what is no plane that is displaced for ever")
    plane, components = row["where"]["plane"], row["displacement"]
    height = (X - plane["point"]) @ plane["normal"] / np.linalg.norm(plane["normal"])
    nodes = np.abs(height) <= plane.get("tolerance", job["selection_tolerance_m"])
    given = np.array([key in components for key in "xyz"])
    value = np.array([components.get(key, 0.0) for key in "xyz"])
    mine = nodes[:, None] & given & ~fixed
    full = np.where(mine, factors[-1] * value, full)
    fixed |= mine
    owned.append((row["name"], mine))


def assemble(u):
    """Strain energy, internal forces [n, 3] and tangent of displacements [n, 3]."""
    F = np.eye(3) + np.einsum("eai,qaJ->eqiJ", u[corners], grad)
    J, G = np.linalg.det(F), np.linalg.inv(F).swapaxes(-1, -2)
    if J.min() <= 0.0:
        raise FloatingPointError
    log, eye = np.log(J)[..., None, None], np.eye(3)
    psi = 0.5 * mu * ((F**2).sum((-1, -2)) - 3.0) - mu * np.log(J) + 0.5 * lam * np.log(J) ** 2
    forces = weight * np.einsum("eqiJ,qaJ->eai", mu * (F - G) + lam * log * G, grad)
    c = (mu - lam * log)[..., None, None]
    A = mu * np.einsum("ik,JL->iJkL", eye, eye) + c * np.einsum("eqiL,eqkJ->eqiJkL", G, G)
    A += lam * np.einsum("eqiJ,eqkL->eqiJkL", G, G)
    K = weight * np.einsum("eqiJkL,qaJ,qbL->eaibk", A, grad, grad, optimize=True)
    dofs = (3 * corners[..., None] + np.arange(3)).reshape(-1, 24)
    pairs = np.repeat(dofs, 24, axis=1).ravel(), np.tile(dofs, 24).ravel()
    total = np.bincount(dofs.ravel(), forces.ravel(), X.size).reshape(-1, 3)
    return weight * psi.sum(), total, coo_matrix((K.ravel(), pairs), (X.size,) * 2).tocsr()


u, free = np.zeros_like(X), np.flatnonzero(~fixed.ravel())
try:
    for step in range(1, STEPS + 1):
        move = np.where(fixed, step / STEPS * full - u, 0.0).ravel()
        for _ in range(ITERATIONS):
            energy, forces, K = assemble(u)
            forces = forces.ravel()
            residual = np.linalg.norm(forces[free])
            if not move.any() and residual <= RESIDUAL * np.linalg.norm(forces):
                break
            change = move.copy()
            change[free] = -spsolve(K[free][:, free].tocsc(), (forces + K @ move)[free])
            u, move = u + change.reshape(-1, 3), np.zeros_like(move)
        else:
            raise FloatingPointError
except FloatingPointError:
    refuse("an element inverts or Newton's method does not end", "not_converged")

at = RegularGridInterpolator(axes, u.reshape(*(cells + 1), 3))
reply(
    displacements_m={p["name"]: [at(p["positions_m"]).tolist()] for p in job["probes"]},
    reactions_n={name: [(mine * forces.reshape(-1, 3)).sum(0).tolist()] for name, mine in owned},
    strain_energy_j=[energy],
    unknowns=len(free),
    cpu_s=time.process_time(),
    method="trilinear hexahedra, 8 Gauss points",
)
