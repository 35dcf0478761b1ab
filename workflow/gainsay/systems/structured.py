"""The structured singular value of a system over all frequencies: its peak between two ends.

The upper end is a level. About a frequency the best constant scaling of the response there is kept; all frequencies at
which the scaled response has the level as a singular value are isolated exactly; between two of them it stays below.
Such intervals are put side by side until they cover the axis, so no grid is trusted.

References
----------
A. Packard, J. Doyle, The complex structured singular value, Automatica 29 (1993) 71-109, sections 3 and 10.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import acb, acb_mat, arb, ctx, fmpq, fmpq_mat
from numpy.typing import ArrayLike

from gainsay.errors import ComputationError, InputError
from gainsay.exact.definite import hermitian_positive_definite
from gainsay.systems.margins import structured_bounds
from gainsay.systems.norm_bounds import level_frequencies
from gainsay.systems.spectrum import rational, require_hurwitz
from gainsay.systems.statespace import StateSpace

_BITS = 256
#: intervals put side by side before the peak is given up
_MOST = 400
#: frequencies looked at first, about the poles
_FIRST = 12


@dataclass(frozen=True)
class StructuredPeak:
    """The largest structured singular value over all frequencies.

    Attributes
    ----------
    lower : float
        Of the response at `frequency`, from a perturbation; rounded.
    upper : float
        Proved: no perturbation of the structure with a norm below 1/upper at every frequency makes the loop unstable.
    frequency : float
        rad/s; infinity where the response is D.
    intervals : tuple of (float, float, ndarray)
        Frequencies from and to, rad/s, and the scaling d_i > 0 of the blocks that proves the upper end there.
    """

    lower: float
    upper: float
    frequency: float
    intervals: tuple[tuple[float, float, np.ndarray], ...]


def structured_peak(
    A: ArrayLike,
    B: ArrayLike,
    C: ArrayLike,
    D: ArrayLike | None = None,
    *,
    blocks: Sequence[int],
    tolerance: float = 1e-3,
) -> StructuredPeak:
    """Peak of the structured singular value of C (jw - A)^-1 B + D over all w, for full complex blocks.

    Parameters
    ----------
    A, B, C, D : array_like
        Shapes (n, n), (n, m), (m, n), (m, m); D is zero where None.
    blocks : sequence of int
        Sizes of the square full blocks down the diagonal; they add up to m.
    tolerance : float
        The upper end is this part above the largest upper bound met on the way.

    Returns
    -------
    StructuredPeak

    Raises
    ------
    InputError
        If the system is unstable or not square, or the blocks do not add up.
    ComputationError
        If the axis is not covered.

    Examples
    --------
    >>> found = structured_peak([[-1.0]], [[0.0, 2.0]], [[1.0], [0.0]], blocks=[1, 1])  # a lag in no loop
    >>> found.upper < 0.01
    True
    """
    if not 0 < tolerance < 1:
        raise InputError("", field="tolerance", value=tolerance, expected="between 0 and 1")
    system = StateSpace(A, B, C, D)
    require_hurwitz(system.A, "structured singular value")
    cover = _Cover(system, list(blocks), tolerance)
    rates = np.abs(np.linalg.eigvals(system.A))
    grid = np.geomspace(rates.min() / 30, rates.max() * 30, _FIRST)
    for frequency in sorted({0.0, np.inf, *rates.tolist(), *grid.tolist()}):
        cover.look(frequency)
    return cover.whole()


class _Cover:
    """Intervals of the axis on which a scaled response is proved to stay below the level."""

    def __init__(self, system: StateSpace, blocks: list[int], tolerance: float) -> None:
        self.system, self.blocks, self.tolerance = system, blocks, tolerance
        self.level, self.lower, self.place = 0.0, 0.0, 0.0
        self.floor = tolerance * 1e-3 * max(float(np.abs(system.D).max()), system.gain(0.0), 1e-300)
        self.done: list[tuple[float, float, np.ndarray]] = []

    def look(self, frequency: float) -> np.ndarray:
        """Scaling of the response at a frequency; the level rises above the upper bound there."""
        bounds = structured_bounds(self.system.response(frequency), self.blocks)
        if bounds.lower > self.lower:
            self.lower, self.place = bounds.lower, frequency
        # where the structure falls apart there is no best scaling: the level need not follow it to zero
        self.level = max(self.level, bounds.upper * (1 + self.tolerance), self.floor)
        return bounds.scaling

    def whole(self) -> StructuredPeak:
        left = [(0.0, np.inf)]
        for _ in range(_MOST):
            if not left:
                ends = tuple(sorted(self.done, key=lambda piece: piece[0]))
                return StructuredPeak(self.lower, self.level, self.place, ends)
            low, high = left.pop()
            frequency = _between(low, high)
            scaling = self.look(frequency)
            interval = self._interval(scaling, frequency)
            if interval is None:
                left.append((low, high))
                self.level *= 1 + 0.1 * self.tolerance
                continue
            self.done.append((*interval, scaling))
            left += [
                (a, b) for a, b in ((low, interval[0]), (interval[1], high)) if a <= b and not _inside(a, b, interval)
            ]
        raise ComputationError("structured singular value", f"{_MOST} intervals do not cover the axis")

    def _interval(self, scaling: np.ndarray, frequency: float) -> tuple[float, float] | None:
        """Ends, inside by two last digits, between which the scaled response stays below the level."""
        whole = np.repeat(scaling, self.blocks)
        d = rational(np.diag(whole))
        system = self.system
        A, B, C, D = (rational(M) for M in (system.A, system.B, system.C, system.D))
        parts = (A, B * d.inv(), d * C, d * D * d.inv())
        level = Fraction(self.level)
        if not _below(parts, frequency, level):
            return None
        crossings = level_frequencies(*parts, fmpq(level.numerator, level.denominator))
        if crossings is None:
            return None
        values = [float(w) for w in crossings]
        low = max((w for w in values if w < frequency), default=-1.0)
        high = min((w for w in values if w > frequency), default=np.inf)
        if frequency in values:
            return None
        return (0.0 if low < 0 else _step(low, np.inf)), (high if np.isinf(high) else _step(high, 0.0))


def _step(value: float, towards: float) -> float:
    return float(np.nextafter(np.nextafter(value, towards), towards))


def _inside(low: float, high: float, piece: tuple[float, float]) -> bool:
    return piece[0] <= low and high <= piece[1]


def _between(low: float, high: float) -> float:
    """A frequency of a closed interval of [0, inf], in its middle by powers of ten where it is wide."""
    if low == high:
        return low
    if np.isinf(high):
        return np.inf if low > 0 else 1.0
    return high / 2 if low == 0 else float(np.sqrt(low) * np.sqrt(high))


def _below(parts: tuple[fmpq_mat, ...], frequency: float, level: Fraction) -> bool:
    """Prove in balls that the response at a frequency has a norm below a level."""
    A, B, C, D = parts
    with ctx.workprec(_BITS):
        response = acb_mat(D)
        if np.isfinite(frequency):
            shifted = acb_mat(A) * acb(-1)
            for i in range(A.nrows()):
                shifted[i, i] = shifted[i, i] + acb(0, arb(frequency))
            response = response + acb_mat(C) * shifted.solve(acb_mat(B))
        rows = response.tolist()
        adjoint = acb_mat([[x.conjugate() for x in column] for column in zip(*rows, strict=True)])
        bound = arb(fmpq(level.numerator, level.denominator)) ** 2
        unit = acb_mat([[bound if i == j else 0 for j in range(len(rows))] for i in range(len(rows))])
        return hermitian_positive_definite(unit - adjoint * response)
