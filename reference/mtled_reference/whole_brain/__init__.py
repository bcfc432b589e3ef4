"""The cases of a whole brain with both codes: geometry, mesh, contact, equilibrium."""
