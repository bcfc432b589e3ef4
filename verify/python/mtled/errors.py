"""The exceptions of the package."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


class MtledError(Exception):
    """Anything that mtled refuses or fails at; the other exceptions are kinds of it."""


class DoubtfulWarning(UserWarning):
    """A run has come to its end, and not all of what was asked was done."""


#: File, line, column, key and message.
Place = tuple[str, int, int, str, str]


@dataclass(frozen=True)
class Mistake:
    """What is wrong, and where."""

    file: str
    #: From 1; 0 means the file as a whole.
    line: int
    #: From 1, in characters.
    column: int
    #: Such as ``material.tissue.density``; empty for mistakes of syntax.
    key: str
    message: str


class LocatedError(MtledError):
    """An error with places in a case file; ``file``, ``line``, ``column`` and ``key`` are those of the first."""

    def __init__(self, text: str, mistakes: Sequence[Place] = ()) -> None:
        super().__init__(text, mistakes)
        self.mistakes = [Mistake(*mistake) for mistake in mistakes]

    def __str__(self) -> str:
        return str(self.args[0])

    def _first(self) -> Mistake:
        return self.mistakes[0] if self.mistakes else Mistake("", 0, 0, "", str(self))

    @property
    def file(self) -> str:
        return self._first().file

    @property
    def line(self) -> int:
        return self._first().line

    @property
    def column(self) -> int:
        return self._first().column

    @property
    def key(self) -> str:
        return self._first().key


class CaseError(LocatedError):
    """Mistakes in a case file."""


class SetUpError(LocatedError):
    """The solver refuses what a case states, before its first step."""


class SolveError(LocatedError):
    """A run has failed. ``outcome`` is ``not_converged``, ``diverged`` or ``failed``."""

    def __init__(self, text: str, mistakes: Sequence[Place] = (), outcome: str = "failed") -> None:
        super().__init__(text, mistakes)
        self.args = (text, mistakes, outcome)
        self.outcome = outcome


class ImageError(MtledError):
    """An image cannot be read, written or warped."""
