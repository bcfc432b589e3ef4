"""Solves a job with sfepy: python -m mtled_reference.adapters.sfepy JOB ANSWER

sfepy 2026.3, pip install sfepy; meshes of bodies other than boxes need pip install netgen-mesher.
Equilibria in 3-D. Boxes get even hexahedra, other bodies tetrahedra with straight edges,
displacements of order 2 by sfepy's fields. Laws are sfepy's total Lagrangian terms: neo-Hookean
with K/2 (J - 1)², St. Venant and Kirchhoff's, and one term of ours for μ/2 (I1 - 3) - μ ln J +
λ/2 (ln J)². Where ν ≥ 0.45 the pressure is a field of order 1, continuous (sfepy's example
hyperelastic_tl_up), for the first of these laws only. Newton's method and SuperLU are sfepy's.
"""

import numpy as np
import sfepy
from sfepy.base.base import IndexedStruct, output
from sfepy.discrete import (
    Equation,
    Equations,
    FieldVariable,
    Function,
    Functions,
    Integral,
    Material,
    Problem,
)
from sfepy.discrete.conditions import Conditions, EssentialBC
from sfepy.discrete.fem import FEDomain, Field, Mesh
from sfepy.mechanics.matcoefs import stiffness_from_lame
from sfepy.solvers.ls import ScipyDirect
from sfepy.solvers.nls import Newton
from sfepy.terms import Term, Terms, register_term
from sfepy.terms.terms_hyperelastic_base import HyperElasticBase
from sfepy.terms.terms_hyperelastic_tl import HyperElasticTLBase

from ..shared.materials import Material as Matter
from ..shared.selection import selected
from .bodies import TOLERANCE
from .cases import read_without_contact
from .files import Refused, answer
from .nodal import Nodal

RESIDUAL = 1e-8
"""Of Newton's method, over the first residual of a step [–]."""
ITERATIONS = 15
LOAD_STEPS = (4, 16)
"""Numbers of load steps, tried in turn."""
PAIRS = np.array([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)])
"""Components of symmetric tensors in sfepy's order."""


class LogarithmicTerm(HyperElasticTLBase):
    """ψ = μ/2 (I1 - 3) - μ ln J + λ/2 (ln J)²: S = μ 1 + (λ ln J - μ) C⁻¹."""

    name = "dw_tl_he_log_j"
    family_data_names = ["det_f", "sym_inv_c"]
    arg_shapes = {"material": "1, 2", "virtual": ("D", "state"), "state": "D"}

    def stress_function(self, out, mat, det_f, inverse, **kwargs):
        """S at quadrature points."""
        mu, lam = np.moveaxis(HyperElasticBase.tile_mat(mat, len(det_f))[..., 0, :], -1, 0)
        log = np.log(det_f[..., 0, 0])
        one = (PAIRS[:, 0] == PAIRS[:, 1]).astype(float)
        factor = (lam * log - mu)[..., None]
        out[..., 0] = mu[..., None] * one + factor * inverse[..., 0]
        return out

    def tan_mod_function(self, out, mat, det_f, inverse, **kwargs):
        """2 ∂S/∂C = λ C⁻¹ ⊗ C⁻¹ + (μ - λ ln J) (C⁻¹ ⊠ C⁻¹ + its transpose)."""
        mu, lam = np.moveaxis(HyperElasticBase.tile_mat(mat, len(det_f))[..., 0, :], -1, 0)
        G = np.empty((*det_f.shape[:2], 3, 3))
        i, j = PAIRS.T
        G[..., i, j] = G[..., j, i] = inverse[..., 0]
        i, j, k, n = i[:, None], j[:, None], i[None], j[None]
        crossed = G[..., i, k] * G[..., j, n] + G[..., i, n] * G[..., j, k]
        factor = (mu - lam * np.log(det_f[..., 0, 0]))[..., None, None]
        out[...] = lam[..., None, None] * G[..., i, j] * G[..., k, n] + factor * crossed
        return out


