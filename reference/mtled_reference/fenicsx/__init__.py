"""The cases with FEniCSx (DOLFINx): tetrahedra, triangles and a few structured meshes."""
