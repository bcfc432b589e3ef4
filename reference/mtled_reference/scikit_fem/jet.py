"""Automatic differentiation, forward mode: numbers with their first and second derivatives.

A formula evaluated on jets gives its value, gradient and Hessian exactly, so that no
derivative is written by hand.
"""

import numpy as np


class Jet:
    """Values (n,), gradients (k, n) and Hessians (k, k, n) with respect to k variables."""

    def __init__(self, value: np.ndarray, gradient: np.ndarray, hessian: np.ndarray):
        self.value, self.gradient, self.hessian = value, gradient, hessian

    def _through(self, value, slope, curvature) -> "Jet":
        """f(self) from f, f' and f'' at the values, by the chain rule."""
        outer = self.gradient[:, None] * self.gradient[None, :]
        return Jet(value, slope * self.gradient, slope * self.hessian + curvature * outer)

    def __add__(self, other) -> "Jet":
        if isinstance(other, Jet):
            return Jet(
                self.value + other.value,
                self.gradient + other.gradient,
                self.hessian + other.hessian,
            )
        return Jet(self.value + other, self.gradient, self.hessian)

    __radd__ = __add__

    def __neg__(self) -> "Jet":
        return Jet(-self.value, -self.gradient, -self.hessian)

    def __sub__(self, other) -> "Jet":
        return self + (-other)

    def __rsub__(self, other) -> "Jet":
        return -self + other

    def __mul__(self, other) -> "Jet":
        if not isinstance(other, Jet):
            return Jet(self.value * other, self.gradient * other, self.hessian * other)
        mixed = self.gradient[:, None] * other.gradient[None, :]
        return Jet(
            self.value * other.value,
            self.value * other.gradient + other.value * self.gradient,
            self.value * other.hessian + other.value * self.hessian + mixed + mixed.swapaxes(0, 1),
        )

    __rmul__ = __mul__

    def __truediv__(self, other) -> "Jet":
        return self * other**-1 if isinstance(other, Jet) else self * (1.0 / other)

    def __pow__(self, power) -> "Jet":
        x = self.value
        return self._through(
            x**power, power * x ** (power - 1.0), power * (power - 1.0) * x ** (power - 2.0)
        )


def variables(*values: np.ndarray) -> list[Jet]:
    """Independent variables with the given values, all of one shape (n,)."""
    count, size = len(values), len(values[0])
    hessian = np.zeros((count, count, size))
    jets = []
    for index, value in enumerate(values):
        gradient = np.zeros((count, size))
        gradient[index] = 1.0
        jets.append(Jet(np.asarray(value, dtype=float), gradient, hessian))
    return jets


def log(x: Jet) -> Jet:
    """Natural logarithm."""
    return x._through(np.log(x.value), 1.0 / x.value, -1.0 / x.value**2)
