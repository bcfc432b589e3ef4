"""The cases with scikit-fem: hexahedra and quadrilaterals of order 2."""
