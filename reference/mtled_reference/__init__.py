"""Finite-element references for the meshless solver mtled.

Two codes solve the cases of `reference/cases`: scikit-fem with hexahedra and
quadrilaterals, FEniCSx with tetrahedra and triangles. SI units everywhere.
"""

CODES = ("scikit-fem", "fenicsx")
"""Names of the codes in commands and files."""

LEVELS = (0, 1, 2)
"""Meshes of a case from coarse to fine."""

FINEST = 3
"""A fourth mesh, of the bonded block with FEniCSx only: its field is
`finest/bonded_block.json`."""
