"""Where a matrix function s E - sum_k H_k exp(-s d_k) is singular: proved absent along a path, counted in a region.

Along a piece of the path, let X be the computed inverse at its middle. X M(s) = I + F(s), and |F(s)| is bounded entry
by entry by what s can change, what rounding did, and how far X is from an inverse. Where the Perron root of that bound
is below one, M is regular on the whole piece, and the argument of its determinant turns by at most n times its
arcsine: so no turn is ever lost. Pieces that cannot be settled are halved. The bound does not depend on the units of
the states.

References
----------
R. A. Horn, C. R. Johnson, Matrix Analysis, 2nd ed., 2013, section 8.1 (Perron root, Collatz and Wielandt's bound).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import matrix_balance

from gainsay.errors import ComputationError

_EPS = np.finfo(float).eps
_TURN = 2.8  # rad: largest turn of the determinant from the middle of a piece, safely below pi
_FIRST = 16  # pieces of every leg to begin with
_BATCH = 4096


@dataclass(frozen=True, eq=False)
class DelayPencil:
    """M(s) = s E - sum_k H_k exp(-s d_k).

    Attributes
    ----------
    E : ndarray, shape (n, n)
        Diagonal.
    terms : tuple of (ndarray, float)
        Real H_k, shape (n, n), with the delay d_k in s; negative delays only where the path is the imaginary axis.
    """

    E: np.ndarray
    terms: tuple[tuple[np.ndarray, float], ...]

    def balanced(self) -> "DelayPencil":
        """Return the pencil after a diagonal similarity by powers of two, which changes no determinant."""
        size = sum((np.abs(H) for H, _ in self.terms), np.zeros_like(self.E))
        _, (scale, _) = matrix_balance(size, permute=False, separate=True)
        return DelayPencil(self.E, tuple((H * scale[None, :] / scale[:, None], d) for H, d in self.terms))

    def __call__(self, s: np.ndarray) -> np.ndarray:
        """Values at points s, shape (k,); shape (k, n, n)."""
        value = s[:, None, None] * self.E
        for H, delay in self.terms:
            value = value - np.exp(-s * delay)[:, None, None] * H
        return value

    def radius(self, abscissa: float) -> float:
        """Bound on |s| over all s with Re s >= abscissa at which M is singular, E being the identity."""
        bound = sum((np.abs(H) * np.exp(-abscissa * d) for H, d in self.terms), np.zeros_like(self.E))
        return float(_perron(bound[None])[0]) * (1 + 1e-9)

    def variation(self, s: np.ndarray, half: np.ndarray, lowest: np.ndarray) -> np.ndarray:
        """Bound, entry by entry, on M over each piece minus M as computed at its middle."""
        n = self.E.shape[0]
        rounding = 4 * (n + len(self.terms) + 4) * _EPS
        change = (half + rounding * np.abs(s))[:, None, None] * np.abs(self.E)
        for H, delay in self.terms:
            size = np.exp(-delay * lowest) if delay > 0 else np.exp(-delay * s.real)
            part = size * (np.minimum(abs(delay) * half, 2.0) + rounding * (1 + np.abs(s * delay)))
            change = change + part[:, None, None] * np.abs(H)
        return change


def _perron(bound: np.ndarray) -> np.ndarray:
    """Upper bounds on the spectral radii of nonnegative matrices (k, n, n), by Collatz and Wielandt."""
    x = np.ones(bound.shape[:2])
    best = np.full(len(bound), np.inf)
    for _ in range(12):
        y = np.einsum("kij,kj->ki", bound, x)
        best = np.minimum(best, (y / x).max(axis=1))
        largest = y.max(axis=1, keepdims=True)
        # halfway between x and its image: periodic matrices settle too, and no entry reaches zero
        x = 0.5 * x + 0.5 * np.where(largest > 0, y / np.where(largest > 0, largest, 1), x) + 1e-12
    return best * (1 + 1e-12)


def _inverses(values: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.inv(values)
    except np.linalg.LinAlgError:
        inverses = np.full_like(values, np.nan)
        for k, value in enumerate(values):
            try:
                inverses[k] = np.linalg.inv(value)
            except np.linalg.LinAlgError:
                continue
        return inverses


class NearRoot(ComputationError):
    """A pencil that is singular on the path, or so near to it that rounding does not tell.

    Attributes
    ----------
    place : complex
        Where, 1/s.
    """

    def __init__(self, place: complex) -> None:
        self.place = place
        super().__init__("roots along a path", f"a root within rounding of s = {place:.9g} 1/s")


def _settled(pencil: DelayPencil, path: Sequence[complex], most: float, limit: int) -> Iterator[tuple]:
    """Yield starts, ends and inverses of pieces on which the Perron root of the change is at most `most`."""
    n = pencil.E.shape[0]
    corners = np.asarray(path, dtype=complex)
    shares = np.arange(_FIRST + 1) / _FIRST
    grid = [a + (b - a) * shares for a, b in pairwise(corners)]
    start = np.concatenate([points[:-1] for points in grid])
    end = np.concatenate([points[1:] for points in grid])
    tried = 0
    while len(start):
        a, b = start[:_BATCH], end[:_BATCH]
        start, end = start[_BATCH:], end[_BATCH:]
        tried += len(a)
        if tried > limit:
            raise ComputationError("roots along a path", f"{limit} pieces do not settle it near s = {a[0]:.9g} 1/s")
        middle, half = (a + b) / 2, np.abs(b - a) / 2 * (1 + 4 * _EPS)
        lowest = np.minimum(a.real, b.real)
        with np.errstate(all="ignore"):
            value = pencil(middle)
            inverse = _inverses(value)
            size = np.abs(inverse)
            residual = np.abs(inverse @ value - np.eye(n)) + 4 * (n + 2) * _EPS * (size @ np.abs(value))
            rounding = _perron(residual + size @ pencil.variation(middle, 0 * half, lowest))
            reach = _perron(residual + size @ pencil.variation(middle, half, lowest))
        settled = reach <= most  # false for nan
        stuck = ~settled & ~(rounding <= 0.5 * most) & (half < 1e-3 * np.abs(middle) + 1e-300)
        stuck |= ~settled & (half <= 8 * _EPS * np.abs(middle))
        if stuck.any():
            raise NearRoot(complex(middle[np.flatnonzero(stuck)[0]]))
        if settled.any():
            yield a[settled], b[settled], inverse[settled]
        a, b, middle = a[~settled], b[~settled], middle[~settled]
        start, end = np.concatenate([a, middle, start]), np.concatenate([middle, b, end])


def require_regular(pencil: DelayPencil, path: Sequence[complex], *, limit: int = 300_000) -> None:
    """Prove that M is regular all along straight legs between corners (1/s); raises as `turning` where it does not."""
    for _ in _settled(pencil.balanced(), path, 0.9, limit):
        pass


def turning(pencil: DelayPencil, path: Sequence[complex], *, limit: int = 300_000) -> float:
    """Change of the argument of det M(s) along straight legs, in rad; its turns are proved, its value is rounded.

    Parameters
    ----------
    pencil : DelayPencil
    path : sequence of complex
        Corners, 1/s.
    limit : int
        Most pieces to try.

    Returns
    -------
    float
        That it is returned proves that M is regular all along the path.

    Raises
    ------
    NearRoot
        If M is singular on the path, or so near to it that rounding does not tell.
    ComputationError
        If the pieces run out.
    """
    pencil = pencil.balanced()
    most = min(0.9, float(np.sin(min(_TURN / pencil.E.shape[0], np.pi / 2))))
    total = 0.0
    for start, end, inverse in _settled(pencil, path, most, limit):
        angles = [np.angle(np.linalg.slogdet(inverse @ pencil(points))[0]) for points in (end, start)]
        total += float(np.sum(angles[0] - angles[1]))
    return total


def roots_right_of(pencil: DelayPencil, abscissa: float, *, limit: int = 300_000) -> int:
    """Count the s with Re s > abscissa at which M(s) is singular, E being the identity and every delay >= 0.

    The count is that of the argument principle over a box that reaches beyond every such s.

    Parameters
    ----------
    pencil : DelayPencil
    abscissa : float
        1/s.
    limit : int
        Most pieces to try.

    Raises
    ------
    ComputationError
        If a root lies on the line Re s = abscissa to within rounding, or the pieces run out.
    """
    radius = 1.1 * pencil.radius(abscissa)
    if not np.isfinite(radius):
        raise ComputationError("root count", f"the roots right of {abscissa:.6g} 1/s have no finite bound")
    radius = radius or 1.0
    if abscissa >= radius:
        return 0
    right = max(radius, abscissa + radius)
    return enclosed_roots(pencil, abscissa, right, radius, limit=limit)


def enclosed_roots(pencil: DelayPencil, left: float, right: float, top: float, *, limit: int = 300_000) -> int:
    """Count the roots in the box left < Re s < right, |Im s| < top (1/s); raises as `turning`."""
    # The matrices are real: the lower half of the contour turns as much as the upper one.
    turns = turning(pencil, [right, right + 1j * top, left + 1j * top, left], limit=limit) / np.pi
    if abs(turns - round(turns)) > 0.01:
        raise ComputationError("root count", f"{turns!r} half turns, expected a whole number")
    return round(turns)
