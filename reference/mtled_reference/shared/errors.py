"""How a solution fails."""


class NotConverged(RuntimeError):
    """Newton's method did not reach its tolerance."""
