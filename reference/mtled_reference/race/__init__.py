"""Timed runs of both codes for `mtled study race`, beside the meshless solver."""
