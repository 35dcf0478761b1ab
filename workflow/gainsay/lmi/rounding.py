"""Bounds on what floating point leaves out: definiteness, residuals and solutions of equations, proved in numpy.

A sum of n products in any order is off by at most ``g(n) * sum of sizes``, g(n) = n u / (1 - n u), u = 2^-53. All that
is proved here rests on this model (no overflow, underflow covered by a tiny term).

References: N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, ch. 3, 10;
S. M. Rump, "Verification of positive definiteness", BIT 46 (2006) 433-452.
"""

from dataclasses import dataclass
from math import fsum
from typing import Any

import numpy as np

__all__ = ["RightInverse", "gamma", "norm", "power_of_two", "proved_positive", "residual", "twofold"]

_TINY = 1e-290
_LARGEST = 1e150


def gamma(terms: int) -> float:
    """Relative error of a sum of so many products, with room to spare for its own rounding."""
    unit = 1.2e-16 * (terms + 2)
    return unit / (1 - unit)


def norm(array: np.ndarray) -> float:
    """Upper bound on the Frobenius norm."""
    return float(np.linalg.norm(array)) * (1 + gamma(array.size)) + _TINY if np.any(array) else 0.0


def residual(rows: np.ndarray, right: np.ndarray, x: np.ndarray) -> np.ndarray:
    """``rows @ x + right``, each entry rounded once: the products split exactly, their sum by `math.fsum`."""
    product = rows * x
    rest = _rest_of(rows, np.broadcast_to(x, rows.shape), product)
    return np.array([fsum((*p, *r, c)) for p, r, c in zip(product, rest, right, strict=True)]).reshape(len(right))


def _rest_of(a: np.ndarray, b: np.ndarray, product: np.ndarray) -> np.ndarray:
    """What a product of doubles leaves out, exactly (Dekker's splitting; Higham, section 2.4)."""

    def split(value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        wide = 134217729.0 * value
        high = wide - (wide - value)
        return high, value - high

    (a1, a2), (b1, b2) = split(a), split(b)
    return a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2)


def twofold(*factors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Product of matrices as an unevaluated sum of two, off by less than 2^-100 of the product of their sizes."""
    high, low = factors[0], np.zeros_like(factors[0])
    for right in factors[1:]:
        terms = [np.zeros((len(high), 1, right.shape[1]))]
        for part in (high, low):
            left, of = np.broadcast_arrays(part[:, :, None], right[None])
            product = left * of
            terms += [product, _rest_of(left, of, product)]
        stacked = np.concatenate(terms, axis=1)
        flat = stacked.transpose(0, 2, 1).reshape(len(high) * right.shape[1], stacked.shape[1])
        shape = (len(high), right.shape[1])
        high = np.array([fsum(line) for line in flat]).reshape(shape)
        low = np.array([fsum((*line, -h)) for line, h in zip(flat, high.ravel(), strict=True)]).reshape(shape)
    return high, low


def power_of_two(values: Any) -> Any:
    """Nearest powers of two of positive numbers: factors that scale without rounding."""
    return np.exp2(np.round(np.log2(values)))


def proved_positive(matrix: np.ndarray, error: np.ndarray | float) -> bool:
    """Prove that every symmetric matrix within `error` (entry by entry) of a symmetric one is positive definite.

    A Cholesky factorisation of the matrix minus a shift, which covers its own rounding, runs to its end.
    """
    diagonal = np.diagonal(matrix)
    if not (np.isfinite(matrix).all() and np.all(diagonal > _TINY) and np.all(diagonal < _LARGEST)):
        return False
    size = len(matrix)
    d = power_of_two(1 / np.sqrt(diagonal))
    scaled = matrix * np.outer(d, d)
    spread = (np.broadcast_to(error, matrix.shape) * np.outer(d, d)).sum(axis=1).max() * (1 + gamma(size))
    trace = float(np.trace(scaled))
    shift = spread + 2 * gamma(size + 1) * trace + 4 * gamma(1) * float(np.diagonal(scaled).max()) + _TINY
    try:
        np.linalg.cholesky(scaled - shift * np.eye(size))
    except np.linalg.LinAlgError:
        return False
    return True


@dataclass(frozen=True)
class RightInverse:
    """Near right inverse R of a wide matrix J, with what is proved of it.

    Attributes
    ----------
    matrix : ndarray, shape (n, m)
        R, for J of shape (m, n).
    size : float
        Bound on the norm of R.
    defect : float
        Bound on the norm of I - J R; below one, J has full row rank.
    """

    matrix: np.ndarray
    size: float
    defect: float

    @classmethod
    def of(cls, wide: np.ndarray, error: float = 0.0) -> "RightInverse | None":
        """Compute and bound it for every matrix within `error` in norm; None where the rank is not proved full."""
        m, n = wide.shape
        if m == 0:
            return cls(np.zeros((n, 0)), 0.0, 0.0)
        if m > n or not np.isfinite(wide).all():
            return None
        try:
            left, factor = np.linalg.qr(wide.T)
            inverse = left @ np.linalg.inv(factor).T
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(inverse).all():
            return None
        size = norm(inverse)
        defect = norm(np.eye(m) - wide @ inverse) + gamma(n + 1) * (norm(wide) * size + m) + error * size
        return cls(inverse, size, defect) if defect < 0.5 else None

    def change(self, linear: np.ndarray, residual: np.ndarray) -> float:
        """Bound on ``linear . d`` for the step d = R w with J d = r, |r_k| <= `residual` entry by entry."""
        length = norm(residual) / (1 - self.defect) * (1 + 1e-9)
        along = np.abs(linear @ self.matrix)
        along += gamma(len(linear)) * (np.abs(linear) @ np.abs(self.matrix))
        return float(along @ residual + norm(along) * self.defect * length) * (1 + gamma(len(along)) + 1e-9)

    def reach(self, residual: float, curvature: float = 0.0) -> float:
        """Bound on the norm of a step d with J d + Q(d) = r, |r| <= `residual`; infinite where none is proved.

        Q is quadratic, |Q(d)| <= `curvature` |d|^2. With d = R w, a ball of w is mapped into itself (Brouwer).
        """
        room = 1 - self.defect
        if curvature == 0:
            return residual / room * self.size * (1 + 1e-9)
        if 4 * curvature * self.size**2 * residual > room**2 * (1 - 1e-9):
            return np.inf
        return 2 * residual / room * self.size * (1 + 1e-9)