class Solver:
    """A job as a problem of sfepy. `factor` is that of loads and supports."""

    def __init__(self, case, job: dict):
        self.case, self.factor, end = case, 0.0, case.time.load_end
        # Elements of order 2 have twice the spacing.
        self.model = model = Nodal(case, 2.0 * job["spacing_m"], 1)
        kind = "3_4" if model.element.simplex else "3_8"
        cells = model.cells.astype(np.int32)
        mesh = Mesh.from_data("body", model.points, None, [cells], [model.owners], [kind])
        self.domain = FEDomain("domain", mesh)
        self.body = self.domain.create_region("Omega", "all")
        self.u, self.v, integral = *self._pair("u", "vector", 2), Integral("i", order=4)
        self.mixed = any(r.material.is_nearly_incompressible for r in case.regions)
        fields = {"u": self.u, "v": self.v}
        if self.mixed:
            fields["p"], fields["q"] = self._pair("p", "scalar", 1)
        terms, volume = [], []
        for number, region in enumerate(case.regions):
            if not (model.owners == number).any():
                raise Refused(f"{region.name} is smaller than an element", "resolution")
            part = self.domain.create_region(f"Part{number}", f"cells of group {number}")
            material = region.material
            for name, values in _terms(material, self.mixed):
                terms.append(Term.new(name, integral, part, **_matter(values), **fields))
            if self.mixed:
                compliance = _matter(1.0 / material.bulk_modulus)
                volume += [
                    Term.new("dw_tl_volume(q, u)", integral, part, **fields),
                    Term.new("dw_dot(m.v, q, p)", integral, part, **compliance, **fields),
                    -Term.new("dw_integrate(q)", integral, part, **fields),
                ]
            for force in case.body_forces:
                density = material.density * force.amplitude(end)
                load = self._load(density * np.array(force.acceleration))
                terms.append(-Term.new("dw_volume_lvf(m.v, v)", integral, part, m=load, **fields))
        for row in case.tractions:
            load = self._load(row.amplitude(end) * np.array(row.traction))
            where = self._facets(row.name, row.selector)
            terms.append(-Term.new("dw_surface_ltr(m.v, v)", integral, where, m=load, **fields))
        equations = [Equation("balance", Terms(terms))]
        if self.mixed:
            equations.append(Equation("volume", Terms(volume)))
        self.problem = Problem("problem", equations=Equations(equations))
        # Where two prescribe a component the last counts for sfepy, and the first for a job.
        rows = [self._support(row) for row in reversed(case.prescriptions)]
        self.problem.set_bcs(ebcs=Conditions(rows))

    def _pair(self, name: str, shape: str, order: int):
        field = Field.from_args(name, np.float64, shape, self.body, approx_order=order)
        test = {"u": "v", "p": "q"}[name]
        return (
            FieldVariable(name, "unknown", field),
            FieldVariable(test, "test", field, primary_var_name=name),
        )

    def _load(self, vector: np.ndarray) -> Material:
        def values(ts, coors, mode=None, **kwargs):
            if mode == "qp":
                return {"v": np.tile(self.factor * vector[:, None], (len(coors), 1, 1))}

        return Material("m", function=values)

    def _facets(self, name: str, selector):
        """The region of facets whose corners are selected on the surface."""
        chosen = selected(selector, self.model.points, TOLERANCE * self.model.spacing)
        nodes = np.flatnonzero(chosen & self.model.outer)
        where = Function("where", lambda coors, domain=None: nodes)
        key = "F" + "".join(f"{ord(letter):x}" for letter in name)
        functions = Functions([where])
        return self.domain.create_region(key, "vertices by where", "facet", functions=functions)

    def _support(self, row) -> EssentialBC:
        if row.of != "surface":
            raise Refused(f"{row.name}: a support of the volume")
        components, end = row.components(3), self.case.time.load_end

        def values(ts, coors, bc=None, problem=None, **kwargs):
            full = row.values(coors, self.factor * row.amplitude(end))
            return full[:, components].ravel()

        key = f"u.[{','.join(map(str, components))}]"
        return EssentialBC(
            row.name, self._facets(row.name, row.selector), {key: Function("f", values)}
        )

    def solve(self, steps: int) -> dict:
        """What an answer has, after load steps."""
        settings = {"i_max": ITERATIONS, "eps_a": 1e-30, "eps_r": RESIDUAL, "eps_mode": "or"}
        status, state = IndexedStruct(), None
        newton = Newton(settings, lin_solver=ScipyDirect({}), status=status)
        self.problem.set_solver(newton)
        for step in range(1, steps + 1):
            self.factor = step / steps
            state = self.problem.solve(state0=state, save_results=False).get_state()
            if status.condition != 0 or not np.isfinite(state).all():
                raise Refused("Newton's method does not end", "not_converged")
        unknowns = self.problem.equations.variables.adi.n_dof_total
        return {
            "displacements_m": {probe.name: [self._values(probe)] for probe in self.case.probes},
            "reactions_n": self._reactions(state),
            "unknowns": int(unknowns),
        }

    def _values(self, probe) -> list:
        """Displacements at positions, or of the centre of mass of a region or the whole."""
        if probe.positions is not None:
            values, _, status = self.u.evaluate_at(probe.positions, ret_cells=True, ret_status=True)
            if (status > 1).any():
                raise Refused("a probe outside the mesh", "resolution")
            return values.reshape(-1, 3).tolist()
        names = [region.name for region in self.case.regions]
        name, total, mass = probe.centre_of_mass, np.zeros(3), 0.0
        if name not in names and name != "body":
            raise Refused(f"no region {name}")
        for number, region in enumerate(self.case.regions):
            if name in names and region.name != name:
                continue
            integrals = (f"{term}.4.Part{number}(u)" for term in ("ev_integrate", "ev_volume"))
            moved, volume = (self.problem.evaluate(text, verbose=False) for text in integrals)
            total += region.material.density * np.ravel(moved)
            mass += region.material.density * float(volume)
        return [(total / mass).tolist()]

    def _reactions(self, state: np.ndarray) -> dict:
        """Forces of supports: the residual at their nodes without conditions."""
        problem = self.problem
        problem.time_update(ebcs=Conditions([]))
        forces = problem.equations.eval_residuals(state)
        forces = forces[problem.equations.variables.di.indx["u"]].reshape(-1, 3)
        field, taken, result = self.u.field, np.zeros(forces.shape, dtype=bool), {}
        for row in self.case.prescriptions:
            nodes = np.zeros(len(forces), dtype=bool)
            nodes[field.get_dofs_in_region(self._facets(row.name, row.selector))] = True
            mine = nodes[:, None] & np.isin(np.arange(3), row.components(3)) & ~taken
            taken |= mine
            result[row.name] = [(mine * forces).sum(axis=0).tolist()]
        return result


