"""Finite-element references for the meshless solver mtled.

Two codes solve the cases of `reference/cases`: scikit-fem with hexahedra and
quadrilaterals, FEniCSx with tetrahedra and triangles. SI units everywhere.
"""

CODES = {"scikit-fem": "scikit_fem", "fenicsx": "fenicsx"}
"""Codes and the prefix of their modules: `PREFIX_solve.py` solves a case,
`brain_PREFIX.py` the case brain_slice."""

LEVELS = (0, 1, 2)
"""Meshes of a case from coarse to fine."""

FINEST = 3
"""A fourth mesh, of the bonded block with FEniCSx alone: the field that the race is
measured against."""
