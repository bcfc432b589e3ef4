"""Adapters of simulators of robots and films, which have materials of their own."""
