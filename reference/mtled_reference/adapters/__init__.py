"""Adapters of the solver protocol (reference/adapters/README.md)."""