def _matter(values) -> dict:
    return {"m": Material("m", v=values)}


def _terms(material: Matter, mixed: bool) -> list:
    """Terms of a law with their constants."""
    mu, lam, bulk = material.shear_modulus, material.lame_modulus, material.bulk_modulus
    if material.is_quadratic_isochoric:
        rest = (
            ("dw_tl_bulk_pressure(v, u, p)", 0.0)
            if mixed
            else ("dw_tl_bulk_penalty(m.v, v, u)", bulk)
        )
        return [("dw_tl_he_neohook(m.v, v, u)", mu), rest]
    if mixed:
        raise Refused(f"nearly incompressible tissue of the law {material.law}")
    if material.law == "neo_hookean_log_j":
        return [("dw_tl_he_log_j(m.v, v, u)", np.array([[mu, lam]]))]
    if material.law == "st_venant_kirchhoff":
        return [("dw_tl_he_svk(m.v, v, u)", stiffness_from_lame(3, lam, mu))]
    raise Refused(f"the law {material.law}")


def solve(job: dict) -> dict:
    """The answer to a job."""
    output.set_output(quiet=True)
    register_term(LogarithmicTerm)
    case = read_without_contact(job)
    if not case.is_static:
        raise Refused("motion in time")
    for steps in LOAD_STEPS:
        solver = Solver(case, job)
        try:
            content = solver.solve(steps)
            break
        except Refused as refused:
            if refused.reason != "not_converged" or steps == LOAD_STEPS[-1]:
                raise
    element = "tetrahedra P2" if solver.model.element.simplex else "even hexahedra Q2"
    method = f"{element}{', pressure of order 1' if solver.mixed else ''}, SuperLU"
    return content | {"method": method}


if __name__ == "__main__":
    answer("sfepy", lambda: sfepy.__version__, solve)
